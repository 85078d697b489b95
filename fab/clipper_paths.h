// Rings as the whole-numbered paths that Clipper works on, and back.

#pragma once

#include <vector>

#include <polyclipping/clipper.hpp>

#include "fab/strips/strip.h"

namespace leafcutter::fab {

// Each point rounded to the nearest of a grid with `units_per_mm` steps.
ClipperLib::Path clipper_path(const Ring& ring, double units_per_mm);

// The same, counter-clockwise whatever way the ring runs.
ClipperLib::Path upright_path(const Ring& ring, double units_per_mm);

Ring ring_of(const ClipperLib::Path& path, double units_per_mm);

// Closed paths moved outward by so many units (inward where negative). Corners stay corners; those
// sharper than 60 degrees are cut off square at that distance instead of running out.
ClipperLib::Paths mitred_offset(const ClipperLib::Paths& paths, double by_units);

}  // namespace leafcutter::fab
