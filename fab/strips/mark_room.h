// What is still free on a piece for another mark.

#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "fab/strips/overlap.h"
#include "fab/strips/strip.h"

namespace leafcutter::fab {

// A line or a box, convex.
class MarkShape {
public:
    MarkShape(const Eigen::Vector2d& from, const Eigen::Vector2d& to);
    // A box about `middle`; `half` reaches along its unit direction `along` and across.
    static MarkShape box(const Eigen::Vector2d& middle,
                         const Eigen::Vector2d& along,
                         const Eigen::Vector2d& half);

    int size() const { return count_; }
    const Eigen::Vector2d& point(int i) const { return points_[static_cast<std::size_t>(i)]; }
    const Eigen::AlignedBox2d& bounds() const { return bounds_; }
    // Its points in order, a box closed.
    Polyline contour() const;

private:
    std::array<Eigen::Vector2d, 4> points_;
    int count_ = 2;
    Eigen::AlignedBox2d bounds_;
};

// True if the shapes are more than `clear_mm` apart. (False for some whose corners are just so far
// apart: judged by separating axes.)
bool are_apart(const MarkShape& one, const MarkShape& other, double clear_mm);

class MarkRoom {
public:
    // `piece` must outlive this object. Its slits and the marks that it has are taken already.
    explicit MarkRoom(const Piece& piece);

    // True if `shape` lies strictly inside the outline and `clear_mm` or more from all that is
    // taken, but for what `owner` took.
    bool is_free(const MarkShape& shape, double clear_mm, std::optional<int> owner = {}) const;

    // As is_free, wherever the outline runs.
    bool is_clear(const MarkShape& shape, double clear_mm, std::optional<int> owner = {}) const;

    void take(const MarkShape& shape, std::optional<int> owner = {});
    void take(const Polyline& line);

    // What is taken may be given back, last first.
    std::size_t taken() const { return taken_.size(); }
    void give_back(std::size_t all_behind);

private:
    struct Taken {
        MarkShape shape;
        std::optional<int> owner;
    };

    RingInterior inside_;
    std::vector<Taken> taken_;
};

}  // namespace leafcutter::fab
