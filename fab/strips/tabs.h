// Tabs: what a piece has past its ends to be joined by.
//
// A glue tab goes on over the cells behind the joint, a little narrower than the strip, so that it
// hides under the piece it is glued to. An arrow goes through a slit in that piece: its neck is
// narrower than the slit, its head wider; bent through, it holds without glue.

#pragma once

#include <optional>

#include "fab/strips/strip.h"

namespace leafcutter::fab {

// Both sides of a strip or of a part of it, rung by rung.
struct Band {
    Polyline left;
    Polyline right;

    std::size_t rungs() const { return left.size(); }
    Eigen::Vector2d middle(std::size_t i) const { return (left[i] + right[i]) / 2.0; }
    double width(std::size_t i) const { return (left[i] - right[i]).norm(); }
};

// Length of the middle line.
double length_of(const Band& band);

// The band from its first rung on, at most `length_mm` long.
Band cut_off(const Band& band, double length_mm);

// The band from its other end.
Band reversed(const Band& band);

// `band` begins at the joint. Insets never go below `min_width_mm`.
Band glue_tab(const Band& band, double length_mm, double min_width_mm);

// Where an arrow's slit lies behind the joint, and how wide it is.
struct Arrow {
    double slit_at_mm = 0.0;
    double slit_width_mm = 0.0;
};

struct ArrowTab {
    Band band;
    Arrow arrow;
};

// None if the band is too narrow or too short for it.
std::optional<ArrowTab> arrow_tab(const Band& band, double length_mm, double min_width_mm);

}  // namespace leafcutter::fab
