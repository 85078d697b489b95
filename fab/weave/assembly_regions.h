// What of a weave is put together in one go, and which of it after which.

#pragma once

#include <span>
#include <vector>

#include "fab/parts.h"
#include "fab/strips/strip.h"
#include "fab/weave/assembly.h"

namespace leafcutter::fab {

// Cylinders that strips run through belong together. Those that share a border follow each other
// where they can.
std::vector<AssemblyRegion> assembly_regions(const geometry::QuadMesh& mesh,
                                             std::span<const Strip> strips,
                                             std::span<const Part> parts);

// Per region the strips that lie in it, ascending.
std::vector<std::vector<int>> members_of(std::span<const AssemblyRegion> regions,
                                         const geometry::QuadMesh& mesh,
                                         std::span<const Strip> strips);

}  // namespace leafcutter::fab
