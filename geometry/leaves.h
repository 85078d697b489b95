// Sampled leaves of both foliations as polylines on the surface, for drawing.

#pragma once

#include <vector>

#include <Eigen/Core>

#include "geometry/foliation.h"
#include "geometry/quads/quad_mesh.h"

namespace leafcutter::geometry {

struct Leaf {
    bool of_conjugate = false;  // A leaf of F* (constant g), else of F (constant f).
    int cylinder = 0;
    double level = 0.0;
    bool closed = false;
    std::vector<Eigen::Vector3d> points;  // On the surface: crossings with triangle edges.
};

// The leaves at the grid's own levels; every `stride`-th of them where they are many.
std::vector<Leaf> sample_leaves(const Foliation& foliation, const QuadMesh& quads, int stride = 1);

}  // namespace leafcutter::geometry
