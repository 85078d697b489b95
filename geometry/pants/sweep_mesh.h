// A surface made ready for a sweep by a function: closed, and with simple saddles only.
//
// Boundary loops are capped, interior edges between loops of one stage are split, and saddles of
// higher order are pulled apart into simple ones of equal value. So the Reeb graph is trivalent and
// has as many cycles as the surface has handles, whatever the function. What was added has no
// thickness: every added vertex stands for a vertex of the surface, its owner.

#pragma once

#include <array>
#include <span>
#include <vector>

#include "geometry/half_edges.h"
#include "geometry/pants/vertex_rings.h"

namespace leafcutter::geometry {

struct SweepMesh {
    std::vector<std::array<int, 3>> triangles;
    HalfEdges half_edges;
    VertexRings rings;
    int surface_vertices = 0;  // The surface's own come first, then one apex for each loop.
    std::vector<double> value;
    std::vector<int> owner;         // Itself for the surface's own vertices, -1 for an apex.
    std::vector<char> keeps_limbs;  // Added to take a limb off a saddle, or on a chord.
    std::vector<int> order;         // Vertices as the sweep meets them,
    std::vector<int> rank;          // and the inverse.
};

// A limb that ends in the surface and starts at a saddle of higher order, towards a neighbour of
// it. It is taken off first, to the saddle's other side: left on, it would part what is connected
// round it.
struct LimbAtSaddle {
    int saddle = 0;
    int neighbour = 0;
};

struct SaddleParting {
    std::span<const LimbAtSaddle> limbs = {};
    int turn = 0;  // Which part of a saddle of higher order is pulled off first.
};

// `values` per vertex; equal ones are told apart by index. Loops (surface to the left) are level
// sets, lowest of all where `loop_is_low`, else highest; so are their caps beyond them. What
// `values` says on loops is not read.
SweepMesh make_sweep_mesh(std::span<const std::array<int, 3>> triangles,
                          std::span<const double> values,
                          std::span<const std::vector<int>> boundary_loops,
                          std::span<const char> loop_is_low,
                          const SaddleParting& parting = {});

}  // namespace leafcutter::geometry
