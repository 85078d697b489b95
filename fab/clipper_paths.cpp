#include "fab/clipper_paths.h"

#include <cmath>

namespace leafcutter::fab {

ClipperLib::Path clipper_path(const Ring& ring, double units_per_mm) {
    ClipperLib::Path path;
    path.reserve(ring.size());
    for (const Eigen::Vector2d& point : ring) {
        path.emplace_back(std::llround(point.x() * units_per_mm),
                          std::llround(point.y() * units_per_mm));
    }
    return path;
}

ClipperLib::Path upright_path(const Ring& ring, double units_per_mm) {
    ClipperLib::Path path = clipper_path(ring, units_per_mm);
    if (!ClipperLib::Orientation(path)) {
        ClipperLib::ReversePath(path);
    }
    return path;
}

Ring ring_of(const ClipperLib::Path& path, double units_per_mm) {
    Ring ring;
    ring.reserve(path.size());
    for (const ClipperLib::IntPoint& point : path) {
        ring.emplace_back(static_cast<double>(point.X) / units_per_mm,
                          static_cast<double>(point.Y) / units_per_mm);
    }
    return ring;
}

ClipperLib::Paths mitred_offset(const ClipperLib::Paths& paths, double by_units) {
    constexpr double kMitreLimit = 2.0;
    ClipperLib::ClipperOffset offset(kMitreLimit);
    offset.AddPaths(paths, ClipperLib::jtMiter, ClipperLib::etClosedPolygon);
    ClipperLib::Paths moved;
    offset.Execute(moved, by_units);
    return moved;
}

}  // namespace leafcutter::fab
