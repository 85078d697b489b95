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

// What cuts a surface into pairs of pants: level sets of a function alone, or first loops that are
// contractible inside (handle loops) or outside (tunnel loops) the closed surface, or loops given.
enum class PantsSource { Reeb, HandleLoops, TunnelLoops, User };

// The function whose Reeb graph is used; Auto tries all and keeps the best.
enum class SweepFunction { Auto, Harmonic, X, Y, Z, Fiedler };

// Whether holes are opened at the tips of limbs, where cells would get far too large, or at given
// places.
enum class PunctureChoice { Auto, None, Given };

struct Puncture {
    int vertex = 0;
    double radius = 0.0;  // On the surface, in units of the mesh.
};

// A boundary loop, by its number (those of the mesh in the order of Topology, then those of the
// given punctures) or by one of its vertices.
struct LoopName {
    std::optional<int> number;
    std::optional<int> vertex;
};

enum class Components { Each, Largest };

// A grid of about square cells that is to go on from cylinder to cylinder.
struct JunctionAim {
    double cells = 0.0;         // On the whole surface.
    bool even_columns = false;  // Round every cylinder, so that colours can alternate.
};

struct FoliationOptions {
    FoliationMode mode = FoliationMode::Auto;
    std::optional<std::array<int, 4>> corners = {};  // Disk: boundary vertices, any order.
    TorusRings torus_rings = TorusRings::Short;
    Refinement refinement = Refinement::Allowed;

    PantsSource pants = PantsSource::Reeb;
    std::vector<std::vector<int>> loops = {};  // PantsSource::User: closed, each vertex joined to
                                               // the next by a shortest path of edges.
    SweepFunction function = SweepFunction::Auto;
    std::vector<std::vector<int>> forbidden_loops = {};  // As `loops`: ways round the surface that
                                                         // no cylinder may go.
    std::optional<std::vector<double>> weights = {};  // h > 0 of each graph edge; else automatic.
    bool even_cells = false;  // Chooses function and weights for cells of even area.
    std::optional<JunctionAim> junctions = {};  // Weights may change a little, so that cylinders
                                                // meet in whole columns.

    std::optional<std::array<int, 2>> poles = {};  // SpherePolar: vertices.
    std::vector<int> near = {};          // Vertices near which singular points are wanted; for
                                         // SpherePillowcase four of them place its own.
    std::vector<LoopName> sources = {};  // OneForm: f = 0 there; else the longest loop.
    std::vector<LoopName> sinks = {};    // OneForm: f = 1 there; else all other loops.
    PunctureChoice puncture = PunctureChoice::Auto;
    std::vector<Puncture> punctures = {};  // PunctureChoice::Given.
    Components components = Components::Each;
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
    Rectangle,   // No period. g in [0, width], f in [0, height].
    Annulus,     // One period (width, 0): rings close. f in [0, height].
    Torus,       // Two periods, (width, 0) and (shear, height).
    Pillowcase,  // An annulus with both end rings folded flat and closed: (g, 0) and (-g, 0) are
                 // one point of the surface, and so are (g, height) and (2 shear - g, height).
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

    // Per vertex its place in Foliation::critical_points, or -1. Empty where the cylinder borders
    // on no other.
    std::vector<int> critical_point;

    double width = 0.0;   // Range or period of g: the circumference of a ring.
    double height = 0.0;  // Range or period of f.
    double shear = 0.0;   // Torus: the g part of the second period. Pillowcase: place of a fold.

    double energy = 0.0;         // Dirichlet energy of f on this cylinder.
    double conformal_gap = 0.0;  // Certified upper over lower bound of the modulus, minus 1.
    double flux_mismatch = 0.0;  // Largest relative difference of the flux of f through two leaves.
};

// A point where the number of prongs of F is not 2: 1 at the corners of a pillowcase, 3 where three
// cylinders meet, 4 at a zero of a harmonic one-form.
struct Singularity {
    Eigen::Vector3d position;
    int prongs = 0;
};

// A vertex of the critical graph, by which the cylinders on both sides know the place.
struct CriticalPoint {
    Eigen::Vector3d position;
    int prongs = 2;  // 3 where three cylinders meet.
};

// How evenly large the cells of a grid of squares are on the surface: they grow and shrink with the
// conformal factor, exponentially along limbs.
struct CellSpread {
    double variation = 0.0;  // Standard deviation over mean of cell areas.
    double largest = 0.0;    // Edge, in mean edges, of the cells that hold the top 1 % of the area.
};

// How near a singular point lies to where one was wanted.
struct ReachedPoint {
    int vertex = 0;         // Of the input.
    int singularity = 0;    // In Foliation::singularities.
    double distance = 0.0;  // Along the surface.
};

// Coefficient of variation of cell areas, as the automatic weights have it and as evened out.
struct EvenedCells {
    double before = 0.0;
    double after = 0.0;
};

// Another way to foliate the same surface that was looked at.
struct Alternative {
    std::string name;  // As the options that choose it: "sphere-pillowcase", "pants with 5 holes"…
    CellSpread spread;
    double removed_area = 0.0;  // In units of the mesh, squared.
    bool chosen = false;
};

struct Foliation {
    FoliationMode mode = FoliationMode::Auto;  // The mode that was used; never Auto.
    MetricGraph graph;
    std::vector<Cylinder> cylinders;
    std::vector<Singularity> singularities;
    // Preimages of the graph's nodes, as polylines from singular point to singular point.
    std::vector<std::vector<Eigen::Vector3d>> critical_graph;
    std::vector<CriticalPoint> critical_points;  // Its vertices, where cylinders are rings.
    std::optional<std::array<int, 4>> corners;   // Disk: those used, mesh vertices.
    std::vector<Puncture> punctures;             // Those opened.
    double energy = 0.0;
    int iterations = 0;
    CellSpread spread;
    std::vector<ReachedPoint> reached;      // Per wanted singular point, where any was wanted.
    std::optional<EvenedCells> evened;      // With FoliationOptions::even_cells.
    std::vector<Alternative> alternatives;  // Including the one chosen, where there was a choice.
    std::vector<std::string> warnings;
};

// Computes the foliations of an orientable surface, of each of its connected parts for itself.
//
// Guarantees: no triangle of any chart is flipped or degenerate in (g, f); the charts' area on the
// surface is that of the surface without the holes opened; singular points add up to what its Euler
// characteristic asks for.
// Throws Error(BadOption) for options that don't fit the surface, Error(BadMesh) for surfaces
// without room for a chart, and Error(SelfCheck) naming the stage where a result fails its check.
Foliation compute_foliation(const Mesh& mesh,
                            const FoliationOptions& options = {},
                            const Context& context = {});

}  // namespace leafcutter::geometry
