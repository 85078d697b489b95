// Tips of limbs: fingers, legs, ears. Where a conformal foliation has cells exponentially too large
// or small unless a hole is opened there.

#pragma once

#include <span>
#include <vector>

#include "geometry/context.h"
#include "geometry/types.h"

namespace leafcutter::geometry {

struct LimbTip {
    int vertex = 0;
    // By how much the tip is farther from everything, on average, than the place where its limb
    // joins a longer one or one that ends in a boundary; by the diagonal of the bounding box.
    double persistence = 0.0;
};

struct LimbTipOptions {
    double least_persistence = 0.01;
    // Of tips from one another and from the boundary, by the diagonal of the bounding box.
    double least_distance = 0.08;
};

// Tips of the limbs of a connected surface, longest limb first: maxima of the average distance from
// 40 points spread over the surface, by persistence. A boundary loop counts as the end of the limb
// that it is on. Deterministic. For at most about ten thousand vertices: see coarse_version.h.
std::vector<LimbTip> find_limb_tips(const TriangleMesh& mesh,
                                    const LimbTipOptions& options,
                                    const Context& context);

// `count` vertices far from `taken`, from the boundary and from one another, one after the other.
std::vector<int> farthest_vertices(const TriangleMesh& mesh,
                                   std::span<const int> taken,
                                   std::size_t count,
                                   const Context& context);

// Radius of the limb that ends at `vertex`, as a round tube with a round cap would have it; at most
// `most`.
double limb_radius(const TriangleMesh& mesh, int vertex, double most);

}  // namespace leafcutter::geometry
