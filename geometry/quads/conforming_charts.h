// Charts whose columns go on into their neighbours': g is prescribed along critical arcs, the same
// whole numbers of columns from both sides.

#pragma once

#include <vector>

#include "geometry/context.h"
#include "geometry/foliation.h"
#include "geometry/quads/critical_arcs.h"
#include "geometry/quads/junction_counts.h"
#include "geometry/quads/quad_mesh.h"

namespace leafcutter::geometry {

// The cylinder with g changed by the harmonic function that has the wanted values at its critical
// ends and natural ones at open ends: column j lies at g = j width / cols, and column 0 begins at
// the lower end's first vertex (the upper's, if the lower is open). f stays.
// Throws Error(SelfCheck, "chart-not-bijective").
Cylinder conform_chart(const Foliation& foliation,
                       const ArcNetwork& network,
                       const JunctionCounts& counts,
                       int cylinder,
                       const Context& context);

// Its grid: even columns, rows evenly wide on the surface or where the counts say.
CylinderGrid conforming_grid(const Cylinder& chart, const JunctionCounts& counts, int cylinder);

}  // namespace leafcutter::geometry
