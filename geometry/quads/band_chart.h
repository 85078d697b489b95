// A band of connected leaves of F as one chart.

#pragma once

#include "geometry/foliation.h"
#include "geometry/quads/critical_sides.h"

namespace leafcutter::geometry {

// All triangles of its rectangles that reach between two levels of f, over each other in (g, f): no
// map, but fit to measure (spacing.h) how wide the strips between levels are. f counts from `low`.
Cylinder chart_of_band(const Foliation& foliation, const FormBand& band, double low, double high);

}  // namespace leafcutter::geometry
