// Floats: how far a thread runs on one side of those that cross it.
//
// Counted in cells along threads that go on through critical leaves, as they do in the finished
// weave; round closed ones. Too long ones come from seams of the pattern and are broken by letting
// single crossings change sides.

#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "fab/job_params.h"
#include "fab/strips/strip.h"
#include "geometry/quads/quad_mesh.h"

namespace leafcutter::fab {

struct FamilyFloats {
    int longest = 0;  // Cells.
    double mean = 0.0;
    int over_limit = 0;  // Floats longer than allowed.
};

struct Float {
    Family family = Family::Weft;
    bool on_top = false;
    std::vector<int> quads;  // In walking order.
};

struct Floats {
    std::optional<int> limit;
    FamilyFloats weft_before;  // As the pattern lies,
    FamilyFloats warp_before;
    FamilyFloats weft;  // and with the flips.
    FamilyFloats warp;
    std::vector<int> flips;       // Quads whose thread on top was changed, ascending.
    std::vector<Float> too_long;  // Those left.
};

// Cells that floats of this pattern may be long: as asked for, else one more than where it is
// unbroken; none where it has threads that never change sides. Throws Error(BadOption) if less is
// asked for than the unbroken pattern has.
std::optional<int> float_limit(const WeaveParams& params);

// Measures the floats of a weave and breaks those above the limit, one crossing at a time: always
// where it leaves least above it, and never so that another one comes to exceed it. Changes
// `warp_on_top`.
Floats limit_floats(const geometry::QuadMesh& mesh,
                    std::optional<int> limit,
                    std::vector<std::uint8_t>& warp_on_top);

}  // namespace leafcutter::fab
