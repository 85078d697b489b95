// One quad mesh across critical leaves: rings of a foliation by pants share the vertices on the
// arcs between them.

#pragma once

#include <array>
#include <string>
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
    std::size_t folded = 0;          // Quads that face inwards at sharp edges.
    std::vector<std::string> warnings;
};

// Cylinders too thin for a row are left out, with a warning. Strips are narrower than asked for, if
// they may be, where so few quads can't carry the topology, or too many would fold over.
// Throws Error(BadOption, "strips-too-wide") where they may not, naming the widest strips that can,
// and Error(BadOption, "cells-fold-over") where no width will do.
JoinedMesh join_cylinders(const Foliation& foliation,
                          const GridOptions& options,
                          const Context& context);

}  // namespace leafcutter::geometry
