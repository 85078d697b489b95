#include "fab/strips/notches.h"

#include <cmath>

#include <polyclipping/clipper.hpp>

#include "fab/strips/overlap.h"

namespace leafcutter::fab {

namespace {

using ClipperLib::Path;
using ClipperLib::Paths;

constexpr double kLeastNotchMm2 = 0.01;

Path to_grid(const Ring& ring) {
    Path path;
    path.reserve(ring.size());
    for (const Eigen::Vector2d& point : ring) {
        path.emplace_back(std::llround(point.x() * kGridPerMm),
                          std::llround(point.y() * kGridPerMm));
    }
    return path;
}

Ring from_grid(const Path& path) {
    Ring ring;
    ring.reserve(path.size());
    for (const ClipperLib::IntPoint& point : path) {
        ring.emplace_back(static_cast<double>(point.X) / kGridPerMm,
                          static_cast<double>(point.Y) / kGridPerMm);
    }
    return ring;
}

// With mitres, as the beam's way is found from an outline.
Paths offset(const Paths& paths, double by_mm) {
    ClipperLib::ClipperOffset offset;
    offset.AddPaths(paths, ClipperLib::jtMiter, ClipperLib::etClosedPolygon);
    Paths moved;
    offset.Execute(moved, by_mm * kGridPerMm);
    return moved;
}

// What growing and shrinking again adds to the shape, where that is worth mentioning.
Paths notches_of(const Path& outline, double width_mm) {
    const Paths closed = offset(offset({outline}, width_mm / 2.0), -width_mm / 2.0);
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
    const Path path = to_grid(outline);
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
    const Ring ring = from_grid(filled.front());
    return is_simple(ring) ? ring : outline;
}

}  // namespace leafcutter::fab
