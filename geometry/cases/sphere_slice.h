// From the double cover of a sphere to the pillowcase: the surface slit open along the two arcs
// where f is a multiple of half its period.

#pragma once

#include <array>

#include "geometry/cases/sphere_cover.h"
#include "geometry/harmonic/chart_map.h"
#include "geometry/harmonic/chart_surface.h"

namespace leafcutter::geometry {

// A chart of shape Pillowcase: height 1, g = 0 at the vertex folds[0][0]. The two arcs are the
// lower and the upper boundary.
struct PillowChart {
    ChartMap map;
    std::array<std::array<int, 2>, 2> folds{};  // The ends of the lower and of the upper arc.
};

// `on_cover` is an exactly odd chart of shape Torus and height 1 of `cover`, (0, 0) at the first of
// `points`, without flipped triangles. No edge of the surface joins two of the points. Moves
// vertices that lie too near an arc off it.
PillowChart slice_pillowcase(const ChartSurface& surface,
                             const BranchedCover& cover,
                             ChartMap on_cover,
                             const std::array<int, 4>& points);

}  // namespace leafcutter::geometry
