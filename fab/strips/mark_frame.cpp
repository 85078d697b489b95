#include "fab/strips/mark_frame.h"

#include <algorithm>
#include <cmath>

#include "geometry/plane.h"

namespace leafcutter::fab {

using geometry::turn_of;

namespace {

using Eigen::Vector2d;

std::size_t nearest(const Ring& ring, const Vector2d& point) {
    const auto nearer = [&](const Vector2d& a, const Vector2d& b) {
        return (a - point).squaredNorm() < (b - point).squaredNorm();
    };
    return static_cast<std::size_t>(std::min_element(ring.begin(), ring.end(), nearer) -
                                    ring.begin());
}

// The centre of gravity of what the ring encloses on its way from one of its points to another.
Vector2d centre_between(const Ring& ring, const Vector2d& from, const Vector2d& to) {
    const std::size_t last = nearest(ring, to);
    Vector2d sum = Vector2d::Zero();
    double area = 0.0;
    for (std::size_t i = nearest(ring, from); i != last; i = (i + 1) % ring.size()) {
        const Vector2d& a = ring[i];
        const Vector2d& b = ring[(i + 1) % ring.size()];
        const double part = turn_of(a - from, b - from);
        area += part;
        sum += part * (a + b + from) / 3.0;
    }
    return std::abs(area) > 0.0 ? Vector2d(sum / area) : Vector2d((from + to) / 2.0);
}

}  // namespace

MarkCell::MarkCell(const Vector2d& l0, const Vector2d& r0, const Vector2d& l1, const Vector2d& r1)
    : left0(l0), right0(r0), left1(l1), right1(r1), middle((l0 + r0 + l1 + r1) / 4.0) {
    const Vector2d way = (l1 + r1 - l0 - r0) / 2.0;
    length_mm = way.norm();
    along = length_mm > 0.0 ? Vector2d(way / length_mm) : Vector2d::UnitX();
    width_mm = ((l0 - r0).norm() + (l1 - r1).norm()) / 2.0;
}

bool MarkCell::holds(const MarkShape& shape) const {
    for (int i = 0; i < shape.size(); ++i) {
        const Vector2d& point = shape.point(i);
        if (turn_of(left0 - right0, point - right0) >= 0.0 ||
            turn_of(left1 - right1, point - right1) <= 0.0) {
            return false;
        }
    }
    return true;
}

MarkFrame::MarkFrame(const Piece& piece) : piece_(piece) {
    for (std::size_t i = 0; i < piece.cut_left.size(); ++i) {
        middle_.emplace_back((piece.cut_left[i] + piece.cut_right[i]) / 2.0);
        at_.push_back(i == 0 ? 0.0 : at_.back() + (middle_[i] - middle_[i - 1]).norm());
    }
}

MarkCell MarkFrame::cell(std::size_t i) const {
    return {piece_.cut_left[i], piece_.cut_right[i], piece_.cut_left[i + 1],
            piece_.cut_right[i + 1]};
}

std::optional<MarkCell> MarkFrame::tab(PieceEnd end) const {
    const bool start = end == PieceEnd::Start;
    if ((start ? piece_.start_tab : piece_.end_tab).length_mm <= 0.0) {
        return std::nullopt;
    }
    const std::size_t rung = start ? 0 : cells();
    const Vector2d& left = piece_.cut_left[rung];
    const Vector2d& right = piece_.cut_right[rung];
    const Vector2d middle = (left + right) / 2.0;
    const Vector2d way = 2.0 * (start ? centre_between(piece_.outline, left, right)
                                      : centre_between(piece_.outline, right, left)) -
                         2.0 * middle;
    return start ? MarkCell(left + way, right + way, left, right)
                 : MarkCell(left, right, left + way, right + way);
}

Vector2d MarkFrame::point(double s_mm) const {
    const auto upper = std::upper_bound(at_.begin(), at_.end(), s_mm);
    const auto last = static_cast<std::ptrdiff_t>(at_.size()) - 1;
    const auto k =
        static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(upper - at_.begin(), 1, last));
    const double step = at_[k] - at_[k - 1];
    const double part = step > 0.0 ? std::clamp((s_mm - at_[k - 1]) / step, 0.0, 1.0) : 0.0;
    return middle_[k - 1] + part * (middle_[k] - middle_[k - 1]);
}

double MarkFrame::widest_mm() const {
    double width = 0.0;
    for (std::size_t i = 0; i < piece_.cut_left.size(); ++i) {
        width = std::max(width, (piece_.cut_left[i] - piece_.cut_right[i]).norm());
    }
    return width;
}

}  // namespace leafcutter::fab
