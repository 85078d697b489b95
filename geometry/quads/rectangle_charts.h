// Charts of rectangles whose rows go on into their neighbours': f is prescribed along flanks, the
// same levels from both sides.

#pragma once

#include "geometry/context.h"
#include "geometry/foliation.h"
#include "geometry/quads/critical_sides.h"
#include "geometry/quads/quad_mesh.h"
#include "geometry/quads/rectangle_counts.h"
#include "geometry/quads/rectangle_rows.h"

namespace leafcutter::geometry {

// What is known before any mesh is made. Refers to all of it.
struct RectanglePlan {
    const Foliation& foliation;
    const SideNetwork& network;
    const RectangleCounts& counts;
    const RectangleRows& rows;
};

// The rectangle with f changed by the harmonic function that brings its flanks to their levels. g
// stays.
// Throws Error(SelfCheck, "chart-not-bijective").
Cylinder bend_chart(const RectanglePlan& plan, int cylinder, const Context& context);

// Its grid: rows of the bands it passes, columns evenly wide on the surface.
CylinderGrid rectangle_grid(const RectanglePlan& plan, const Cylinder& chart, int cylinder);

}  // namespace leafcutter::geometry
