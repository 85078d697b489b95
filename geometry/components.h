// Surfaces of several connected parts: options for each, one foliation of all.

#pragma once

#include <cstddef>
#include <vector>

#include "geometry/foliation.h"
#include "geometry/surface_part.h"

namespace leafcutter::geometry {

// Throws Error(BadOption) naming the key of a vertex or loop that isn't on any part, or of options
// that can't apply to several parts.
void check_names(const FoliationOptions& options, const std::vector<SurfacePart>& parts);

// Without what names vertices of other parts alone.
FoliationOptions options_of(const SurfacePart& part, const FoliationOptions& options);

// Index of the part with the largest area.
std::size_t largest_part(const std::vector<SurfacePart>& parts);

// All parts' foliations as one. Their charts get one unit: a square of (g, f) has the same area on
// average on all parts. `parts` are those of `foliations`; the mode is that of the largest.
Foliation join_parts(std::vector<Foliation> foliations, const std::vector<SurfacePart>& parts);

}  // namespace leafcutter::geometry
