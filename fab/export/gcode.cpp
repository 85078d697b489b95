// G-code of three dialects. All of it holds for each: millimetres, absolute, the S word on the
// motion line, S0 on every rapid, so that a rapid is dark even where laser mode was forgotten.
//
// GRBL 1.1: M4 is dynamic power (laser mode, $32=1). S1000 is full ($30).
// Marlin 2.0.9 and later: "M4 I" turns on inline power, without which S on G1 is not heeded. S255
// is full (CUTTER_POWER_UNIT PWM255). Smoothieware: its laser module needs no M word; power goes
// with G1 alone. S1 is full (laser_module_maximum_s_value).

#include <cmath>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "fab/cut/motion.h"
#include "fab/export/formats.h"
#include "fab/export/number.h"
#include "geometry/error.h"

namespace leafcutter::fab {

namespace {

constexpr std::size_t kLineLimit = 80;

// Plain ASCII without what a controller acts on, wherever in a line it stands: real-time characters
// (! ~ ?), program marks (%), settings ($), comment brackets.
std::string comment(std::string_view label, std::string_view value) {
    std::string line = fmt::format("; {}: ", label);
    bool replaced = false;
    for (const char letter : value) {
        const bool plain = letter >= ' ' && letter <= '~' &&
                           std::string_view("()!~?%$;").find(letter) == std::string_view::npos;
        if (plain) {
            line += letter;
        } else if (!replaced) {
            line += '_';
        }
        replaced = !plain;
    }
    if (line.size() > kLineLimit) {
        line.resize(kLineLimit);
    }
    return line + '\n';
}

std::string_view laser_on(Dialect dialect) {
    switch (dialect) {
        case Dialect::Grbl:
            return "M4 S0\n";
        case Dialect::Marlin:
            return "M4 I1 S0\n";
        case Dialect::Smoothie:
            break;
    }
    return "";
}

std::string clock_text(double seconds) {
    const auto whole = static_cast<long>(std::lround(seconds));
    return fmt::format("{}:{:02}:{:02}, {} s", whole / 3600, whole / 60 % 60, whole % 60, whole);
}

void check_settings(const CutProgram& program) {
    for (const CutPath& path : program.paths) {
        if (!(settings_of(program, path).feed_mm_per_min > 0.0)) {
            static constexpr const char* kNames[] = {"engrave", "score", "cut"};
            throw geometry::Error(
                geometry::ErrorKind::BadOption, "no-feed",
                fmt::format("material {}: {}.feed_mm_per_min: must be > 0", program.material,
                            kNames[static_cast<std::size_t>(path.operation)]));
        }
    }
}

std::string header(const CutProgram& program) {
    std::string out = "; Leafcutter\n";
    out += comment("job", program.job);
    out += comment("sheet",
                   fmt::format("{}, {} x {} mm", program.sheet, short_number(program.size.width_mm),
                               short_number(program.size.height_mm)));
    out += comment("material", program.material);
    out += comment("estimated time", clock_text(program.estimated_s));
    return out;
}

// Writes only what changes: the feed and power words of a burning line, and no move that rounds to
// none.
class MotionWriter {
public:
    MotionWriter(double full_power_s, std::string& out) : full_power_s_(full_power_s), out_(out) {}

    void write(const Motion& motion) {
        std::string place =
            fmt::format("X{} Y{}", short_number(motion.to.x()), short_number(motion.to.y()));
        if (place == place_) {
            return;
        }
        if (!motion.burns) {
            fmt::format_to(std::back_inserter(out_), "G0 {} S0\n", place);
            power_.reset();
        } else {
            write_burn(motion, place);
        }
        place_ = std::move(place);
    }

private:
    void write_burn(const Motion& motion, const std::string& place) {
        const double power = motion.power_percent / 100.0 * full_power_s_;
        fmt::format_to(std::back_inserter(out_), "G1 {}", place);
        if (power_ != power) {
            fmt::format_to(std::back_inserter(out_), " S{}", short_number(power));
            power_ = power;
        }
        if (feed_ != motion.feed_mm_per_min) {
            fmt::format_to(std::back_inserter(out_), " F{}", short_number(motion.feed_mm_per_min));
            feed_ = motion.feed_mm_per_min;
        }
        out_ += '\n';
    }

    const double full_power_s_;
    std::string& out_;
    std::string place_ = "X0 Y0";
    std::optional<double> power_;
    std::optional<double> feed_;
};

}  // namespace

double full_power(const MachineProfile& machine, Dialect dialect) {
    constexpr double kFull[] = {1000.0, 255.0, 1.0};  // In the order of the dialects.
    return machine.s_max.value_or(kFull[static_cast<std::size_t>(dialect)]);
}

std::string write_gcode(const CutProgram& program, const MachineProfile& machine, Dialect dialect) {
    check_settings(program);
    std::string out = header(program);
    out += "G21\nG90\nG0 X0 Y0 S0\n";
    out += laser_on(dialect);
    MotionWriter writer(full_power(machine, dialect), out);
    for (const Motion& motion : motions(program, machine)) {
        writer.write(motion);
    }
    out += "M5 S0\nG0 X0 Y0\n";
    return out;
}

}  // namespace leafcutter::fab
