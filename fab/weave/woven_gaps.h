// How near the slabs of a woven model come to each other: exactly, all against all.

#pragma once

#include <span>
#include <vector>

#include "fab/strips/strip.h"
#include "fab/weave/woven_model.h"
#include "geometry/context.h"

namespace leafcutter::fab {

// Sets the gaps and overlaps of `model`; returns where strips lie in each other, both of them.
// Every slab is taken apart into convex prisms, two between one rung and the next; two prisms are
// apart by the largest distance that any separating plane shows, and lie in each other by the
// smallest way out (separating axes: all faces and all pairs of edges). A strip is compared with
// itself too where it comes back beside itself. Expected O(prisms).
std::vector<Clash> measure_gaps(std::span<const Strip> strips,
                                WovenModel& model,
                                const geometry::Context& context = {});

// What measure_gaps() would return near the cells of `changed`, if nothing else changed since it
// returned them. Sets nothing.
std::vector<Clash> clashes_near(std::span<const Strip> strips,
                                const WovenModel& model,
                                std::span<const Clash> changed,
                                const geometry::Context& context = {});

}  // namespace leafcutter::fab
