// Solves a chart on a surface fine enough for it.
//
// Linear functions on coarse triangles follow a harmonic map badly, most of all at the corners of a
// disk. The energies of f and of its conjugate bound the conformal modulus from both sides; how far
// they are apart, triangle by triangle, is how far the map is from conformal there. Triangles with
// most of that error are split, flat, and the chart is solved again.

#pragma once

#include <functional>

#include "geometry/context.h"
#include "geometry/foliation.h"
#include "geometry/harmonic/chart_map.h"

namespace leafcutter::geometry {

struct SolvedChart {
    ChartMap map;
    double upper = 0.0;          // Bounds of width / height: twice the energy of f for height 1,
    double lower = 0.0;          // and one over that of its conjugate with period or range 1.
    double flux_mismatch = 0.0;  // Of f, between its leaves; see flux_variation().

    double gap() const { return upper / lower - 1.0; }
};

// Calls `solve` until the gap is small or the surface large. Returns its last answer.
SolvedChart solve_resolved(ChartSurface surface,
                           const std::function<SolvedChart(const ChartSurface&)>& solve,
                           Refinement refinement,
                           const Context& context);

}  // namespace leafcutter::geometry
