#include "geometry/cases/pants.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "geometry/cases/annulus.h"
#include "geometry/cases/whole_columns.h"
#include "geometry/laplacian.h"
#include "geometry/pants/coarse_maps.h"
#include "geometry/pants/even_maps.h"
#include "geometry/pants/forbidden_loops.h"
#include "geometry/pants/hierarchy.h"
#include "geometry/pants/near_points.h"
#include "geometry/pants/prepare_surface.h"
#include "geometry/pants/slice.h"
#include "geometry/pants/split_long_edges.h"
#include "geometry/parallel.h"
#include "geometry/surface_measures.h"

namespace leafcutter::geometry {
namespace {

// The coarsest size picks the homotopy class: part of the result, so fixed.
constexpr std::size_t kCoarsest = 6000;
// Where no decomposition works there, a finer level may have one.
constexpr std::size_t kFinerCoarsest = 15000;
constexpr int kAttempts = 2;                // At each size, from different starts.
constexpr std::size_t kMostCandidates = 4;  // Carried to the finest level, one after the other.

// Splitting long edges and settling their middles may make new ones.
constexpr int kMostSplitRounds = 8;
constexpr int kSettlePasses = 3;
constexpr double kLeastEdgeWeight = 1e-3;

// The map's energy may exceed its cylinders' by this part before it is worth a warning, and by this
// part before it is an error.
constexpr double kNotableExcess = 0.1;
constexpr double kImpossibleExcess = 1.0;
constexpr double kAreaTolerance = 1e-6;
// Of a grid, where evening cells isn't told how fine it will be.
constexpr double kUsualCells = 1000.0;
// A cylinder with less of the surface has all but collapsed.
constexpr double kSqueezedShare = 1e-6;

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

struct Solved {
    GraphMap map;
    HarmonicMapReport report;
    TriangleMesh mesh;  // The finest, with long edges split.
    Sliced sliced;
};

// Splits edges that pass more than one node until every triangle lies round at most one.
Sliced split_and_slice(TriangleMesh& mesh, GraphMap& map, const Context& context) {
    const auto half_edges = [&] {
        return build_half_edges(mesh.triangles, static_cast<int>(mesh.positions.size()));
    };
    VertexRings rings = build_vertex_rings(half_edges(), static_cast<int>(mesh.positions.size()));
    for (int round = 0; round < kMostSplitRounds; ++round) {
        context.check();
        const std::size_t old_vertices = mesh.positions.size();
        while (split_long_edges(mesh, rings, map) > 0) {
        }
        if (mesh.positions.size() == old_vertices) {
            return slice_surface(mesh, rings, map);
        }
        std::vector<double> weights;
        for (const WeightedEdge& edge : positive_edges(mesh, half_edges(), kLeastEdgeWeight)) {
            weights.push_back(edge.weight);
        }
        std::vector<int> fresh(mesh.positions.size() - old_vertices);
        std::iota(fresh.begin(), fresh.end(), static_cast<int>(old_vertices));
        settle_vertices(map, rings, weights, fresh, kSettlePasses);
    }
    throw Error(ErrorKind::SelfCheck, "unresolved-nodes",
                "harmonic map: the mesh is too coarse near the critical graph; refine it");
}

[[noreturn]] void fail(const char* code, const std::string& what) {
    throw Error(ErrorKind::SelfCheck, code, what);
}

// Numbers of section 3.2 and 3.4: one cylinder for each graph edge, 3g - 3 + 2b of them, -2 chi
// three-prong points, no part of the surface lost.
void check_pieces(const Sliced& sliced, const TriangleMesh& mesh, int euler, int loops) {
    const int cylinders = (3 * -euler + loops) / 2;
    if (static_cast<int>(sliced.pieces.size()) != cylinders) {
        fail("wrong-number-of-cylinders",
             fmt::format("slicing: {} cylinders instead of {}", sliced.pieces.size(), cylinders));
    }
    if (static_cast<int>(sliced.three_prongs.size()) != -2 * euler) {
        fail("wrong-number-of-prongs", fmt::format("slicing: {} three-prong points instead of {}",
                                                   sliced.three_prongs.size(), -2 * euler));
    }
    double area = 0.0;
    for (const Piece& piece : sliced.pieces) {
        area += surface_area(piece.mesh);
    }
    const double whole = surface_area(mesh);
    if (!(std::abs(area - whole) <= kAreaTolerance * whole)) {
        fail("area-lost", fmt::format("slicing: the cylinders have {:.6g} of the surface's area "
                                      "{:.6g}",
                                      area, whole));
    }
}

Solved carry_up(const Hierarchy& hierarchy, const CoarseMap& coarse, const Context& context) {
    FineMap fine = refine_map(hierarchy, coarse.map, context);
    context.report("foliation", 0.5);
    Solved solved{std::move(fine.map), fine.report, hierarchy.levels.front().surface.mesh, {}};
    const int euler = static_cast<int>(solved.mesh.positions.size()) -
                      static_cast<int>(hierarchy.levels.front().rings.edges.size()) +
                      static_cast<int>(solved.mesh.triangles.size());
    solved.sliced = split_and_slice(solved.mesh, solved.map, context);
    check_pieces(solved.sliced, solved.mesh, euler, hierarchy.boundary_lines);
    return solved;
}

// The chart of one piece, its f from 0 to the weight of its graph edge, which has this share of the
// surface.
Foliation chart_of(const Piece& piece,
                   double share,
                   double height,
                   const FoliationOptions& options,
                   const Context& context) {
    FoliationOptions own = options;
    if (own.junctions) {
        own.junctions->cells *= share;
    }
    Foliation ring = foliate_ring(piece.mesh, piece.loops, own, context);
    Cylinder& cylinder = ring.cylinders.front();
    cylinder.width *= height;
    cylinder.height *= height;
    cylinder.energy *= height * height;
    for (auto& corners : cylinder.corner_gf) {
        for (Eigen::Vector2d& gf : corners) {
            gf *= height;
        }
    }
    for (int& source : cylinder.source_vertex) {
        cylinder.critical_point.push_back(source < 0 ? -1 : piece.critical_point[at(source)]);
        source = source < 0 ? -1 : piece.source_vertex[at(source)];
    }
    return ring;
}

// At the minimum the map has the energy of its cylinders; weights forced positive make it larger.
void check_energy(const Foliation& foliation, std::vector<std::string>& warnings) {
    double cylinders = 0.0;
    for (const Cylinder& cylinder : foliation.cylinders) {
        cylinders += 0.5 * cylinder.width * cylinder.height;
    }
    const double excess = foliation.energy / cylinders - 1.0;
    if (!(std::abs(excess) <= kImpossibleExcess)) {
        fail(
            "energy-mismatch",
            fmt::format("harmonic map: its energy {:.6g} is far from that of its cylinders, {:.6g}",
                        foliation.energy, cylinders));
    }
    if (std::abs(excess) > kNotableExcess) {
        warnings.push_back(
            fmt::format("the mesh is coarse for its shape: the map's energy differs from its "
                        "cylinders' by {:.0f} %, so the critical graph may be off; refine the mesh",
                        100.0 * excess));
    }
}

// A graph edge that nothing of the surface is mapped to ends the job in slicing; one that hardly
// anything is mapped to is worth a word.
void report_squeezed(const Sliced& sliced, double whole, std::vector<std::string>& warnings) {
    for (std::size_t e = 0; e < sliced.pieces.size(); ++e) {
        const double share = surface_area(sliced.pieces[e].mesh) / whole;
        if (share < kSqueezedShare) {
            warnings.push_back(
                fmt::format("cylinder {} has nearly collapsed: it holds {:.2g} % of "
                            "the surface; give it less weight, or another "
                            "foliation.function",
                            e, 100.0 * share));
        }
    }
}

Foliation assemble(Solved solved, const FoliationOptions& options, const Context& context) {
    Foliation foliation;
    foliation.mode = FoliationMode::Pants;
    foliation.graph = solved.map.graph;
    foliation.energy = solved.report.energy;
    foliation.iterations = solved.report.iterations;
    if (!solved.report.converged) {
        foliation.warnings.emplace_back("the harmonic map stopped before it was quite still");
    }
    const double whole = surface_area(solved.mesh);
    report_squeezed(solved.sliced, whole, foliation.warnings);
    for (const Eigen::Vector3d& position : solved.sliced.three_prongs) {
        foliation.singularities.push_back({position, 3});
    }
    foliation.critical_graph = std::move(solved.sliced.critical_arcs);
    foliation.critical_points = std::move(solved.sliced.critical_points);

    // The largest first: then threads end together.
    const std::vector<Piece>& pieces = solved.sliced.pieces;
    std::vector<std::size_t> order(pieces.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return pieces[a].mesh.triangles.size() > pieces[b].mesh.triangles.size();
    });
    std::vector<Foliation> rings(pieces.size());
    for_each_task(order.size(), context, [&](std::size_t i, const Context& own) {
        const std::size_t e = order[i];
        const double share = surface_area(pieces[e].mesh) / whole;
        rings[e] = chart_of(pieces[e], share, foliation.graph.edges[e].weight, options, own);
    });
    for (std::size_t e = 0; e < rings.size(); ++e) {
        rings[e].cylinders.front().graph_edge = static_cast<int>(e);
        for (const std::string& warning : rings[e].warnings) {
            foliation.warnings.push_back(fmt::format("cylinder {}: {}", e, warning));
        }
        foliation.cylinders.push_back(std::move(rings[e].cylinders.front()));
    }
    check_energy(foliation, foliation.warnings);
    foliation.spread = cell_spread(foliation.cylinders);
    return foliation;
}

void add_alternatives(Foliation& foliation,
                      const std::vector<CoarseMap>& maps,
                      std::size_t chosen) {
    for (std::size_t i = 0; i < maps.size(); ++i) {
        foliation.alternatives.push_back({.name = "pants " + maps[i].name,
                                          .spread = maps[i].spread,
                                          .removed_area = 0.0,
                                          .chosen = i == chosen});
    }
}

// Solved again with weights that suit the grid, where that is better.
Foliation suit_junctions(Foliation foliation,
                         const Hierarchy& hierarchy,
                         const CoarseMap& coarse,
                         const FoliationOptions& options,
                         const Context& context) {
    const auto refoliate = [&](const GraphMap& map) {
        CoarseMap other;
        other.map = map;
        return assemble(carry_up(hierarchy, other, context), options, context);
    };
    return with_whole_columns(std::move(foliation),
                              {hierarchy.levels.back(), coarse.map, refoliate}, options, context);
}

// Weights that are given, or lead singular points, stay.
bool is_evened(const FoliationOptions& options) {
    return options.even_cells && !options.weights && options.near.empty();
}

// Why there is no foliation yet.
struct Failures {
    std::vector<std::string> reasons;
    bool all_forbidden = false;  // Some decompositions were left out, and no others found.
};

// The first candidate of this hierarchy that passes all checks.
std::optional<Foliation> try_candidates(const Hierarchy& hierarchy,
                                        const CoarseOptions& coarse,
                                        const FoliationOptions& options,
                                        const Context& context,
                                        Failures& failures) {
    const double cells = options.junctions ? options.junctions->cells : kUsualCells;
    double variation = 0.0;  // Before weights are changed for it.
    std::vector<CoarseMap> maps;
    try {
        maps = solve_coarsest(hierarchy, coarse, context);
        if (is_evened(options)) {
            variation = forecast_grid(hierarchy.levels.back(), maps.front().map, cells).variation;
            maps = even_maps(hierarchy, std::move(maps), cells, context);
        }
        if (!options.near.empty()) {
            maps = nearest_maps(hierarchy, std::move(maps),
                                {options.near, options.weights.has_value()}, context);
        }
    } catch (const Error& error) {
        if (error.kind() != ErrorKind::SelfCheck) {
            throw;
        }
        failures.reasons.emplace_back(error.what());
        failures.all_forbidden = failures.all_forbidden || error.code() == "none-allowed";
    }
    context.report("foliation", 0.3);
    for (std::size_t i = 0; i < std::min(maps.size(), kMostCandidates); ++i) {
        try {
            Foliation foliation = assemble(carry_up(hierarchy, maps[i], context), options, context);
            if (options.junctions) {
                foliation =
                    suit_junctions(std::move(foliation), hierarchy, maps[i], options, context);
            }
            if (is_evened(options)) {
                foliation.evened = {
                    variation,
                    forecast_grid(hierarchy.levels.back(), maps[i].map, cells).variation};
            }
            add_alternatives(foliation, maps, i);
            return foliation;
        } catch (const Error& error) {
            if (error.kind() != ErrorKind::SelfCheck) {
                throw;
            }
            failures.reasons.push_back(fmt::format("{}: {}", maps[i].name, error.what()));
        }
    }
    return std::nullopt;
}

// What to try, one after the other. Where ways are forbidden, other sources may know another one.
std::vector<CoarseOptions> attempts_of(const FoliationOptions& options) {
    std::vector<CoarseOptions> attempts;
    attempts.reserve(kAttempts);
    for (int attempt = 0; attempt < kAttempts; ++attempt) {
        attempts.push_back({options.pants, options.function, options.weights, attempt});
    }
    if (!options.forbidden_loops.empty() && options.pants == PantsSource::Reeb) {
        for (const PantsSource source : {PantsSource::HandleLoops, PantsSource::TunnelLoops}) {
            attempts.push_back({source, options.function, options.weights});
        }
    }
    return attempts;
}

std::optional<Foliation> try_attempts(const Hierarchy& hierarchy,
                                      const FoliationOptions& options,
                                      const Context& context,
                                      Failures& failures) {
    std::optional<ForbiddenLoops> forbidden;
    if (!options.forbidden_loops.empty()) {
        const bool has_loops = options.pants == PantsSource::User;
        forbidden.emplace(hierarchy, options.forbidden_loops,
                          has_loops ? options.loops : std::vector<std::vector<int>>{}, context);
    }
    for (CoarseOptions& attempt : attempts_of(options)) {
        if (forbidden) {
            attempt.is_allowed = [&](const GraphMap& map) { return forbidden->allow(map); };
        }
        std::optional<Foliation> foliation =
            try_candidates(hierarchy, attempt, options, context, failures);
        if (foliation) {
            return foliation;
        }
    }
    return std::nullopt;
}

}  // namespace

Foliation foliate_pants(const TriangleMesh& mesh,
                        const std::vector<std::vector<int>>& loops,
                        const FoliationOptions& options,
                        const Context& context) {
    const std::vector<std::vector<int>> no_cuts;
    const PreparedSurface prepared =
        prepare_surface(mesh, loops, options.pants == PantsSource::User ? options.loops : no_cuts,
                        options.refinement, context);
    context.report("foliation", 0.05);
    Failures failures;
    for (const std::size_t coarsest : {kCoarsest, kFinerCoarsest}) {
        const Hierarchy hierarchy =
            build_hierarchy(prepared.surface, prepared.boundary_lines, coarsest, context);
        context.report("foliation", 0.15);
        std::optional<Foliation> foliation = try_attempts(hierarchy, options, context, failures);
        if (foliation) {
            for (Cylinder& cylinder : foliation->cylinders) {
                for (int& source : cylinder.source_vertex) {
                    source = source >= 0 && at(source) < mesh.positions.size() ? source : -1;
                }
            }
            return std::move(*foliation);
        }
        if (failures.all_forbidden) {
            throw Error(ErrorKind::BadOption, "all-forbidden",
                        "foliation.forbid: every pants decomposition found goes one of these ways; "
                        "forbid fewer, or give ways to take instead (foliation.pants \"user\" and "
                        "foliation.loops)");
        }
    }
    fail("no-sound-decomposition",
         fmt::format("harmonic map: no pants decomposition gave sound cylinders ({}); repair or "
                     "refine the mesh",
                     fmt::join(failures.reasons, "; ")));
}

}  // namespace leafcutter::geometry
