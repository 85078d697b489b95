// The arcs of the critical graph, as seen from the cylinders on both sides.
//
// The slicer names every vertex on a cut by its point of the critical graph (Cylinder::
// critical_point). Both ends of a cylinder are walked along growing g and parted at singular
// points; arcs with the same points are the same.

#pragma once

#include <array>
#include <optional>
#include <vector>

#include "geometry/foliation.h"

namespace leafcutter::geometry {

// One run of a cylinder's end along an arc.
struct ArcUse {
    int arc = 0;
    bool forward = true;    // g grows the way the arc runs.
    std::size_t first = 0;  // Into the end's vertices; the next use, or the end's end, ends it.
};

// One end of a cylinder: f = 0 or f = height.
struct CylinderEnd {
    std::vector<int> vertices;  // Along growing g, from a singular point if there is one.
    std::vector<double> g;      // Lifted, from the vertex's own; the last is a period on.
    std::vector<double> share;  // Per vertex how far along its use it is, in [0, 1).
    std::vector<ArcUse> uses;   // Empty on the boundary of the surface.
};

struct CriticalArc {
    std::vector<int> points;        // Into Foliation::critical_points, from singular to singular.
    std::vector<double> parameter;  // Of the points, from 0 to 1: the mean of its two sides'.
    double length = 0.0;            // In g, the mean of its two sides'.
};

struct ArcNetwork {
    std::vector<CriticalArc> arcs;
    std::vector<int> cylinders;                    // Those that meet others at arcs.
    std::vector<std::array<CylinderEnd, 2>> ends;  // Per cylinder of the foliation.
    std::vector<std::array<int, 2>> node;          // Per cylinder and end the connected part of
    int nodes = 0;                                 // the critical graph it lies on, or -1.

    bool is_open(int cylinder, int end) const {
        return ends[static_cast<std::size_t>(cylinder)][static_cast<std::size_t>(end)].uses.empty();
    }
};

// Throws Error(SelfCheck, "critical-arcs") unless every arc has two sides that agree.
ArcNetwork find_arcs(const Foliation& foliation);

// The point of an arc at a parameter from 0 to 1.
Eigen::Vector3d point_on(const CriticalArc& arc, const Foliation& foliation, double parameter);

}  // namespace leafcutter::geometry
