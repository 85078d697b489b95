#include "fab/nest/grow.h"

#include <algorithm>
#include <cmath>

#include <polyclipping/clipper.hpp>

#include "fab/nest/shape.h"

namespace leafcutter::fab {

namespace {

// Units so fine that rounding to them never shows, and within the range in which products are
// computed in 64 bits.
double unit_of(double extent) {
    return std::max(extent, 1e-9) / 5e8;
}

double extent_of(const Ring& ring) {
    double extent = 0.0;
    for (const Eigen::Vector2d& point : ring) {
        extent = std::max(extent, point.cwiseAbs().maxCoeff());
    }
    return extent;
}

ClipperLib::Path to_path(const Ring& ring, double unit) {
    ClipperLib::Path path;
    path.reserve(ring.size());
    for (const Eigen::Vector2d& point : ring) {
        path.emplace_back(std::llround(point.x() / unit), std::llround(point.y() / unit));
    }
    if (!ClipperLib::Orientation(path)) {
        std::reverse(path.begin(), path.end());
    }
    return path;
}

Ring to_ring(const ClipperLib::Path& path, double unit) {
    Ring ring;
    ring.reserve(path.size());
    for (const ClipperLib::IntPoint& point : path) {
        ring.emplace_back(static_cast<double>(point.X) * unit, static_cast<double>(point.Y) * unit);
    }
    return ring;
}

}  // namespace

Ring grown(const Ring& ring, double by) {
    const double unit = unit_of(extent_of(ring) + 2.0 * by);
    const ClipperLib::Path path = to_path(ring, unit);
    // Mitres lie outside of round corners; only sharp ones are cut off, beyond twice the distance.
    ClipperLib::ClipperOffset offset(2.0, 1.0);
    offset.AddPath(path, ClipperLib::jtMiter, ClipperLib::etClosedPolygon);
    ClipperLib::Paths paths;
    offset.Execute(paths, by / unit + 2.0);
    const auto largest = std::max_element(paths.begin(), paths.end(),
                                          [](const ClipperLib::Path& a, const ClipperLib::Path& b) {
                                              return ClipperLib::Area(a) < ClipperLib::Area(b);
                                          });
    return largest == paths.end() ? to_ring(path, unit) : to_ring(*largest, unit);
}

std::vector<Ring> outside_of(std::span<const Ring> rings,
                             const Eigen::Vector2d& low,
                             const Eigen::Vector2d& high,
                             int cells) {
    double extent = std::max(low.cwiseAbs().maxCoeff(), high.cwiseAbs().maxCoeff());
    for (const Ring& ring : rings) {
        extent = std::max(extent, extent_of(ring));
    }
    const double unit = unit_of(extent);
    ClipperLib::Paths inner;
    for (const Ring& ring : rings) {
        inner.push_back(to_path(ring, unit));
    }
    const Eigen::Vector2d step = (high - low) / cells;
    std::vector<Ring> out;
    for (int row = 0; row < cells; ++row) {
        for (int column = 0; column < cells; ++column) {
            const Eigen::Vector2d a = low + step.cwiseProduct(Eigen::Vector2d(column, row));
            const Eigen::Vector2d b = a + step;
            ClipperLib::Clipper clipper;
            clipper.AddPath(to_path({a, {b.x(), a.y()}, b, {a.x(), b.y()}}, unit),
                            ClipperLib::ptSubject, true);
            clipper.AddPaths(inner, ClipperLib::ptClip, true);
            ClipperLib::Paths paths;
            clipper.Execute(ClipperLib::ctDifference, paths, ClipperLib::pftNonZero,
                            ClipperLib::pftNonZero);
            for (const ClipperLib::Path& path : paths) {
                if (ClipperLib::Orientation(path) && ClipperLib::Area(path) > 4.0) {
                    out.push_back(to_ring(path, unit));
                }
            }
        }
    }
    return out;
}

}  // namespace leafcutter::fab
