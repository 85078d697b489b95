// From the parameters of a job to the options of a foliation: vertex numbers of the input file
// become those of the repaired mesh, boundary loops are looked up.

#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "fab/job_params.h"
#include "geometry/foliation.h"
#include "geometry/mesh.h"
#include "geometry/topology.h"

namespace leafcutter::fab {

// What the numbers of a user stand for.
struct NamedMesh {
    std::span<const int> vertex_of_input;  // Per vertex of the file: vertex of the mesh, or -1.
    const geometry::Topology& topology;
    const geometry::Mesh* mesh = nullptr;  // Borrowed; needed for places given by a position.
    double scale = 1.0;                    // Of the mesh to the file.
};

// Throws geometry::Error(BadOption, "no-such-vertex", "no-such-loop" or "same-place"), naming the
// parameter.
geometry::FoliationOptions foliation_options(const FoliationParams& params, const NamedMesh& mesh);

// The other way: per vertex of the mesh its first number in the file, or -1 where it has none.
std::vector<int> input_of_vertices(std::span<const int> vertex_of_input, std::size_t vertices);

}  // namespace leafcutter::fab
