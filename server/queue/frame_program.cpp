#include "server/queue/frame_program.h"

#include <algorithm>
#include <charconv>
#include <limits>
#include <optional>

#include <fmt/format.h>

namespace leafcutter::server {

namespace {

// The number after `letter` in a line of G-code.
std::optional<double> word(std::string_view line, char letter) {
    const std::size_t at = line.find(letter);
    if (at == std::string_view::npos) {
        return std::nullopt;
    }
    double value = 0.0;
    const auto end = line.data() + line.size();
    const auto parsed = std::from_chars(line.data() + at + 1, end, value);
    return parsed.ec == std::errc() ? std::optional(value) : std::nullopt;
}

struct Range {
    double low = std::numeric_limits<double>::infinity();
    double high = -std::numeric_limits<double>::infinity();

    void include(double value) {
        low = std::min(low, value);
        high = std::max(high, value);
    }
};

}  // namespace

std::string frame_program(std::string_view gcode) {
    Range xs;
    Range ys;
    double x = 0.0;
    double y = 0.0;
    int motion = 0;
    while (!gcode.empty()) {
        const std::size_t end = std::min(gcode.find('\n'), gcode.size());
        std::string_view line = gcode.substr(0, end);
        gcode.remove_prefix(std::min(end + 1, gcode.size()));
        line = line.substr(0, line.find_first_of(";("));
        const std::optional<double> code = word(line, 'G');
        if (code && *code >= 0.0 && *code <= 3.0) {
            motion = static_cast<int>(*code);
        }
        const std::optional<double> to_x = word(line, 'X');
        const std::optional<double> to_y = word(line, 'Y');
        if (!to_x && !to_y) {
            continue;
        }
        if (motion != 0) {
            xs.include(x);
            ys.include(y);
        }
        x = to_x.value_or(x);
        y = to_y.value_or(y);
        if (motion != 0) {
            xs.include(x);
            ys.include(y);
        }
    }
    if (xs.low > xs.high) {
        return {};
    }
    return fmt::format(
        "G21\nG90\nM5 S0\nG0 X{0:.3f} Y{1:.3f}\nG0 X{2:.3f} Y{1:.3f}\nG0 X{2:.3f} Y{3:.3f}\n"
        "G0 X{0:.3f} Y{3:.3f}\nG0 X{0:.3f} Y{1:.3f}\nM5 S0\n",
        xs.low, ys.low, xs.high, ys.high);
}

}  // namespace leafcutter::server
