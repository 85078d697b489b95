#include "fab/strips/notches.h"

#include <utility>

#include "fab/clipper_paths.h"
#include "fab/strips/overlap.h"

namespace leafcutter::fab {

namespace {

using ClipperLib::Path;
using ClipperLib::Paths;

constexpr double kLeastNotchMm2 = 0.01;

// What growing and shrinking again adds to the shape, where that is worth mentioning.
Paths notches_of(const Path& outline, double width_mm) {
    // With mitres, as the beam's way is found from an outline.
    const double half = width_mm / 2.0 * kGridPerMm;
    const Paths closed = mitred_offset(mitred_offset({outline}, half), -half);
    ClipperLib::Clipper clipper;
    clipper.AddPaths(closed, ClipperLib::ptSubject, true);
    clipper.AddPath(outline, ClipperLib::ptClip, true);
    Paths added;
    clipper.Execute(ClipperLib::ctDifference, added, ClipperLib::pftNonZero,
                    ClipperLib::pftNonZero);
    Paths notches;
    for (Path& path : added) {
        if (ClipperLib::Area(path) > kLeastNotchMm2 * kGridPerMm * kGridPerMm) {
            notches.push_back(std::move(path));
        }
    }
    return notches;
}

}  // namespace

Ring without_notches(const Ring& outline, double width_mm) {
    if (outline.size() < 4 || width_mm <= 0.0) {
        return outline;
    }
    const Path path = clipper_path(outline, kGridPerMm);
    const Paths notches = notches_of(path, width_mm);
    if (notches.empty()) {
        return outline;
    }
    ClipperLib::Clipper clipper;
    clipper.AddPath(path, ClipperLib::ptSubject, true);
    clipper.AddPaths(notches, ClipperLib::ptClip, true);
    Paths filled;
    clipper.Execute(ClipperLib::ctUnion, filled, ClipperLib::pftNonZero, ClipperLib::pftNonZero);
    if (filled.size() != 1) {
        return outline;
    }
    const Ring ring = ring_of(filled.front(), kGridPerMm);
    return is_simple(ring) ? ring : outline;
}

}  // namespace leafcutter::fab
