#include "geometry/cases/pants.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <queue>
#include <string>
#include <utility>

#include "geometry/cases/annulus.h"
#include "geometry/harmonic/chart_surface.h"
#include "geometry/laplacian.h"
#include "geometry/pants/harmonic_map.h"
#include "geometry/pants/initial_map.h"
#include "geometry/pants/slice.h"
#include "geometry/pants/split_long_edges.h"

namespace leafcutter::geometry {
namespace {

// Least weight of a mesh edge in the map's energy: positive weights are what makes it convex.
constexpr double kLeastEdgeWeight = 1e-3;
// Least length of a cylinder, by the longest.
constexpr double kLeastHeight = 0.02;
// The map's energy may exceed its cylinders' by this part before it is worth a warning.
constexpr double kMostExcess = 0.1;
// Coarser surfaces are split first: the map is linear on triangles.
constexpr std::size_t kLeastVertices = 3000;
// After splitting long edges the map is solved again, which may make new ones.
constexpr int kMostSplitRounds = 8;

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

struct Surface {
    TriangleMesh mesh;
    VertexRings rings;
    std::vector<WeightedEdge> edges;  // In the order of rings.edges.
    std::vector<double> weights;

    void rebuild() {
        const int count = static_cast<int>(mesh.positions.size());
        const HalfEdges half_edges = build_half_edges(mesh.triangles, count);
        rings = build_vertex_rings(half_edges, count);
        edges = positive_edges(mesh, half_edges, kLeastEdgeWeight);
        weights.clear();
        for (const WeightedEdge& edge : edges) {
            weights.push_back(edge.weight);
        }
    }
};

// Lengths of shortest edge paths from `sources`.
std::vector<double> path_lengths(const Surface& surface, const std::vector<int>& sources) {
    std::vector<double> length(surface.mesh.positions.size(),
                               std::numeric_limits<double>::infinity());
    using Entry = std::pair<double, int>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
    for (const int v : sources) {
        length[at(v)] = 0.0;
        queue.emplace(0.0, v);
    }
    while (!queue.empty()) {
        const auto [d, v] = queue.top();
        queue.pop();
        if (d > length[at(v)]) {
            continue;
        }
        for (int k = surface.rings.begin[at(v)]; k < surface.rings.begin[at(v) + 1]; ++k) {
            const int w = surface.rings.slots[at(k)].neighbour;
            const double through =
                d + (surface.mesh.positions[at(v)] - surface.mesh.positions[at(w)]).norm();
            if (through < length[at(w)]) {
                length[at(w)] = through;
                queue.emplace(through, w);
            }
        }
    }
    return length;
}

int farthest(const std::vector<double>& length) {
    return static_cast<int>(std::max_element(length.begin(), length.end()) - length.begin());
}

// A harmonic function whose only extrema are where it is held: 0 on the first boundary loop (or at
// one end of the surface), 1 on all others (or at the other end).
std::vector<double> sweep_function(const Surface& surface,
                                   const std::vector<std::vector<int>>& loops) {
    std::vector<char> held(surface.mesh.positions.size(), 0);
    Eigen::VectorXd values = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(held.size()));
    const auto hold = [&](int v, double value) {
        held[at(v)] = 1;
        values[v] = value;
    };
    if (loops.empty()) {
        const int low = farthest(path_lengths(surface, {0}));
        hold(low, 0.0);
        hold(farthest(path_lengths(surface, {low})), 1.0);
    } else {
        for (std::size_t k = 0; k < loops.size(); ++k) {
            for (const int v : loops[k]) {
                hold(v, k == 0 ? 0.0 : 1.0);
            }
        }
        if (loops.size() == 1) {
            hold(farthest(path_lengths(surface, loops[0])), 1.0);
        }
    }
    values = HarmonicSolver(surface.edges, held).solve(std::move(values));
    return {values.data(), values.data() + values.size()};
}

// Gives every graph edge the length that its part of the surface has, seen from the start of the
// sweep: long limbs get many rows.
void set_heights(GraphMap& map,
                 const Surface& surface,
                 const std::vector<std::vector<int>>& loops) {
    const std::vector<double> length =
        path_lengths(surface, loops.empty() ? std::vector<int>{0} : loops[0]);
    const std::size_t count = map.graph.edges.size();
    std::vector<double> least(count, std::numeric_limits<double>::infinity());
    std::vector<double> most(count, 0.0);
    for (std::size_t v = 0; v < length.size(); ++v) {
        const std::size_t e = at(map.graph_edge[v]);
        least[e] = std::min(least[e], length[v]);
        most[e] = std::max(most[e], length[v]);
    }
    double longest = 0.0;
    for (std::size_t e = 0; e < count; ++e) {
        longest = std::max(longest, most[e] - least[e]);
    }
    for (std::size_t e = 0; e < count; ++e) {
        map.graph.edges[e].weight = std::max(most[e] - least[e], kLeastHeight * longest);
    }
    for (std::size_t v = 0; v < length.size(); ++v) {
        map.t[v] *= map.graph.edges[at(map.graph_edge[v])].weight;
    }
}

GraphMap first_map(const Surface& surface, const std::vector<std::vector<int>>& loops) {
    const std::vector<double> values = sweep_function(surface, loops);
    std::vector<char> is_low(loops.size(), 0);
    if (!loops.empty()) {
        is_low.front() = 1;
    }
    const ReebGraph reeb = build_reeb_graph(surface.mesh.triangles, values, loops, is_low);
    GraphMap map = initial_map(reeb, values, surface.rings, loops);
    set_heights(map, surface, loops);
    return map;
}

HarmonicMapReport solve_and_split(Surface& surface, GraphMap& map, const Context& context) {
    HarmonicMapReport report;
    for (int round = 0; round < kMostSplitRounds; ++round) {
        const HarmonicMapReport solved =
            solve_harmonic_map(map, surface.rings, surface.weights,
                               round == 0 ? MapStart::Cold : MapStart::Warm, context);
        report.energy = solved.energy;
        report.iterations += solved.iterations;
        report.residual = solved.residual;
        report.converged = solved.converged;
        bool any = false;
        while (split_long_edges(surface.mesh, surface.rings, map) > 0) {
            any = true;
        }
        if (!any) {
            return report;
        }
        surface.rebuild();
    }
    throw Error(ErrorKind::SelfCheck, "unresolved-nodes",
                "harmonic map: the mesh is too coarse near the critical graph; refine it");
}

void check_prongs(const Sliced& sliced, int euler, std::vector<std::string>& warnings) {
    const int expected = -2 * euler;
    const int found = static_cast<int>(sliced.three_prongs.size());
    if (found != expected) {
        warnings.push_back("the critical graph has " + std::to_string(found) +
                           " simple three-prong points instead of " + std::to_string(expected) +
                           ": some lie closer together than the mesh resolves");
    }
}

// At the minimum the map has the energy of its cylinders. Weights forced positive at obtuse corners
// make it larger, and move the critical graph from where it belongs.
void check_energy(const Foliation& foliation, std::vector<std::string>& warnings) {
    double cylinders = 0.0;
    for (const Cylinder& cylinder : foliation.cylinders) {
        cylinders += 0.5 * cylinder.width * cylinder.height;
    }
    const double excess = foliation.energy / cylinders - 1.0;
    if (excess > kMostExcess) {
        warnings.push_back("obtuse triangles pull the critical graph out of place: the map has " +
                           std::to_string(std::lround(100.0 * excess)) +
                           " % more energy than its cylinders; remesh the model");
    }
}

// The chart of one piece, its f from 0 to the weight of its graph edge.
void add_cylinder(Foliation& foliation,
                  const Piece& piece,
                  int graph_edge,
                  const FoliationOptions& options,
                  const Context& context) {
    Context quiet = context;
    quiet.progress = nullptr;
    Foliation ring = foliate_ring(piece.mesh, piece.loops, options, quiet);
    Cylinder& cylinder = ring.cylinders.front();
    const double height = foliation.graph.edges[at(graph_edge)].weight;
    cylinder.graph_edge = graph_edge;
    cylinder.width *= height;
    cylinder.height *= height;
    cylinder.energy *= height * height;
    for (auto& corners : cylinder.corner_gf) {
        for (Eigen::Vector2d& gf : corners) {
            gf *= height;
        }
    }
    for (int& source : cylinder.source_vertex) {
        source = source < 0 ? -1 : piece.source_vertex[at(source)];
    }
    for (const std::string& warning : ring.warnings) {
        foliation.warnings.push_back("cylinder " + std::to_string(graph_edge) + ": " + warning);
    }
    foliation.cylinders.push_back(std::move(cylinder));
}

// The surface, fine enough. No edge joins two boundary vertices: their pieces of boundary would
// touch.
ChartSurface fine_surface(const TriangleMesh& mesh, const std::vector<std::vector<int>>& loops) {
    std::vector<std::uint8_t> on_boundary(mesh.positions.size(), 0);
    for (const std::vector<int>& loop : loops) {
        for (const int v : loop) {
            on_boundary[at(v)] = 1;
        }
    }
    ChartSurface surface = start_surface(mesh, std::move(on_boundary));
    while (surface.mesh.positions.size() < kLeastVertices) {
        const std::vector<char> all(at(surface.edges.size()), 1);
        surface = split_edges(std::move(surface), all);
    }
    return surface;
}

}  // namespace

Foliation foliate_pants(const TriangleMesh& mesh,
                        const std::vector<std::vector<int>>& given_loops,
                        const FoliationOptions& options,
                        const Context& context) {
    ChartSurface start = fine_surface(mesh, given_loops);
    std::vector<std::vector<int>> loops;
    loops.reserve(given_loops.size());
    for (const std::vector<int>& loop : given_loops) {
        loops.push_back(boundary_path(start.edges, loop.front(), loop.front()));
    }
    Surface surface{std::move(start.mesh), {}, {}, {}};
    surface.rebuild();
    const int euler = static_cast<int>(surface.mesh.positions.size()) -
                      static_cast<int>(surface.rings.edges.size()) +
                      static_cast<int>(surface.mesh.triangles.size());
    GraphMap map = first_map(surface, loops);
    context.report("foliation", 0.2);
    const HarmonicMapReport solved = solve_and_split(surface, map, context);
    context.report("foliation", 0.6);
    Sliced sliced = slice_surface(surface.mesh, surface.rings, map);

    Foliation foliation;
    foliation.mode = FoliationMode::Pants;
    foliation.graph = map.graph;
    foliation.energy = solved.energy;
    foliation.iterations = solved.iterations;
    if (!solved.converged) {
        foliation.warnings.push_back("the harmonic map stopped before it was quite still");
    }
    check_prongs(sliced, euler, foliation.warnings);
    for (const Eigen::Vector3d& position : sliced.three_prongs) {
        foliation.singularities.push_back({position, 3});
    }
    for (std::size_t e = 0; e < sliced.pieces.size(); ++e) {
        add_cylinder(foliation, sliced.pieces[e], static_cast<int>(e), options, context);
        context.report("foliation", 0.6 + 0.4 * static_cast<double>(e + 1) /
                                              static_cast<double>(sliced.pieces.size()));
    }
    check_energy(foliation, foliation.warnings);
    for (Cylinder& cylinder : foliation.cylinders) {
        for (int& source : cylinder.source_vertex) {
            source = source >= 0 && at(source) < mesh.positions.size() ? source : -1;
        }
    }
    return foliation;
}

}  // namespace leafcutter::geometry
