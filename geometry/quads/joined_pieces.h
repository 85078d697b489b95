// The pieces of a quad mesh whose cylinders share vertices: what rings and rectangles have in
// common.

#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/context.h"
#include "geometry/quads/conforming_mesh.h"
#include "geometry/quads/patch.h"

namespace leafcutter::geometry {

// A cylinder's own grid, before its vertices are shared.
struct JoinedPiece {
    Cylinder chart;
    CylinderGrid grid;
    Patch patch;
    CellRegions regions;
    std::vector<SagCell> cells;
};

// The chart's grid on the surface. Throws Error(SelfCheck) unless its cells stand for all of it.
JoinedPiece sample_piece(Cylinder chart, CylinderGrid grid, int cylinder, const Context& context);

// Gives the quads' corners their numbers in the whole.
void renumber(JoinedPiece& piece, const std::vector<int>& number);

// Fills the mesh, which has its vertices, with its parts, in order, and counts those folded over.
void add_parts(JoinedMesh& mesh, std::vector<JoinedPiece> pieces, const GridOptions& options);

// What theory says of the whole.
struct JoinedTopology {
    std::vector<int> valences;  // Quads round each vertex, two more at a boundary.
    int open_edges = 0;
    int doubled_euler = 0;
};

// Throws Error(SelfCheck, "quads-topology") unless the mesh is as theory says. `parts` names what
// was joined.
void check_topology(const JoinedMesh& mesh, const JoinedTopology& wanted, std::string_view parts);

// Counts fixed for each cylinder, and their names in the job's parameters.
struct FixedCounts {
    std::vector<RowsCols> counts;
    std::vector<std::string> paths;
};
FixedCounts fixed_counts(const GridOptions& options, std::size_t cylinders);

}  // namespace leafcutter::geometry
