// Strips laid flat: every cell as two triangles hinged on a diagonal, cell after cell.
//
// Isometric: each quad edge and each fold diagonal keeps its length in space. Pieces lie as seen
// from outside the surface and run along +x at first; left is +y.

#pragma once

#include <array>
#include <vector>

#include "fab/strips/strip.h"
#include "geometry/quads/quad_mesh.h"

namespace leafcutter::fab {

// A cell as its strip walks over it: entered across l0–r0, left across l1–r1. Mesh vertices.
struct WalkedCell {
    int l0 = 0;
    int r0 = 0;
    int r1 = 0;
    int l1 = 0;
    Bend rising = Bend::Ac;  // Name of the diagonal r0–l1; the other one is l0–r1.
};

// The cells of `strip` in walking order, then those beyond its end. A cell that is met against its
// own direction is turned.
std::vector<WalkedCell> walk_cells(const geometry::QuadMesh& mesh, const Strip& strip);

// A run of cells of a strip; closed strips wrap.
struct CellRun {
    int first = 0;
    int count = 0;
};

struct Unfolded {
    Polyline left;  // count + 1 rung ends.
    Polyline right;
    std::vector<Bend> bend;        // Per cell.
    std::vector<double> fold_deg;  // Per cell: how far it bends on its diagonal.
    std::vector<char> fold_rises;  // Per cell: on the diagonal from its first right rung end.
};

// Lays `run` flat. The first rung stands at the origin, the way from its middle to that of the last
// rung points along +x. Exact to rounding, O(count).
Unfolded unfold(const geometry::QuadMesh& mesh,
                const std::vector<WalkedCell>& cells,
                const CellRun& run);

}  // namespace leafcutter::fab
