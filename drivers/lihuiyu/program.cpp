#include "drivers/lihuiyu/program.h"

#include <array>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "drivers/device.h"
#include "drivers/gcode_words.h"

namespace leafcutter::drivers {

namespace {

constexpr double kInchMm = 25.4;
constexpr double kArcToleranceMm = 0.0127;  // Half a step of 1/1000 inch.
constexpr double kPi = 3.14159265358979323846;

struct Place {
    double x = 0.0;
    double y = 0.0;
};

// The words of one line, after its modal codes were taken.
struct LineWords {
    std::optional<double> x, y, i, j, r;
};

class MoveReader {
public:
    void read_line(const GcodeWords& words, std::size_t line) {
        line_ = line;
        if (words.fault) {
            refuse("is no G-code");
        }
        LineWords found;
        for (const GcodeWord& word : words.words) {
            take(word, found);
        }
        if (found.x || found.y) {
            move(found);
        }
    }

    std::vector<CutMove> take_moves() { return std::move(moves_); }

private:
    [[noreturn]] void refuse(std::string_view what) const {
        throw ProgramRefused(fmt::format("line {}: {}", line_, what));
    }

    void take(const GcodeWord& word, LineWords& found) {
        switch (word.letter) {
            case 'G':
                take_g(word.value);
                break;
            case 'M':
                take_m(word.value);
                break;
            case 'X':
                found.x = word.value;
                break;
            case 'Y':
                found.y = word.value;
                break;
            case 'I':
                found.i = word.value;
                break;
            case 'J':
                found.j = word.value;
                break;
            case 'R':
                found.r = word.value;
                break;
            case 'F':
                feed_mm_per_min_ = word.value * unit_;
                break;
            case 'S':
                power_ = word.value;
                break;
            case 'N':
                break;
            default:
                refuse(fmt::format("{} words don't exist on a Lihuiyu board", word.letter));
        }
    }

    void take_g(double code) {
        if (code == 0.0 || code == 1.0 || code == 2.0 || code == 3.0) {
            motion_ = static_cast<int>(code);
        } else if (code == 20.0 || code == 21.0) {
            unit_ = code == 20.0 ? kInchMm : 1.0;
        } else if (code == 90.0 || code == 91.0) {
            relative_ = code == 91.0;
        } else if (code != 17.0 && code != 40.0 && code != 49.0 && code != 54.0 && code != 80.0 &&
                   code != 94.0) {
            // Those are what a machine without other planes, tools or offsets does anyway.
            refuse(fmt::format("G{:g} can't be done on a Lihuiyu board", code));
        }
    }

    void take_m(double code) {
        if (code == 3.0 || code == 4.0) {
            laser_ = true;
        } else if (code == 5.0 || code == 2.0 || code == 30.0) {
            laser_ = false;
        } else if (code != 7.0 && code != 8.0 && code != 9.0) {
            // The pump runs by itself while a program does.
            refuse(fmt::format("M{:g} can't be done on a Lihuiyu board", code));
        }
    }

    void move(const LineWords& words) {
        const Place from = place_;
        const auto target = [this](const std::optional<double>& value, double old) {
            return value ? *value * unit_ + (relative_ ? old : 0.0) : old;
        };
        const Place to{target(words.x, from.x), target(words.y, from.y)};
        const bool burns = motion_ != 0 && power_ > 0.0;
        if (burns && !laser_) {
            refuse("burns (S above 0) without M3 or M4 before it");
        }
        if (burns && !(feed_mm_per_min_ > 0.0)) {
            refuse("burns without a feed (F)");
        }
        if (motion_ >= 2) {
            arc(from, to, words);
        }
        add(to);
    }

    void add(Place to) {
        const bool burns = motion_ != 0 && power_ > 0.0;
        moves_.push_back({to.x, to.y, burns, burns ? feed_mm_per_min_ / 60.0 : 0.0, line_});
        place_ = to;
    }

    // The chords of an arc but for the last.
    void arc(Place from, Place to, const LineWords& words) {
        const Place center = center_of(from, to, words);
        const double radius = std::hypot(from.x - center.x, from.y - center.y);
        const double begin = std::atan2(from.y - center.y, from.x - center.x);
        double turn = std::atan2(to.y - center.y, to.x - center.x) - begin;
        const bool clockwise = motion_ == 2;
        while (clockwise ? turn >= -1e-9 : turn <= 1e-9) {
            turn += clockwise ? -2.0 * kPi : 2.0 * kPi;
        }
        const double ratio = std::min(kArcToleranceMm / std::max(radius, 1e-9), 1.0);
        const double step = 2.0 * std::acos(1.0 - ratio);
        const int pieces = static_cast<int>(std::ceil(std::abs(turn) / step));
        for (int piece = 1; piece < pieces; ++piece) {
            const double angle = begin + turn * piece / pieces;
            add({center.x + radius * std::cos(angle), center.y + radius * std::sin(angle)});
        }
    }

    Place center_of(Place from, Place to, const LineWords& words) const {
        if (!words.r) {
            if (!words.i && !words.j) {
                refuse("an arc needs I and J, or R");
            }
            return {from.x + words.i.value_or(0.0) * unit_, from.y + words.j.value_or(0.0) * unit_};
        }
        const double radius = *words.r * unit_;
        const double dx = to.x - from.x;
        const double dy = to.y - from.y;
        const double chord = std::hypot(dx, dy);
        if (!(chord > 0.0) || chord > 2.0 * std::abs(radius) + 2e-3) {
            refuse("no arc of this R reaches that point");
        }
        const double height = std::sqrt(std::max(radius * radius - chord * chord / 4.0, 0.0));
        // The shorter of the two arcs, the longer for a negative R.
        const double side = (motion_ == 2) == (radius > 0.0) ? 1.0 : -1.0;
        return {(from.x + to.x) / 2.0 + side * height * dy / chord,
                (from.y + to.y) / 2.0 - side * height * dx / chord};
    }

    std::vector<CutMove> moves_;
    std::size_t line_ = 0;
    Place place_;
    int motion_ = 0;
    double unit_ = 1.0;
    bool relative_ = false;
    bool laser_ = false;
    double power_ = 0.0;
    double feed_mm_per_min_ = 0.0;
};

}  // namespace

std::vector<CutMove> read_cut_moves(std::string_view gcode) {
    MoveReader reader;
    std::size_t number = 0;
    while (!gcode.empty()) {
        const std::size_t end = gcode.find('\n');
        const std::string stripped = strip_gcode(gcode.substr(0, end));
        gcode.remove_prefix(end == std::string_view::npos ? gcode.size() : end + 1);
        ++number;
        if (!stripped.empty() && stripped != "%") {
            reader.read_line(split_words(stripped), number);
        }
    }
    std::vector<CutMove> moves = reader.take_moves();
    if (moves.empty()) {
        throw ProgramRefused("the program moves nothing");
    }
    return moves;
}

}  // namespace leafcutter::drivers
