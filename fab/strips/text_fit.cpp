#include "fab/strips/text_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "fab/strips/labels.h"

namespace leafcutter::fab {

namespace {

using Eigen::Vector2d;

constexpr double kSmaller = 0.85;      // From one height tried to the next.
constexpr double kTextClearMm = 0.05;  // Between a text's box and other marks.
constexpr double kTriesAlong = 60.0;
constexpr double kQuiet = 0.5;  // Of the height, beyond the box.

// Half the size of a text's box with its margins.
Vector2d half_box(std::string_view text, double height_mm) {
    const double beside = std::min(0.5, 0.25 * height_mm);
    const double above = std::min(0.25, 0.2 * height_mm);
    return {height_mm * text_width(text) / 2.0 + beside, height_mm / 2.0 + above};
}

MarkShape quiet_box(std::string_view text,
                    double height_mm,
                    const Vector2d& middle,
                    const Vector2d& along) {
    return MarkShape::box(middle, along,
                          half_box(text, height_mm) + Vector2d(kQuiet * height_mm, 0.0));
}

PlacedText placed(std::string_view text,
                  double height_mm,
                  const Vector2d& middle,
                  const Vector2d& along) {
    const Vector2d up(-along.y(), along.x());
    Mark mark;
    mark.text = text;
    mark.height_mm = height_mm;
    mark.at = middle - height_mm / 2.0 * (text_width(text) * along + up);
    mark.angle_deg = std::atan2(along.y(), along.x()) * 180.0 / std::numbers::pi;
    return {std::move(mark), MarkShape::box(middle, along, half_box(text, height_mm)),
            quiet_box(text, height_mm, middle, along)};
}

bool has_room(const MarkRoom& room, const PlacedText& text) {
    return room.is_clear(text.quiet, kTextClearMm) && room.is_free(text.box, kTextClearMm);
}

// The height at which `text` with its margins fills `length_mm`.
double height_for(std::string_view text, double length_mm) {
    return std::max(length_mm / (text_width(text) + 0.5), (length_mm - 1.0) / text_width(text));
}

struct Direction {
    Vector2d along;
    double length_mm = 0.0;  // Of the cell, that way,
    double tall_mm = 0.0;    // and across it.
};

std::optional<PlacedText> fit_at_height(const MarkRoom& room,
                                        const MarkCell& cell,
                                        const Direction& way,
                                        std::string_view text,
                                        double height_mm) {
    constexpr std::array<double, 5> kShifts{0.0, 0.5, -0.5, 1.0, -1.0};
    const Vector2d half = half_box(text, height_mm);
    const double slack_x = std::max(0.0, way.length_mm / 2.0 - half.x());
    const double slack_y = std::max(0.0, way.tall_mm / 2.0 - half.y());
    const Vector2d up(-way.along.y(), way.along.x());
    for (const double y : kShifts) {
        for (const double x : kShifts) {
            const Vector2d middle = cell.middle + x * slack_x * way.along + y * slack_y * up;
            PlacedText candidate = placed(text, height_mm, middle, way.along);
            if (cell.holds(candidate.box) && has_room(room, candidate)) {
                return candidate;
            }
        }
    }
    return std::nullopt;
}

}  // namespace

std::optional<PlacedText> fit_in_cell(const MarkRoom& room,
                                      const MarkCell& cell,
                                      std::string_view text,
                                      const TextHeights& heights,
                                      TextWay allowed) {
    std::array<Direction, 2> ways{{{cell.along, cell.length_mm, cell.width_mm},
                                   {cell.across(), cell.width_mm, cell.length_mm}}};
    if (allowed == TextWay::Along) {
        ways[1] = ways[0];
    }
    const auto bound = [&](const Direction& way) {
        return std::min({heights.most_mm, height_for(text, way.length_mm), way.tall_mm});
    };
    if (bound(ways[1]) > 1.15 * bound(ways[0])) {
        std::swap(ways[0], ways[1]);
    }
    const double most = std::max(bound(ways[0]), bound(ways[1]));
    for (double height = most; height >= heights.least_mm; height *= kSmaller) {
        for (const Direction& way : ways) {
            if (height > bound(way)) {
                continue;
            }
            if (auto text_there = fit_at_height(room, cell, way, text, height)) {
                return text_there;
            }
        }
    }
    return std::nullopt;
}

std::optional<PlacedText> fit_along(const MarkRoom& room,
                                    const MarkFrame& frame,
                                    const Stretch& stretch,
                                    std::string_view text,
                                    const TextHeights& heights) {
    const double way = stretch.to_mm < stretch.from_mm ? -1.0 : 1.0;
    const double reach = std::abs(stretch.to_mm - stretch.from_mm);
    for (double height = heights.most_mm; height >= heights.least_mm; height *= kSmaller) {
        const double half = half_box(text, height).x();
        const double step = std::max(half / 4.0, reach / kTriesAlong);
        for (double gone = 0.0; gone <= reach; gone += step) {
            const double s = stretch.from_mm + way * gone;
            if (s < half || s > frame.length_mm() - half) {
                continue;
            }
            const Vector2d from = frame.point(s - half);
            const Vector2d chord = frame.point(s + half) - from;
            const Vector2d middle = (from + chord / 2.0 + frame.point(s)) / 2.0;
            PlacedText candidate = placed(text, height, middle, chord.stableNormalized());
            if (has_room(room, candidate)) {
                return candidate;
            }
        }
    }
    return std::nullopt;
}

}  // namespace leafcutter::fab
