// What a program would do, found by walking through it before it is sent.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "drivers/gcode_words.h"
#include "drivers/grbl/program.h"

namespace leafcutter::drivers {

namespace {

using Point = std::array<double, 2>;

constexpr double kSlack = 0.01;  // mm beyond the travel that rounding explains.

constexpr std::array<int, 26> kAllowedG{0,   10,  20,  30,  40,  100, 170, 210, 280,
                                        281, 300, 301, 400, 490, 530, 540, 550, 560,
                                        570, 580, 590, 610, 800, 900, 910, 911};
constexpr std::array<int, 3> kMoreAllowedG{920, 921, 940};
constexpr std::array<int, 9> kAllowedM{0, 1, 2, 3, 4, 5, 8, 9, 30};
constexpr int kWaitForStand = 400;  // Marlin's and Smoothieware's.

struct Bounds {
    Point low{std::numeric_limits<double>::max(), std::numeric_limits<double>::max()};
    Point high{std::numeric_limits<double>::lowest(), std::numeric_limits<double>::lowest()};

    void add(const Point& point) {
        for (std::size_t axis = 0; axis < 2; ++axis) {
            low[axis] = std::min(low[axis], point[axis]);
            high[axis] = std::max(high[axis], point[axis]);
        }
    }
};

template <typename Table>
bool holds(const Table& table, int code) {
    return std::find(table.begin(), table.end(), code) != table.end();
}

class Walk {
public:
    Walk(const MachineFacts& machine, Point start) : machine_(machine), at_(start) {}

    void line(const ProgramLine& line) {
        line_ = &line;
        axes_ = {};
        centre_ = {};
        axis_given_ = {};
        bool has_axes = false;
        bool other_axes_user = false;
        radius_.reset();
        const std::vector<GcodeWord> words = split_words(line.text).words;
        has_inline_word_ = holds_word(words, 'I');
        dwells_ = std::any_of(words.begin(), words.end(), [](const GcodeWord& word) {
            return word.letter == 'G' && word.value == 4.0;
        });
        for (const GcodeWord& word : words) {
            if (word.letter == 'G') {
                other_axes_user = general(word.value) || other_axes_user;
            } else if (word.letter == 'M') {
                machine_code(word.value);
            } else {
                has_axes = value(word) || has_axes;
            }
        }
        if (has_axes && !other_axes_user) {
            move();
        }
    }

    bool beam_on() const { return beam_; }
    bool known() const { return known_; }
    const Bounds& bounds() const { return bounds_; }

private:
    [[noreturn]] void refuse(std::string_view what) const {
        throw ProgramRefused(fmt::format("line {} ({}): {}", line_->number, line_->text, what));
    }

    static bool holds_word(const std::vector<GcodeWord>& words, char letter) {
        return std::any_of(words.begin(), words.end(),
                           [letter](const GcodeWord& word) { return word.letter == letter; });
    }

    // Returns whether the axis words of the line belong to this command.
    bool general(double code) {
        const int tenths = whole_part(std::round(code * 10.0));
        if (tenths == 200) {
            refuse("inches (G20); write the program in mm (G21)");
        }
        if (!holds(kAllowedG, tenths) && !holds(kMoreAllowedG, tenths)) {
            refuse(fmt::format("G{} is not allowed on a laser", code));
        }
        if (tenths <= 30) {
            motion_ = tenths / 10;
        } else if (tenths == 900 || tenths == 910) {
            relative_ = tenths == 910;
        }
        const bool moves_origin = tenths == 100 || (tenths >= 280 && tenths <= 301) ||
                                  tenths == 530 || (tenths >= 550 && tenths <= 590) ||
                                  tenths == 920 || tenths == 921;
        known_ = known_ && !moves_origin;
        return moves_origin && tenths < 550 ? tenths != 530 : tenths == 920;
    }

    void machine_code(double code) {
        const int number = whole_part(code);
        const bool waits = number == kWaitForStand && machine_.beam != BeamCommand::M4;
        if (number != code || !(holds(kAllowedM, number) || waits)) {
            refuse(fmt::format("M{} is not allowed on a laser", code));
        }
        const bool dark_when_standing = machine_.beam != BeamCommand::InlineM4 || has_inline_word_;
        if (number == 3 && machine_.beam != BeamCommand::None) {
            refuse(
                fmt::format("M3 keeps the beam lit where the machine stands, should this "
                            "computer fail; write {}",
                            machine_.beam == BeamCommand::M4 ? "M4" : "M4 I"));
        }
        if (number == 4 && !dark_when_standing) {
            refuse(
                "without I the beam burns while the head stands; write M4 I "
                "(output.dialect=marlin)");
        }
        if (number == 4) {
            beam_ = machine_.beam != BeamCommand::None;
        } else if (number == 5 || number == 2 || number == 30) {
            beam_ = false;
        }
    }

    // Returns whether the word is an axis word.
    bool value(const GcodeWord& word) {
        switch (word.letter) {
            case 'X':
            case 'Y': {
                const auto axis = static_cast<std::size_t>(word.letter - 'X');
                axes_[axis] = word.value;
                axis_given_[axis] = true;
                return true;
            }
            case 'Z':
                return true;
            case 'I':
            case 'J':
                centre_[static_cast<std::size_t>(word.letter - 'I')] = word.value;
                return false;
            case 'R':
                radius_ = word.value;
                return false;
            case 'F':
                feed_set_ = feed_set_ || word.value > 0.0;
                return false;
            case 'S':
                power(word.value);
                return false;
            case 'K':
            case 'L':
            case 'N':
            case 'P':
            case 'T':
                return false;
            default:
                refuse(fmt::format("the word {} is not allowed on a laser", word.letter));
        }
    }

    void power(double s) const {
        if (dwells_ || !machine_.s_max) {
            return;
        }
        const std::string_view name = machine_.beam == BeamCommand::M4 ? "$30" : "s_max";
        if (s > *machine_.s_max) {
            refuse(fmt::format("S{} is above the machine's full power {}={}", s, name,
                               *machine_.s_max));
        }
        if (s > *machine_.s_max * machine_.power_cap_percent / 100.0) {
            refuse(fmt::format("S{} is above {} % of {}={}, the device's power_cap", s,
                               machine_.power_cap_percent, name, *machine_.s_max));
        }
    }

    void move() {
        if (motion_ != 0 && !feed_set_) {
            refuse("moves before a feed rate (F) is set");
        }
        const Point from = at_;
        for (std::size_t axis = 0; axis < 2; ++axis) {
            if (axis_given_[axis]) {
                at_[axis] = relative_ ? at_[axis] + axes_[axis] : axes_[axis];
            }
        }
        if (motion_ >= 2 && !radius_) {
            add_arc(from);
        }
        bounds_.add(at_);
    }

    // The arc by points at most 5 degrees apart; its bulge between them is below 0.1 % of the
    // radius.
    void add_arc(const Point& from) {
        const Point centre{from[0] + centre_[0], from[1] + centre_[1]};
        const double radius = std::hypot(centre_[0], centre_[1]);
        const double begin = std::atan2(-centre_[1], -centre_[0]);
        const double x = at_[0] - centre[0];
        const double y = at_[1] - centre[1];
        double turn = std::atan2(centre_[1] * x - centre_[0] * y, -centre_[0] * x - centre_[1] * y);
        constexpr double kFull = 2.0 * std::numbers::pi;
        turn += motion_ == 2 && turn >= 0.0 ? -kFull : (motion_ == 3 && turn <= 0.0 ? kFull : 0.0);
        for (int k = 1; k < 72; ++k) {
            const double angle = begin + turn * k / 72.0;
            bounds_.add(
                {centre[0] + radius * std::cos(angle), centre[1] + radius * std::sin(angle)});
        }
    }

    const MachineFacts& machine_;
    const ProgramLine* line_ = nullptr;
    Point at_;
    Point axes_{};
    Point centre_{};
    std::array<bool, 2> axis_given_{};
    std::optional<double> radius_;
    bool has_inline_word_ = false;
    bool dwells_ = false;
    int motion_ = 0;
    bool relative_ = false;
    bool beam_ = false;
    bool feed_set_ = false;
    bool known_ = true;
    Bounds bounds_;
};

void check_bounds(const Bounds& bounds, const MachineFacts& machine) {
    constexpr std::array<char, 2> kNames{'X', 'Y'};
    for (std::size_t axis = 0; axis < 2; ++axis) {
        const double travel = machine.travel_mm[axis];
        const double low = bounds.low[axis];
        const double high = bounds.high[axis];
        if (travel <= 0.0 || low > high) {
            continue;
        }
        if (high - low > travel + kSlack) {
            throw ProgramRefused(
                fmt::format("the program is {:.1f} mm long in {}, the machine travels {:.1f} mm",
                            high - low, kNames[axis], travel));
        }
        if (!machine.origin_in_travel_mm) {
            continue;
        }
        const double origin = (*machine.origin_in_travel_mm)[axis];
        if (origin + low < -kSlack || origin + high > travel + kSlack) {
            throw ProgramRefused(
                fmt::format("the program reaches from {0}{1:.1f} to {0}{2:.1f}, the machine only "
                            "from {0}{3:.1f} to "
                            "{0}{4:.1f}; move the work origin",
                            kNames[axis], low, high, -origin, travel - origin));
        }
    }
}

}  // namespace

void preflight(const Program& program, const MachineFacts& machine) {
    if (machine.reports_inches) {
        throw Refused("the machine reports inches; send $13=0 to it first");
    }
    if (machine.beam == BeamCommand::M4 && !machine.laser_mode) {
        throw Refused(
            "laser mode is off, the beam would stay lit while the machine stands; send $32=1 "
            "first");
    }
    Walk walk(machine, machine.work_position_mm);
    for (const ProgramLine& line : program.lines) {
        walk.line(line);
    }
    if (walk.beam_on()) {
        throw ProgramRefused("the program ends with the beam switched on; it must end with M5");
    }
    if (walk.known()) {
        check_bounds(walk.bounds(), machine);
    }
}

}  // namespace leafcutter::drivers
