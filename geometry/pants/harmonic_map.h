// The harmonic map to the dual tree: minimises the energy of section 3.3 in a homotopy class.
//
// The energy is convex and piecewise quadratic. Newton steps with frozen words alternate with exact
// one-vertex minimisations (the paper's Algorithm 1, with tree distances) where words change.
// Energies never rise.

#pragma once

#include <span>
#include <vector>

#include "geometry/context.h"
#include "geometry/pants/tree_word.h"
#include "geometry/pants/vertex_rings.h"

namespace leafcutter::geometry {

// Cold: far from the minimum, which a good many sweeps come first to undo. Warm: a solved map
// carried to a finer surface.
enum class MapStart { Cold, Warm };

// Draft: near enough to compare maps by, about four digits of the energy. Full: to rounding.
enum class MapAccuracy { Draft, Full };

struct MapOptions {
    MapOptions(MapStart map_start,  // NOLINT(google-explicit-constructor): the usual choice alone.
               MapAccuracy map_accuracy = MapAccuracy::Full)
        : start(map_start), accuracy(map_accuracy) {}
    MapStart start;
    MapAccuracy accuracy;
};

struct HarmonicMapReport {
    double energy = 0.0;  // 1/2 sum of weight x distance squared.
    int iterations = 0;   // Newton steps.
    int factorizations = 0;
    int solves = 0;  // With those factors.
    double residual =
        0.0;  // Largest move of a vertex in one more sweep, by the largest graph edge.
    bool converged = false;
    std::vector<double> energies;  // Before the first Newton step and after each; never rising.
};

// 1/2 sum of weight x distance squared.
double map_energy(const GraphMap& map, const VertexRings& rings, std::span<const double> weights);

// Improves `map` to the minimum in its class. `weights` are per mesh edge and positive.
HarmonicMapReport solve_harmonic_map(GraphMap& map,
                                     const VertexRings& rings,
                                     std::span<const double> weights,
                                     const MapOptions& options,
                                     const Context& context);

// Puts the given vertices to their centres, all others held, forwards and backwards so many times.
void settle_vertices(GraphMap& map,
                     const VertexRings& rings,
                     std::span<const double> weights,
                     std::span<const int> vertices,
                     int passes);

}  // namespace leafcutter::geometry
