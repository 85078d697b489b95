// The woven object with its thickness: every strip as a slab, over and under. All lengths are mm.
//
// Every cell of the quad mesh is folded on the diagonal on which it folds less. Where two strips
// cross, both are parallel offsets of this surface, half of both thicknesses apart, so that they
// touch all over and nowhere cut into each other, however much the surface bends. All of the way
// up and down lies in the gaps that the clearance leaves between crossing strips, on the arcs of
// thickness.h. Where these gaps have no room for it (tiny cells, or cells that meet at a sharp
// angle), strips are drawn narrower than they are cut, and that is counted. Ends of open strips
// stop half a clearance before the border of their last cell; tabs are not modelled.

#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "fab/strips/crossings.h"
#include "fab/strips/strip.h"
#include "geometry/context.h"
#include "geometry/quads/quad_mesh.h"

namespace leafcutter::fab {

// A line across a strip's middle surface. Half the thickness times `up` leads to the outer face;
// `up` is longer than 1 on folds, where two parallel faces meet.
struct WovenRung {
    Eigen::Vector3d left;
    Eigen::Vector3d right;
    Eigen::Vector3d left_up;
    Eigen::Vector3d right_up;
};

// From a rung to the next.
struct WovenSegment {
    int cell = 0;           // Into the strip's quads; of a gap the nearer one.
    bool crossing = false;  // All of it lies on the crossing strip; else in a gap.
    bool rises = true;      // Folds from the first right rung end to the second left one.
};

struct WovenStrip {
    int strip = 0;  // Into the list of strips.
    double thickness_mm = 0.0;
    bool closed = false;
    std::vector<WovenRung> rungs;
    std::vector<WovenSegment> segments;  // One less than rungs; as many if closed.
};

// A cell of a strip in which it lies in another strip.
struct Clash {
    int strip = 0;
    int cell = 0;
    double depth_mm = 0.0;
};

struct WovenModel {
    std::vector<WovenStrip> strips;  // In the order of the strips.

    // The smallest distance between two strips that cross, and between neighbours of one family:
    // negative as deep as they would have to lie in each other. None: there are no two so near.
    std::optional<double> smallest_gap_mm;
    std::optional<double> smallest_side_gap_mm;
    int overlaps = 0;       // Crossings where two strips are less than -1e-6 mm apart.
    int side_overlaps = 0;  // Cells in which a strip lies in a neighbour of its family.

    // The same for strips as wide as they are cut, before some were drawn narrower.
    int tight_crossings = 0;
    int tight_sides = 0;
    double lacking_mm = 0.0;   // As deep as two of them would lie in each other at most.
    std::vector<Clash> tight;  // Where, of both strips; the deepest come first.
    int narrowed_cells = 0;    // Cells of strips that were drawn narrower,
    double narrowed_mm = 0.0;  // on either side by this much at most.
};

struct WovenRules {
    std::array<double, 2> thickness_mm{};  // Of weft and warp.
    std::array<double, 2> min_width_mm{};  // No clearance makes a strip narrower.
    double clearance_mm = 0.0;             // Taken off each long side.
};

// O(cells), and measured by exact tests of all the convex parts of slabs against each other
// (woven_gaps.h).
WovenModel build_woven_model(const geometry::QuadMesh& mesh,
                             std::span<const Strip> strips,
                             const Crossings& crossings,
                             const WovenRules& rules,
                             const geometry::Context& context = {});

}  // namespace leafcutter::fab
