#include "geometry/pants/decomposition.h"

#include <cstddef>
#include <utility>

#include <fmt/format.h>

#include "geometry/error.h"
#include "geometry/half_edges.h"
#include "geometry/loops/cut_along.h"
#include "geometry/loops/edge_paths.h"
#include "geometry/loops/handle_tunnel.h"
#include "geometry/pants/glue_maps.h"
#include "geometry/pants/initial_map.h"
#include "geometry/pants/pants_graph.h"
#include "geometry/pants/reeb_graph.h"
#include "geometry/pants/sweep_function.h"
#include "geometry/pants/tree_triangle.h"

namespace leafcutter::geometry {
namespace {

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

const char* name_of(SweepFunction function) {
    switch (function) {
        case SweepFunction::X:
            return "x";
        case SweepFunction::Y:
            return "y";
        case SweepFunction::Z:
            return "z";
        case SweepFunction::Fiedler:
            return "fiedler";
        case SweepFunction::Auto:
        case SweepFunction::Harmonic:
            break;
    }
    return "harmonic";
}

std::vector<SweepFunction> functions_of(SweepFunction function) {
    if (function != SweepFunction::Auto) {
        return {function};
    }
    return {SweepFunction::Harmonic, SweepFunction::X, SweepFunction::Y, SweepFunction::Z,
            SweepFunction::Fiedler};
}

GraphMap reeb_map(const DecompositionSurface& surface, SweepFunction function, int attempt) {
    const SweepValues sweep = sweep_values(surface, function, attempt);
    const ReebGraph reeb = build_reeb_graph(surface.triangles, sweep.values, surface.boundary_loops,
                                            sweep.loop_is_low, attempt);
    return initial_map(reeb, surface.rings, surface.boundary_loops);
}

// What a loop of a disk or annulus was, for its message.
std::string describe(const LoopOrigin& origin) {
    return origin.cut >= 0 ? fmt::format("loops[{}]", origin.cut)
                           : fmt::format("boundary loop {}", origin.boundary);
}

void check_essential(const CutPiece& piece) {
    if (piece.euler < 0) {
        return;
    }
    if (piece.loops.size() == 1) {
        throw Error(ErrorKind::BadOption, "loop-not-essential",
                    fmt::format("{} bounds a disk: lead it round a handle or leave it out",
                                describe(piece.origins[0])));
    }
    throw Error(ErrorKind::BadOption, "loops-homotopic",
                fmt::format("{} and {} bound a ring without a hole or handle in it: leave one out",
                            describe(piece.origins[0]), describe(piece.origins[1])));
}

// The surface cut open, and what each piece needs to be decomposed by itself.
class Pieces {
public:
    explicit Pieces(const DecompositionSurface& surface)
        : surface_(surface), cuts_(surface.cuts.size()) {
        for (CutPiece& piece :
             cut_along(surface.triangles, static_cast<int>(surface.positions.size()),
                       surface.boundary_loops, surface.cuts)) {
            check_essential(piece);
            add(std::move(piece));
        }
    }

    GraphMap decompose(SweepFunction function, int attempt) {
        for (std::size_t k = 0; k < parts_.size(); ++k) {
            const CutPiece& piece = parts_[k].piece;
            const DecompositionSurface part{piece.triangles, positions_[k], parts_[k].rings,
                                            weights_[k],     piece.loops,   {}};
            parts_[k].map = reeb_map(part, function, attempt);
        }
        return glue_maps(parts_, cuts_, surface_.rings);
    }

private:
    void add(CutPiece piece) {
        const int count = static_cast<int>(piece.source_vertex.size());
        MappedPiece part;
        part.rings = build_vertex_rings(build_half_edges(piece.triangles, count), count);
        std::vector<Eigen::Vector3d>& positions = positions_.emplace_back();
        for (const int v : piece.source_vertex) {
            positions.push_back(surface_.positions[at(v)]);
        }
        std::vector<double>& weights = weights_.emplace_back();
        for (const MeshEdge& edge : part.rings.edges) {
            const auto whole = find_edge(surface_.rings, piece.source_vertex[at(edge.from)],
                                         piece.source_vertex[at(edge.to)]);
            weights.push_back(surface_.weights[at(whole)]);
        }
        part.piece = std::move(piece);
        parts_.push_back(std::move(part));
    }

    const DecompositionSurface& surface_;
    std::size_t cuts_;
    std::vector<MappedPiece> parts_;
    std::vector<std::vector<Eigen::Vector3d>> positions_;  // Per part.
    std::vector<std::vector<double>> weights_;
};

int euler_of(const DecompositionSurface& surface) {
    return static_cast<int>(surface.positions.size()) -
           static_cast<int>(surface.rings.edges.size()) +
           static_cast<int>(surface.triangles.size());
}

const char* name_of(PantsSource source) {
    switch (source) {
        case PantsSource::HandleLoops:
            return "handle-loops";
        case PantsSource::TunnelLoops:
            return "tunnel-loops";
        case PantsSource::User:
            return "loops";
        case PantsSource::Reeb:
            break;
    }
    return "reeb";
}

}  // namespace

std::vector<PantsCandidate> pants_candidates(const DecompositionSurface& surface,
                                             PantsSource source,
                                             SweepFunction function,
                                             int attempt,
                                             const Context& context) {
    DecompositionSurface with_cuts = surface;
    if (source != PantsSource::Reeb && source != PantsSource::User && surface.cuts.empty()) {
        LoopSystem loops = find_loops(surface, context);
        with_cuts.cuts =
            std::move(source == PantsSource::HandleLoops ? loops.handle : loops.tunnel);
    }
    Pieces pieces(with_cuts);
    std::vector<PantsCandidate> candidates;
    std::string reasons;
    for (const SweepFunction one : functions_of(function)) {
        context.check();
        const std::string name = fmt::format("{}-{}", name_of(source), name_of(one));
        try {
            GraphMap map = pieces.decompose(one, attempt);
            check_pants_graph(map.graph, euler_of(surface),
                              static_cast<int>(surface.boundary_loops.size()));
            if (const int triangle = find_misfit(map, surface.rings); triangle >= 0) {
                throw Error(ErrorKind::SelfCheck, "broken-tree",
                            fmt::format("the words round triangle {} don't fit", triangle));
            }
            candidates.push_back({name, std::move(map)});
        } catch (const Error& error) {
            reasons += fmt::format("; {}: {}", name, error.what());
        }
    }
    if (candidates.empty()) {
        throw Error(ErrorKind::SelfCheck, "pants-graph",
                    fmt::format("pants: no function gives a sound graph{}", reasons));
    }
    return candidates;
}

}  // namespace leafcutter::geometry
