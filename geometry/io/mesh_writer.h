// Writers for the meshes we hand out. Text, C locale, round-trip exact doubles.

#pragma once

#include <span>
#include <string>
#include <vector>

#include "geometry/types.h"

namespace leafcutter::geometry {

// A per-vertex scalar of a PLY file.
struct VertexProperty {
    std::string name;
    std::vector<double> values;
};

std::string write_obj(const TriangleMesh& mesh);
std::string write_off(const TriangleMesh& mesh);

// ASCII PLY with float64 positions and one float64 property for each entry of `properties`.
std::string write_ply(const TriangleMesh& mesh, std::span<const VertexProperty> properties = {});

}  // namespace leafcutter::geometry
