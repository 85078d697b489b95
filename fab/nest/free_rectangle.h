// The largest rectangle along the axes in a polygon.

#pragma once

#include <span>

#include <Eigen/Core>

#include "fab/material/material.h"
#include "fab/strips/strip.h"

namespace leafcutter::fab {

struct FreeRectangle {
    Eigen::Vector2d corner = Eigen::Vector2d::Zero();  // Lower left.
    SheetSize size;
};

// About the largest one inside the first ring and outside of all others, which may overlap; of no
// size if there is none. Found on a raster, then each side moved out as far as it goes.
FreeRectangle largest_rectangle_in(std::span<const Ring> rings);

}  // namespace leafcutter::fab
