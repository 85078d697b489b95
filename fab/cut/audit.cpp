#include "fab/cut/audit.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "fab/cut/motion.h"
#include "fab/cut/segment_grid.h"
#include "geometry/error.h"

namespace leafcutter::fab {

namespace {

// Distance varies no faster than the point moves: between two samples the true maximum exceeds what
// is reported by at most half of this.
constexpr double kSampleMm = 0.02;

// The largest distance of a point of `from` from the nearest of `to`.
double largest_distance(std::span<const Segment> from, const SegmentGrid& to) {
    double largest = 0.0;
    for (const Segment& segment : from) {
        const Eigen::Vector2d along = segment.to - segment.from;
        const double length = along.norm();
        for (double at = 0.0;;) {
            const double t = length > 0.0 ? std::min(1.0, at / length) : 1.0;
            const double distance = to.distance(segment.from + t * along);
            largest = std::max(largest, distance);
            if (t >= 1.0) {
                break;
            }
            // Nothing beyond the largest so far lies within reach of a smaller distance.
            at += std::max(kSampleMm, largest - distance);
        }
    }
    return largest;
}

double total_length(std::span<const Segment> segments) {
    double sum = 0.0;
    for (const Segment& segment : segments) {
        sum += (segment.to - segment.from).norm();
    }
    return sum;
}

// What a line of G-code leaves behind for the next.
struct ModalState {
    Eigen::Vector2d at = Eigen::Vector2d::Zero();
    int motion = 0;
    bool laser = false;
    double power = 0.0;
    double feed_mm_per_min = 0.0;
};

struct Line {
    Eigen::Vector2d to = Eigen::Vector2d::Zero();
    bool moves = false;
};

[[noreturn]] void refuse(int number, std::string_view why) {
    throw geometry::Error(geometry::ErrorKind::BadFile, "bad-gcode",
                          fmt::format("G-code line {}: {}", number, why));
}

void apply_g(double code, ModalState& state, int number) {
    if (code == 0.0 || code == 1.0) {
        state.motion = static_cast<int>(code);
    } else if (code != 21.0 && code != 90.0 && code != 17.0) {
        refuse(number, fmt::format("G{} is not of our dialect", code));
    }
}

void apply_m(double code, ModalState& state) {
    if (code == 3.0 || code == 4.0) {
        state.laser = true;
    } else if (code == 5.0) {
        state.laser = false;
    }
}

void apply_word(char letter, double value, ModalState& state, Line& line) {
    switch (letter) {
        case 'S':
            state.power = value;
            break;
        case 'F':
            state.feed_mm_per_min = value;
            break;
        case 'X':
            line.to.x() = value;
            line.moves = true;
            break;
        case 'Y':
            line.to.y() = value;
            line.moves = true;
            break;
        default:
            break;
    }
}

Line read_line(std::string_view text, ModalState& state, int number) {
    Line line{state.at, false};
    const char* at = text.data();
    const char* end = at + text.size();
    while (at != end) {
        const char letter = *at++;
        if (letter == ' ' || letter == '\r' || letter == '\t') {
            continue;
        }
        double value = 0.0;
        const auto [next, error] = std::from_chars(at, end, value);
        if (error != std::errc() || letter < 'A' || letter > 'Z') {
            refuse(number, fmt::format("cannot read it at '{}'", letter));
        }
        at = next;
        if (letter == 'G') {
            apply_g(value, state, number);
        } else if (letter == 'M') {
            apply_m(value, state);
        } else {
            apply_word(letter, value, state, line);
        }
    }
    return line;
}

bool turns_laser_on(std::string_view gcode) {
    return gcode.find("\nM3") != std::string_view::npos ||
           gcode.find("\nM4") != std::string_view::npos;
}

}  // namespace

BurnAudit audit_burn(const CutProgram& plan, std::span<const BurntSegment> burnt) {
    std::vector<Segment> planned;
    BurnAudit audit;
    std::vector<Segment> done;
    done.reserve(burnt.size());
    for (const BurntSegment& segment : burnt) {
        done.push_back({segment.from, segment.to});
    }
    audit.burnt_mm = total_length(done);
    Eigen::Vector2d at = Eigen::Vector2d::Zero();
    for (const Motion& motion : motions(plan, MachineProfile{})) {
        if (motion.burns) {
            planned.push_back({at, motion.to});
        }
        at = motion.to;
    }
    audit.planned_mm = total_length(planned);
    if (done.empty() || planned.empty()) {
        // Nothing to compare with: everything there is deviates, by as much as the sheet is large.
        const double far_mm = std::hypot(plan.size.width_mm, plan.size.height_mm);
        audit.largest_deviation_mm = done.empty() ? 0.0 : far_mm;
        audit.largest_gap_mm = planned.empty() ? 0.0 : far_mm;
        return audit;
    }
    audit.largest_deviation_mm = largest_distance(done, SegmentGrid(planned));
    audit.largest_gap_mm = largest_distance(planned, SegmentGrid(done));
    return audit;
}

std::vector<BurntSegment> burnt_segments(std::string_view gcode) {
    std::vector<BurntSegment> burnt;
    ModalState state;
    state.laser = !turns_laser_on(gcode);
    int number = 0;
    while (!gcode.empty()) {
        const std::size_t end = std::min(gcode.find('\n'), gcode.size());
        std::string_view text = gcode.substr(0, end);
        gcode.remove_prefix(std::min(end + 1, gcode.size()));
        ++number;
        text = text.substr(0, text.find_first_of(";("));
        const Line line = read_line(text, state, number);
        if (!line.moves) {
            continue;
        }
        if (state.motion == 1 && state.laser && state.power > 0.0 && line.to != state.at) {
            burnt.push_back({state.at, line.to, state.power, state.feed_mm_per_min});
        }
        state.at = line.to;
    }
    return burnt;
}

}  // namespace leafcutter::fab
