// The connected parts of a model, each with its own topology, and the cylinders woven from it.

#pragma once

#include <vector>

#include "geometry/foliation.h"
#include "geometry/mesh.h"
#include "geometry/topology.h"

namespace leafcutter::fab {

struct Part {
    int vertices = 0;
    int faces = 0;
    int euler = 0;
    int genus = 0;
    double area = 0.0;                // In units of the mesh, squared.
    std::vector<int> boundary_loops;  // Numbers of the loops of the model.
    std::vector<int> cylinders;       // None where the part is left out.
};

// One for each component of `topology`, which is that of `mesh`.
std::vector<Part> parts_of(const geometry::Mesh& mesh, const geometry::Topology& topology);

// Notes which cylinders of the foliation of that mesh belong to which part.
void assign_cylinders(const geometry::Mesh& mesh,
                      const geometry::Topology& topology,
                      const std::vector<geometry::Cylinder>& cylinders,
                      std::vector<Part>& parts);

}  // namespace leafcutter::fab
