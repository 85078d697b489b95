#include "geometry/triangulate.h"

#include <algorithm>
#include <cstddef>
#include <deque>
#include <utility>

#include <Eigen/Geometry>

#include "geometry/plane.h"

namespace leafcutter::geometry {

namespace {

// The polygon seen along its normal, counter-clockwise: the normal is Newell's, twice the vector
// area.
std::vector<Eigen::Vector2d> flatten(std::span<const std::uint32_t> corners,
                                     std::span<const Eigen::Vector3d> positions) {
    const Eigen::Vector3d& origin = positions[corners[0]];
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const Eigen::Vector3d a = positions[corners[i]] - origin;
        const Eigen::Vector3d b = positions[corners[(i + 1) % corners.size()]] - origin;
        normal += a.cross(b);
    }
    const Eigen::Vector3d up =
        normal.norm() > 0.0 ? Eigen::Vector3d(normal.normalized()) : Eigen::Vector3d::UnitZ();
    const Eigen::Vector3d right = up.unitOrthogonal();
    const Eigen::Vector3d forward = up.cross(right);
    std::vector<Eigen::Vector2d> flat;
    flat.reserve(corners.size());
    for (const std::uint32_t corner : corners) {
        const Eigen::Vector3d p = positions[corner] - origin;
        flat.emplace_back(p.dot(right), p.dot(forward));
    }
    return flat;
}

// The polygon that is left, as a ring of places, and which of them may be an ear.
//
// Candidates wait in a queue and the neighbours of a clipped ear go to its end, so that ears are
// taken all around the polygon in turn, and not as one fan of slivers.
class EarClipper {
public:
    explicit EarClipper(std::vector<Eigen::Vector2d> points);

    struct Ear {
        std::size_t before;
        std::size_t tip;
        std::size_t after;
    };
    // Cuts an ear off. To be called while more than 3 corners are left.
    Ear clip();
    Ear last() const { return {before_[start_], start_, after_[start_]}; }

private:
    double turn(std::size_t tip) const;
    bool is_ear(std::size_t tip) const;
    std::size_t next_tip();
    std::size_t least_bad_tip() const;
    void enqueue(std::size_t tip);
    void drop_from_reflex(std::size_t tip);

    std::vector<Eigen::Vector2d> points_;
    std::vector<std::size_t> before_;
    std::vector<std::size_t> after_;
    std::vector<std::size_t> reflex_;  // Corners that turn right or go straight on.
    struct Candidate {
        std::size_t tip;
        std::size_t stamp;
    };
    std::vector<std::size_t> stamp_;  // Of a corner's latest candidate; older ones don't count.
    std::deque<Candidate> queue_;
    std::size_t start_ = 0;
    double flat_turn_ = 0.0;  // Turns up to this are straight but for rounding.
};

EarClipper::EarClipper(std::vector<Eigen::Vector2d> points) : points_(std::move(points)) {
    const std::size_t count = points_.size();
    Eigen::Vector2d low = points_[0];
    Eigen::Vector2d high = points_[0];
    for (std::size_t i = 0; i < count; ++i) {
        before_.push_back((i + count - 1) % count);
        after_.push_back((i + 1) % count);
        low = low.cwiseMin(points_[i]);
        high = high.cwiseMax(points_[i]);
    }
    constexpr double kRounding = 1e-14;  // Of the squared extent.
    flat_turn_ = kRounding * (high - low).squaredNorm();
    stamp_.assign(count, 0);
    for (std::size_t i = 0; i < count; ++i) {
        if (turn(i) <= flat_turn_) {
            reflex_.push_back(i);
        } else {
            enqueue(i);
        }
    }
}

double EarClipper::turn(std::size_t tip) const {
    return turn_of(points_[tip] - points_[before_[tip]], points_[after_[tip]] - points_[tip]);
}

bool EarClipper::is_ear(std::size_t tip) const {
    if (turn(tip) <= flat_turn_) {
        return false;
    }
    const Eigen::Vector2d& a = points_[before_[tip]];
    const Eigen::Vector2d& b = points_[tip];
    const Eigen::Vector2d& c = points_[after_[tip]];
    for (const std::size_t other : reflex_) {
        const Eigen::Vector2d& p = points_[other];
        if (p == a || p == b || p == c) {
            continue;  // The same corner, or its twin at the far side of a keyhole cut.
        }
        if (turn_of(b - a, p - a) >= 0.0 && turn_of(c - b, p - b) >= 0.0 &&
            turn_of(a - c, p - c) >= 0.0) {
            return false;
        }
    }
    return true;
}

void EarClipper::enqueue(std::size_t tip) {
    queue_.push_back({tip, ++stamp_[tip]});
}

void EarClipper::drop_from_reflex(std::size_t tip) {
    std::erase(reflex_, tip);
}

// No ear is left: the polygon crosses itself or what remains is flat. The sharpest left turn does
// least harm.
std::size_t EarClipper::least_bad_tip() const {
    std::size_t best = start_;
    for (std::size_t tip = after_[start_]; tip != start_; tip = after_[tip]) {
        if (turn(tip) > turn(best)) {
            best = tip;
        }
    }
    return best;
}

std::size_t EarClipper::next_tip() {
    while (!queue_.empty()) {
        const Candidate candidate = queue_.front();
        queue_.pop_front();
        if (candidate.stamp == stamp_[candidate.tip] && is_ear(candidate.tip)) {
            return candidate.tip;
        }
    }
    return least_bad_tip();
}

EarClipper::Ear EarClipper::clip() {
    const std::size_t tip = next_tip();
    const Ear ear{before_[tip], tip, after_[tip]};
    after_[ear.before] = ear.after;
    before_[ear.after] = ear.before;
    start_ = ear.after;
    drop_from_reflex(tip);
    ++stamp_[tip];
    for (const std::size_t neighbour : {ear.before, ear.after}) {
        if (turn(neighbour) > flat_turn_) {
            drop_from_reflex(neighbour);
            enqueue(neighbour);
        }
    }
    return ear;
}

// Along the diagonal that lies inside, or the shorter one if both do.
void triangulate_quad(std::span<const std::uint32_t> corners,
                      std::span<const Eigen::Vector3d> positions,
                      std::vector<Triangle>& triangles) {
    const std::vector<Eigen::Vector2d> flat = flatten(corners, positions);
    const auto turn = [&](std::size_t tip) {
        return turn_of(flat[tip] - flat[(tip + 3) % 4], flat[(tip + 1) % 4] - flat[tip]);
    };
    const double across_02 = std::min(turn(1), turn(3));
    const double across_13 = std::min(turn(0), turn(2));
    const double length_02 = (positions[corners[0]] - positions[corners[2]]).squaredNorm();
    const double length_13 = (positions[corners[1]] - positions[corners[3]]).squaredNorm();
    const bool both_inside = across_02 > 0.0 && across_13 > 0.0;
    if (both_inside ? length_02 <= length_13 : across_02 >= across_13) {
        triangles.push_back({corners[0], corners[1], corners[2]});
        triangles.push_back({corners[0], corners[2], corners[3]});
    } else {
        triangles.push_back({corners[0], corners[1], corners[3]});
        triangles.push_back({corners[1], corners[2], corners[3]});
    }
}

}  // namespace

void triangulate_polygon(std::span<const std::uint32_t> corners,
                         std::span<const Eigen::Vector3d> positions,
                         std::vector<Triangle>& triangles) {
    if (corners.size() == 3) {
        triangles.push_back({corners[0], corners[1], corners[2]});
        return;
    }
    if (corners.size() == 4) {
        triangulate_quad(corners, positions, triangles);
        return;
    }
    EarClipper polygon(flatten(corners, positions));
    const auto append = [&](const EarClipper::Ear& ear) {
        triangles.push_back({corners[ear.before], corners[ear.tip], corners[ear.after]});
    };
    for (std::size_t left = corners.size(); left > 3; --left) {
        append(polygon.clip());
    }
    append(polygon.last());
}

}  // namespace leafcutter::geometry
