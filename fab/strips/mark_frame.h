// Where marks go on a piece: its middle line, its cells, its tabs, as they lie on the sheet.

#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "fab/strips/mark_room.h"
#include "fab/strips/strip.h"

namespace leafcutter::fab {

// The part of a piece between two rungs.
struct MarkCell {
    Eigen::Vector2d left0;
    Eigen::Vector2d right0;
    Eigen::Vector2d left1;
    Eigen::Vector2d right1;
    Eigen::Vector2d middle;
    Eigen::Vector2d along;  // The way the strip runs, a unit vector.
    double length_mm = 0.0;
    double width_mm = 0.0;

    MarkCell(const Eigen::Vector2d& l0,
             const Eigen::Vector2d& r0,
             const Eigen::Vector2d& l1,
             const Eigen::Vector2d& r1);

    // To the left of the way.
    Eigen::Vector2d across() const { return {-along.y(), along.x()}; }
    // True if the shape stays between the two rungs, thought endless.
    bool holds(const MarkShape& shape) const;
};

enum class PieceEnd { Start, Finish };

class MarkFrame {
public:
    // Of `piece.cut_left` and `cut_right`; the piece must outlive this object.
    explicit MarkFrame(const Piece& piece);

    std::size_t cells() const { return at_.size() - 1; }
    MarkCell cell(std::size_t i) const;
    // The tab beyond an end's rung; none if there is none.
    std::optional<MarkCell> tab(PieceEnd end) const;

    double length_mm() const { return at_.back(); }
    // How far along the middle line a rung stands.
    double position_mm(std::size_t rung) const { return at_[rung]; }
    // The point of the middle line at `s_mm`, clamped to its ends.
    Eigen::Vector2d point(double s_mm) const;
    double widest_mm() const;

private:
    const Piece& piece_;
    Polyline middle_;
    std::vector<double> at_;
};

}  // namespace leafcutter::fab
