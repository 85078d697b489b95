// A surface on its way to having holes: triangles split near them, and whether they fit. Internal
// to punctures.

#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "geometry/context.h"
#include "geometry/foliation.h"
#include "geometry/harmonic/chart_surface.h"
#include "geometry/surface_distance.h"

namespace leafcutter::geometry {

struct PunctureSite {
    ChartSurface surface;
    std::vector<Puncture> punctures;
    std::vector<double> fineness;  // Per puncture, a factor of its edges' length.
    double area = 0.0;             // Of the surface, holes included.
    double diagonal = 0.0;         // Of its bounding box.
};

// Splits triangles flat until edges near each hole are short.
void refine(PunctureSite& site, const Context& context);

// A hole's surroundings in rising order of distance.
using Ball = std::vector<SurfaceDistance::Reached>;
std::vector<Ball> balls_of(const PunctureSite& site, const Context& context);

// What a hole takes away.
struct Disk {
    std::vector<int> inside;  // Vertices.
    double area = 0.0;        // Of triangles that lose a corner: a little too much.
    int euler = 0;            // Of the triangles inside. 1 for a disk, as it is connected.
};

// Why a puncture can't be opened, and the radius that it could have.
struct Misfit {
    std::size_t puncture = 0;
    std::string why;
    double radius = 0.0;
    int other = -1;  // A puncture that needs that radius, too.
};

// Finds the disk of each puncture, or a puncture that doesn't fit.
std::optional<Misfit> find_disks(const PunctureSite& site,
                                 const std::vector<Ball>& balls,
                                 std::vector<Disk>& disks);

}  // namespace leafcutter::geometry
