#include "fab/cut/piece_measure.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "fab/cut/registration.h"
#include "geometry/plane.h"

namespace leafcutter::fab {

using geometry::turn_of;

namespace {

using Eigen::Vector2d;

constexpr double kSameCornerMm = 0.05;  // A corner this near to where a rung ends is its end.
constexpr double kTickCornerMm = 0.01;  // Likewise to where a tick points: ticks are rounded.

// What counts as a tick of a rung: a straight line along it, next to its end.
constexpr double kTickSine = 0.035;
constexpr double kTickReachMm = 3.0;     // From the end.
constexpr double kTickAsideMm = 0.5;     // From the rung,
constexpr double kTickAsidePart = 0.25;  // and in parts of the way to the next one.
constexpr double kPlannedAsideMm = 1e-3;
constexpr double kLeastTickMm = 0.3;
constexpr double kLeastCrossing = 0.3;  // Sine of the angle between a tick and a side.
constexpr double kReachedMm = 2e-3;     // The planned edge passes a rung's end this near.
constexpr double kLookMm = 1.0;  // How far from the planned end its tick may meet the contour.

struct Tick {
    Vector2d from;
    Vector2d to;
};

// A rung end as planned.
struct RungEnd {
    Vector2d at;
    Vector2d along;  // Unit vector along the rung.
    double aside_mm = 0.0;
};

double step_round(const Polyline& side, std::size_t i) {
    double least = std::numeric_limits<double>::infinity();
    if (i > 0) {
        least = std::min(least, (side[i] - side[i - 1]).norm());
    }
    if (i + 1 < side.size()) {
        least = std::min(least, (side[i + 1] - side[i]).norm());
    }
    return least;
}

RungEnd rung_end(const Polyline& side, const Polyline& other, std::size_t i) {
    RungEnd end;
    end.at = side[i];
    end.along = (other[i] - side[i]).stableNormalized();
    end.aside_mm = std::min(kTickAsideMm, kTickAsidePart * step_round(side, i));
    return end;
}

double distance_to(const Tick& tick, const Vector2d& point) {
    const Vector2d d = tick.to - tick.from;
    const double t = std::clamp((point - tick.from).dot(d) / d.squaredNorm(), 0.0, 1.0);
    return (point - tick.from - t * d).norm();
}

// How far the tick's line passes the rung end by, measured across the rung; none if it is no tick
// of it.
std::optional<double> aside(const Tick& tick, const RungEnd& end) {
    const Vector2d way = tick.to - tick.from;
    const double length = way.norm();
    // The cheap tests first: most lines are ticks of other rungs.
    const double offset = std::abs(turn_of(way, end.at - tick.from)) / length;
    if (offset > end.aside_mm || std::abs(turn_of(way, end.along)) > kTickSine * length ||
        distance_to(tick, end.at) > kTickReachMm) {
        return std::nullopt;
    }
    return offset;
}

std::optional<Tick> tick_of(const RungEnd& end, const std::vector<Tick>& lines) {
    std::optional<Tick> best;
    double least = std::numeric_limits<double>::infinity();
    for (const Tick& line : lines) {
        const auto offset = aside(line, end);
        if (offset && *offset < least) {
            least = *offset;
            best = line;
        }
    }
    return best;
}

std::vector<Tick> planned_lines(const Piece& piece) {
    std::vector<Tick> lines;
    const auto add = [&](const Polyline& path) {
        for (std::size_t i = 1; i < path.size(); ++i) {
            if ((path[i] - path[i - 1]).norm() >= kLeastTickMm) {
                lines.push_back({path[i - 1], path[i]});
            }
        }
    };
    for (const Mark& mark : piece.marks) {
        add(mark.path);
    }
    return lines;
}

std::vector<Tick> burnt_lines(std::span<const BurntSegment> marks) {
    std::vector<Tick> lines;
    for (const BurntSegment& mark : marks) {
        if ((mark.to - mark.from).norm() >= kLeastTickMm) {
            lines.push_back({mark.from, mark.to});
        }
    }
    return lines;
}

const Vector2d& nearest_corner(const Ring& ring, const Vector2d& point) {
    return *std::min_element(ring.begin(), ring.end(), [&](const Vector2d& a, const Vector2d& b) {
        return (a - point).squaredNorm() < (b - point).squaredNorm();
    });
}

// Where the tick's line meets the contour next to `near`.
std::optional<Vector2d> meeting(const Tick& tick, const Ring& contour, const Vector2d& near) {
    const Vector2d direction = (tick.to - tick.from).stableNormalized();
    std::optional<Vector2d> best;
    for (std::size_t i = 0; i < contour.size(); ++i) {
        const Vector2d& from = contour[i];
        const Vector2d& to = contour[(i + 1) % contour.size()];
        const double a = turn_of(direction, from - tick.from);
        const double b = turn_of(direction, to - tick.from);
        // An edge along the tick is where a tab begins, no side of the strip.
        const double length = (to - from).norm();
        if (std::abs(b - a) < kLeastCrossing * length || length == 0.0) {
            continue;
        }
        // Rounding may let a tick's line just miss the end of the edge that it points at.
        const double t = a / (a - b);
        const double slack = kTickCornerMm / length;
        if (t < -slack || t > 1.0 + slack) {
            continue;
        }
        const Vector2d point = from + std::clamp(t, 0.0, 1.0) * (to - from);
        if ((point - near).norm() < kLookMm &&
            (!best || (point - near).squaredNorm() < (*best - near).squaredNorm())) {
            best = point;
        }
    }
    return best;
}

Vector2d burnt_end(const RungEnd& end,
                   bool is_corner,
                   const Ring& contour,
                   const std::optional<Tick>& tick) {
    if (tick) {
        if (const auto point = meeting(*tick, contour, end.at)) {
            const Vector2d& corner = nearest_corner(contour, *point);
            return (corner - *point).norm() <= kTickCornerMm ? corner : *point;
        }
    }
    const Vector2d& corner = nearest_corner(contour, end.at);
    return is_corner && (corner - end.at).norm() <= kSameCornerMm ? corner
                                                                  : nearest_on(contour, end.at);
}

struct Rungs {
    Polyline left;
    Polyline right;
};

struct Edges {
    const Ring& planned;
    const Ring& burnt;
};

Rungs burnt_rungs(const Piece& piece,
                  const Edges& edges,
                  std::span<const BurntSegment> marks,
                  MeasuredPiece& measured) {
    const std::vector<Tick> planned = planned_lines(piece);
    const std::vector<Tick> burnt = burnt_lines(marks);
    const auto find = [&](RungEnd end) -> Vector2d {
        std::optional<Tick> tick;
        const auto wanted = tick_of(end, planned);
        if (wanted && *aside(*wanted, end) <= kPlannedAsideMm) {
            tick = tick_of(end, burnt);
            tick ? ++measured.ticks : ++measured.ticks_missing;
        }
        if (tick) {
            measured.largest_tick_miss_mm =
                std::max(measured.largest_tick_miss_mm, *aside(*tick, end));
        }
        const Vector2d reached = nearest_on(edges.planned, end.at);
        const Vector2d beyond = end.at - reached;
        if (beyond.norm() <= kReachedMm) {
            const Vector2d& corner = nearest_corner(edges.planned, end.at);
            const bool is_corner = (corner - end.at).norm() <= kReachedMm;
            return burnt_end(end, is_corner, edges.burnt, tick);
        }
        ++measured.filled_notches;
        end.at = reached;
        return burnt_end(end, false, edges.burnt, std::nullopt) + beyond;
    };
    Rungs rungs;
    for (std::size_t i = 0; i < piece.cut_left.size(); ++i) {
        rungs.left.push_back(find(rung_end(piece.cut_left, piece.cut_right, i)));
        rungs.right.push_back(find(rung_end(piece.cut_right, piece.cut_left, i)));
    }
    return rungs;
}

CellLengths lengths_of(const Rungs& rungs, std::size_t cell, bool fold_rises) {
    const Vector2d& l0 = rungs.left[cell];
    const Vector2d& l1 = rungs.left[cell + 1];
    const Vector2d& r0 = rungs.right[cell];
    const Vector2d& r1 = rungs.right[cell + 1];
    CellLengths lengths;
    lengths.first_rung = (l0 - r0).norm();
    lengths.last_rung = (l1 - r1).norm();
    lengths.left = (l1 - l0).norm();
    lengths.right = (r1 - r0).norm();
    lengths.fold = fold_rises ? (l1 - r0).norm() : (r1 - l0).norm();
    return lengths;
}

}  // namespace

MeasuredPiece measure_piece(const Piece& piece,
                            const Ring& edge,
                            const Ring& contour,
                            std::span<const BurntSegment> marks) {
    MeasuredPiece measured;
    const Rungs burnt = burnt_rungs(piece, {edge, contour}, marks, measured);
    const Rungs cut{piece.cut_left, piece.cut_right};
    const Rungs exact{piece.left, piece.right};
    for (std::size_t i = 0; i + 1 < exact.left.size(); ++i) {
        const bool rises = piece.fold_rises[i] != 0;
        CellLengths lengths = lengths_of(burnt, i, rises);
        const CellLengths planned = lengths_of(cut, i, rises);
        const CellLengths wanted = lengths_of(exact, i, rises);
        lengths.first_rung += wanted.first_rung - planned.first_rung;
        lengths.last_rung += wanted.last_rung - planned.last_rung;
        lengths.left += wanted.left - planned.left;
        lengths.right += wanted.right - planned.right;
        lengths.fold += wanted.fold - planned.fold;
        measured.cells.push_back(lengths);
    }
    return measured;
}

}  // namespace leafcutter::fab
