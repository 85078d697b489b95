// One quad mesh across critical leaves: rings of a foliation by pants share the vertices on the
// arcs between them.

#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "geometry/context.h"
#include "geometry/foliation.h"
#include "geometry/quads/quad_mesh.h"

namespace leafcutter::geometry {

// The quads of one cylinder in it.
struct JoinedCylinder {
    Cylinder chart;
    CylinderGrid grid;
    std::vector<std::array<int, 4>> quads;  // Sorted by row and column.
    std::vector<double> surface_area;       // Per quad.
};

struct JoinedMesh {
    std::vector<Eigen::Vector3d> vertices;
    std::vector<int> cylinders;         // Of the foliation, ascending; none if none meet at arcs.
    std::vector<JoinedCylinder> parts;  // One each.
    std::size_t folded = 0;  // Quads that face inwards at sharp edges, whatever their size.
};

// Throws Error(BadOption, "strips-too-wide") where so few quads can't carry the topology, or would
// face inwards, naming the widest strips that can.
JoinedMesh join_cylinders(const Foliation& foliation,
                          const GridOptions& options,
                          const Context& context);

}  // namespace leafcutter::geometry
