// Built-in sample surfaces, made by formulas, for demos and tests.

#pragma once

#include <span>
#include <string_view>

#include "geometry/types.h"

namespace leafcutter::geometry {

// Names that make_sample takes: "torus", "vase", "cylinder", "square", "saddle", "face", "sphere",
// "eight", "double-torus", "hand" …
std::span<const std::string_view> sample_names();

// A sample with about `faces` triangles (within a factor of 2).
// Throws Error(BadOption) for an unknown name or fewer than 100 faces.
TriangleMesh make_sample(std::string_view name, int faces = 8000);

}  // namespace leafcutter::geometry
