#include "fab/strips/mark_room.h"

#include <algorithm>
#include <limits>

#include "fab/strips/labels.h"

namespace leafcutter::fab {

namespace {

using Eigen::Vector2d;

struct Span {
    double low = std::numeric_limits<double>::infinity();
    double high = -std::numeric_limits<double>::infinity();
};

Span span_on(const MarkShape& shape, const Vector2d& axis) {
    Span span;
    for (int i = 0; i < shape.size(); ++i) {
        const double at = shape.point(i).dot(axis);
        span.low = std::min(span.low, at);
        span.high = std::max(span.high, at);
    }
    return span;
}

bool separates(const Vector2d& axis, const MarkShape& one, const MarkShape& other, double clear) {
    const Span a = span_on(one, axis);
    const Span b = span_on(other, axis);
    return b.low - a.high > clear || a.low - b.high > clear;
}

// Both directions of a box or a line are axes: its edges' normals, and for lines on one another
// their direction.
bool has_separating_axis(const MarkShape& one, const MarkShape& other, double clear) {
    const Vector2d side = (one.point(1) - one.point(0)).stableNormalized();
    return separates(side, one, other, clear) ||
           separates(Vector2d(-side.y(), side.x()), one, other, clear);
}

}  // namespace

MarkShape::MarkShape(const Vector2d& from, const Vector2d& to) : points_{from, to, to, to} {
    bounds_.extend(from);
    bounds_.extend(to);
}

MarkShape MarkShape::box(const Vector2d& middle, const Vector2d& along, const Vector2d& half) {
    const Vector2d x = half.x() * along;
    const Vector2d y = half.y() * Vector2d(-along.y(), along.x());
    MarkShape shape(middle - x - y, middle + x - y);
    shape.points_[2] = middle + x + y;
    shape.points_[3] = middle - x + y;
    shape.count_ = 4;
    shape.bounds_.extend(shape.points_[2]);
    shape.bounds_.extend(shape.points_[3]);
    return shape;
}

Polyline MarkShape::contour() const {
    Polyline line(points_.begin(), points_.begin() + count_);
    if (count_ > 2) {
        line.push_back(line.front());
    }
    return line;
}

bool are_apart(const MarkShape& one, const MarkShape& other, double clear_mm) {
    const Eigen::AlignedBox2d& a = one.bounds();
    const Eigen::AlignedBox2d& b = other.bounds();
    if (b.min().x() - a.max().x() > clear_mm || a.min().x() - b.max().x() > clear_mm ||
        b.min().y() - a.max().y() > clear_mm || a.min().y() - b.max().y() > clear_mm) {
        return true;
    }
    return has_separating_axis(one, other, clear_mm) || has_separating_axis(other, one, clear_mm);
}

MarkRoom::MarkRoom(const Piece& piece) : inside_(piece.outline) {
    for (const Polyline& cut : piece.cuts) {
        take(cut);
    }
    for (const Mark& mark : piece.marks) {
        take(mark.path);
        for (const Polyline& stroke : mark_strokes(mark)) {
            take(stroke);
        }
    }
}

bool MarkRoom::is_free(const MarkShape& shape, double clear_mm, std::optional<int> owner) const {
    return is_clear(shape, clear_mm, owner) && inside_.contains(shape.contour());
}

bool MarkRoom::is_clear(const MarkShape& shape, double clear_mm, std::optional<int> owner) const {
    return std::all_of(taken_.begin(), taken_.end(), [&](const Taken& taken) {
        return (owner && taken.owner == owner) || are_apart(shape, taken.shape, clear_mm);
    });
}

void MarkRoom::give_back(std::size_t all_behind) {
    taken_.erase(taken_.begin() + static_cast<std::ptrdiff_t>(all_behind), taken_.end());
}

void MarkRoom::take(const MarkShape& shape, std::optional<int> owner) {
    taken_.push_back({shape, owner});
}

void MarkRoom::take(const Polyline& line) {
    for (std::size_t i = 0; i + 1 < line.size(); ++i) {
        take(MarkShape(line[i], line[i + 1]));
    }
}

}  // namespace leafcutter::fab
