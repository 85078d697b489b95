// Levels of a grid that come closest to the surface: moved one by one, as measured.
//
// How far quads lie off a surface of facets is no smooth function of its curvature, so that rules
// by curvature only come near the best levels. From there each level goes a little to and fro where
// the largest distances fall by it. What a level moves is seen within two strips on either side
// (half-sag offsets reach that far), so levels four apart move at once.

#pragma once

#include "geometry/context.h"
#include "geometry/quads/strip_distances.h"

namespace leafcutter::geometry {

struct MovableLevels {
    bool rows = true;
    bool cols = true;
};

struct SearchStart {
    const CylinderGrid& even;   // What the result is held against.
    const CylinderGrid& start;  // Where the search begins.
};

// From `start` on, by the largest distance over the leaves' lengths; the mean distance stays that
// of `even` or falls. Counts stay, levels rise, and no move leaves a strip much narrower or wider
// than `even` has it.
CylinderGrid closest_levels(const Cylinder& chart,
                            const StripDistances& distances,
                            const SearchStart& from,
                            MovableLevels movable,
                            const Context& context);

}  // namespace leafcutter::geometry
