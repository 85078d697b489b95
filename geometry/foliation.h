// Two orthogonal harmonic foliations of a surface, as charts.
//
// The surface is mapped harmonically to a metric graph; the preimage of a graph edge is a cylinder,
// the level sets of the map are the leaves of F, those of the conjugate function the leaves of F*.
// After "Computational Generation and Conformal Fabrication of Woven Fabric Structures by Harmonic
// Foliation", sections 3.2 to 3.6.
//
// Coordinates of a chart are (g, f): f is the harmonic map, constant along the leaves of F; g its
// conjugate, constant along the leaves of F*. (g, f) is right-handed seen from outside. Both are in
// the same unit, so that a square of (g, f) is a square on the surface, up to the conformal factor.

#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "geometry/context.h"
#include "geometry/mesh.h"
#include "geometry/types.h"

namespace leafcutter::geometry {

enum class FoliationMode {
    Auto,
    Pants,
    OneForm,
    Disk,
    Annulus,
    Torus,
    SpherePolar,
    SpherePillowcase
};

// Whether triangles may be split, flat, where they are too coarse for a conformal chart.
enum class Refinement { Allowed, Off };

enum class TorusRings { Short, Long };  // Which generator of a torus the leaves of F run around.

struct FoliationOptions {
    FoliationMode mode = FoliationMode::Auto;
    std::optional<std::array<int, 4>> corners = {};  // Disk: boundary vertices, any order.
    TorusRings torus_rings = TorusRings::Short;
    Refinement refinement = Refinement::Allowed;
};

// Target of the harmonic map. A torus has one edge and one node; a disk or annulus one edge, two
// nodes.
struct MetricGraph {
    struct Edge {
        int from = 0;
        int to = 0;
        double weight = 1.0;  // h > 0, the length of the edge.
    };
    int nodes = 0;
    std::vector<Edge> edges;
};

enum class ChartShape {
    Rectangle,  // No period. g in [0, width], f in [0, height].
    Annulus,    // One period (width, 0): rings close. f in [0, height].
    Torus,      // Two periods, (width, 0) and (shear, height).
};

// The preimage of one graph edge, cut out, with its parameterisation.
struct Cylinder {
    int graph_edge = 0;
    ChartShape shape = ChartShape::Annulus;
    TriangleMesh mesh;               // Own vertex numbering; triangles as the input's surface.
    std::vector<int> source_vertex;  // Per vertex: vertex of the surface it came from, or -1.

    // Per triangle the lifted (g, f) of its three corners: continuous inside the triangle; across
    // an edge equal up to a period. Every triangle has positive area in (g, f).
    std::vector<std::array<Eigen::Vector2d, 3>> corner_gf;

    double width = 0.0;   // Range or period of g: the circumference of a ring.
    double height = 0.0;  // Range or period of f.
    double shear = 0.0;   // Torus only: the g part of the second period.

    double energy = 0.0;         // Dirichlet energy of f on this cylinder.
    double conformal_gap = 0.0;  // Certified upper over lower bound of the modulus, minus 1.
};

struct Singularity {
    Eigen::Vector3d position;
    int prongs = 0;
};

struct Foliation {
    FoliationMode mode = FoliationMode::Auto;  // The mode that was used; never Auto.
    MetricGraph graph;
    std::vector<Cylinder> cylinders;
    std::vector<Singularity> singularities;
    std::optional<std::array<int, 4>> corners;  // Disk: those used, mesh vertices.
    double energy = 0.0;
    int iterations = 0;
    std::vector<std::string> warnings;
};

// Computes the foliations of a connected surface.
//
// Guarantees: no triangle of any chart is flipped or degenerate in (g, f).
// Throws Error(NotSupported) for a sphere, Error(BadOption) for corners that are not four different
// vertices of the one boundary loop, and Error(SelfCheck) where a result fails its check.
Foliation compute_foliation(const Mesh& mesh,
                            const FoliationOptions& options = {},
                            const Context& context = {});

}  // namespace leafcutter::geometry
