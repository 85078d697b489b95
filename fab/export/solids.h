// The woven model as the bytes of 3D files that other programs open.

#pragma once

#include <span>
#include <string>

#include "fab/weave/slab.h"

namespace leafcutter::fab {

// "#rrggbb" of either family.
struct FamilyColours {
    std::string weft = "#888888";
    std::string warp = "#888888";
};

// Binary STL, mm: every triangle of every strip.
std::string write_stl(std::span<const Solid> solids);

// Wavefront OBJ, mm: one object per strip, named by its id; materials "weft" and "warp" of the
// library `material_file`.
std::string write_obj(std::span<const Solid> solids, const std::string& material_file);

// The material library of write_obj().
std::string write_mtl(const FamilyColours& colours);

// glTF 2.0 in one binary file: one node per strip, named by its id, and one material per family.
// Metres and y up, as glTF wants them; our z is up.
std::string write_glb(std::span<const Solid> solids, const FamilyColours& colours);

}  // namespace leafcutter::fab
