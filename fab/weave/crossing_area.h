// Where two strips lie on each other: what clearance leaves of each cell, and how it folds.

#pragma once

#include <array>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "fab/strips/strip.h"
#include "fab/weave/woven_model.h"
#include "geometry/quads/quad_mesh.h"

namespace leafcutter::fab {

// Corners in the order of the quad's: a b c d.
struct CrossingArea {
    std::array<Eigen::Vector3d, 4> corner;
    // A point moved by d times this lies on the planes of its triangles moved by d along their
    // outward normals: on the fold it is longer than 1.
    std::array<Eigen::Vector3d, 4> up;
    bool folds_ac = true;
    double fold_rad = 0.0;
};

// A cell of a strip as it is walked: which corners of its quad are left and right, before, behind.
struct CellCorners {
    std::size_t l0 = 0;
    std::size_t r0 = 0;
    std::size_t r1 = 0;
    std::size_t l1 = 0;
};

// A strip on the mesh: its corners cell by cell, and how much of each rung the clearance takes, as
// parts of the rung from its left and its right end. One rung more than cells; the last of a closed
// strip is its first.
struct NarrowedStrip {
    std::vector<CellCorners> cells;
    std::vector<double> left;
    std::vector<double> right;
};

std::vector<NarrowedStrip> narrow_strips(const geometry::QuadMesh& mesh,
                                         std::span<const Strip> strips,
                                         const WovenRules& rules);

// One per quad; `narrowed` belong to `strips`.
std::vector<CrossingArea> crossing_areas(const geometry::QuadMesh& mesh,
                                         std::span<const Strip> strips,
                                         std::span<const NarrowedStrip> narrowed);

}  // namespace leafcutter::fab
