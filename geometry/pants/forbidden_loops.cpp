#include "geometry/pants/forbidden_loops.h"

#include <algorithm>
#include <cstddef>
#include <functional>
#include <limits>
#include <queue>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "geometry/error.h"
#include "geometry/loops/edge_paths.h"
#include "geometry/pants/flippable.h"

namespace leafcutter::geometry {
namespace {

constexpr int kStepsBetweenChecks = 4096;

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

[[noreturn]] void refuse(const char* code, std::size_t loop, const std::string& what) {
    throw Error(ErrorKind::BadOption, code, fmt::format("foliation.forbid[{}]: {}", loop, what));
}

// From vertex `from` to `to`, which an edge joins.
Holonomy along(const std::vector<Holonomy>& holonomies,
               const VertexRings& rings,
               int from,
               int to) {
    const std::size_t edge = at(find_edge(rings, from, to));
    return rings.edges[edge].from == from ? holonomies[edge] : holonomies[edge].inverse();
}

// From the flipped surface of a level to its own: the diagonals of two triangles are joined by the
// sides.
std::vector<Holonomy> unflipped(const Hierarchy::Level& level, std::vector<Holonomy> holonomies) {
    FlippableMesh mesh(level.flipped.rings);
    std::vector<int> start;  // Per edge: where its holonomy starts.
    for (const MeshEdge& edge : level.flipped.rings.edges) {
        start.push_back(edge.from);
    }
    const auto of_side = [&](int h) {
        const std::size_t edge = at(mesh.edge_of(h));
        return start[edge] == mesh.from_of(h) ? holonomies[edge] : holonomies[edge].inverse();
    };
    for (std::size_t i = level.flipped.flips.size(); i-- > 0;) {
        const int flip = level.flipped.flips[i];
        const int h = mesh.half_edge_of(flip);
        const int c = mesh.facing(h);
        // From c to the start of h, and on to the corner on its other side.
        const Holonomy across =
            of_side(HalfEdges::previous(h)) * of_side(HalfEdges::next(mesh.twin_of(h)));
        mesh.flip(h);
        holonomies[at(flip)] = across;
        start[at(flip)] = c;
    }
    for (std::size_t e = 0; e < start.size(); ++e) {
        if (start[e] != level.rings.edges[e].from) {
            holonomies[e] = holonomies[e].inverse();
        }
    }
    return holonomies;
}

// From a level to the flipped surface of the next finer one: what was collapsed to a vertex is the
// identity.
std::vector<Holonomy> prolonged(const std::vector<Holonomy>& coarse,
                                const VertexRings& coarse_rings,
                                const Hierarchy::Level& finer) {
    std::vector<Holonomy> holonomies;
    for (const MeshEdge& edge : finer.flipped.rings.edges) {
        const int from = finer.representative[at(edge.from)];
        const int to = finer.representative[at(edge.to)];
        holonomies.push_back(from == to ? Holonomy{} : along(coarse, coarse_rings, from, to));
    }
    return holonomies;
}

// Shortest ways along edges.
class EdgePaths {
public:
    EdgePaths(const Hierarchy::Level& level, const Context& context)
        : positions_(level.surface.mesh.positions), rings_(level.rings), context_(context) {}

    // From `from`, included, to `to`, not included.
    std::vector<int> way(int from, int to) const {
        using Entry = std::pair<double, int>;
        // Searched for from the end, so that the way is told from the start.
        std::vector<double> length(positions_.size(), std::numeric_limits<double>::infinity());
        std::vector<int> next(positions_.size(), -1);
        std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
        length[at(to)] = 0.0;
        queue.emplace(0.0, to);
        for (int steps = 1; !queue.empty() && queue.top().second != from; ++steps) {
            const auto [d, v] = queue.top();
            queue.pop();
            if (steps % kStepsBetweenChecks == 0) {
                context_.check();
            }
            for (int k = rings_.begin[at(v)]; d <= length[at(v)] && k < rings_.begin[at(v) + 1];
                 ++k) {
                const int w = rings_.slots[at(k)].neighbour;
                const double through = d + (positions_[at(v)] - positions_[at(w)]).norm();
                if (through < length[at(w)]) {
                    length[at(w)] = through;
                    next[at(w)] = v;
                    queue.emplace(through, w);
                }
            }
        }
        std::vector<int> way;
        for (int v = from; v != to; v = next[at(v)]) {
            way.push_back(v);
        }
        return way;
    }

private:
    const std::vector<Eigen::Vector3d>& positions_;
    const VertexRings& rings_;
    const Context& context_;
};

std::vector<int> closed_way(const EdgePaths& paths, const std::vector<int>& vertices) {
    std::vector<int> loop;
    for (std::size_t k = 0; k < vertices.size(); ++k) {
        const std::vector<int> way = paths.way(vertices[k], vertices[(k + 1) % vertices.size()]);
        loop.insert(loop.end(), way.begin(), way.end());
    }
    return loop;
}

Holonomy round(const std::vector<Holonomy>& holonomies,
               const VertexRings& rings,
               const std::vector<int>& loop) {
    Holonomy all;
    for (std::size_t k = 0; k < loop.size(); ++k) {
        all = all * along(holonomies, rings, loop[k], loop[(k + 1) % loop.size()]);
    }
    return all;
}

// Traces of all boundary loops.
std::set<LoopTrace> boundary_traces(const std::vector<Holonomy>& holonomies,
                                    const Hierarchy::Level& level) {
    std::vector<int> next(level.surface.mesh.positions.size(), -1);
    const HalfEdges& edges = level.flipped.half_edges;
    for (int h = 0; h < edges.size(); ++h) {
        if (edges.twin_of(h) < 0) {
            next[at(edges.from_of(h))] = edges.to_of(h);
        }
    }
    std::set<LoopTrace> traces;
    for (std::size_t v = 0; v < next.size(); ++v) {
        std::vector<int> loop;
        for (int w = static_cast<int>(v); next[at(w)] >= 0;) {
            loop.push_back(w);
            w = std::exchange(next[at(w)], -1);
        }
        if (!loop.empty()) {
            traces.insert(trace_of(round(holonomies, level.flipped.rings, loop)));
        }
    }
    return traces;
}

// The middle lines of a map's cylinders, as they cross the edges of the coarsest flipped surface.
class MiddleLines {
public:
    MiddleLines(const Hierarchy::Level& level,
                const std::vector<Holonomy>& holonomies,
                const GraphMap& map)
        : edges_(level.flipped.half_edges), rings_(level.flipped.rings), holonomies_(holonomies) {
        for (std::size_t e = 0; e < rings_.edges.size(); ++e) {
            crossed_.push_back(crossed_by(map, rings_.edges[e], map.words[e]));
        }
    }

    // Along each cylinder's line; the identity where none is found.
    std::vector<Holonomy> follow_all(std::size_t cylinders) const {
        std::vector<Holonomy> lines(cylinders);
        for (int h = 0; h < edges_.size(); ++h) {
            const std::vector<int>& crossed = crossed_along(h);
            for (std::size_t i = 0; edges_.is_first(h) && i < crossed.size(); ++i) {
                Holonomy& line = lines[at(crossed[i])];
                if (line == Holonomy{}) {
                    line = follow({h, static_cast<int>(i)});
                }
            }
        }
        return lines;
    }

private:
    // A crossing: the i-th of those of half-edge `h`, counted from its start.
    struct Crossing {
        int h = 0;
        int i = 0;
        bool operator==(const Crossing&) const = default;
    };

    // Graph edges whose middles lie on the way along a mesh edge, in their order.
    static std::vector<int> crossed_by(const GraphMap& map,
                                       const MeshEdge& edge,
                                       const Word& word) {
        const auto is_low = [&](int v) {
            return map.t[at(v)] < 0.5 * map.weight(map.graph_edge[at(v)]);
        };
        std::vector<int> crossed;
        if (word.empty()) {
            if (is_low(edge.from) != is_low(edge.to)) {
                crossed.push_back(map.graph_edge[at(edge.from)]);
            }
            return crossed;
        }
        for (std::size_t k = 0; k < word.size(); ++k) {
            const bool leaves = k > 0 || is_low(edge.from) == runs_forward(word[k]);
            const bool arrives = k + 1 < word.size() || is_low(edge.to) != runs_forward(word[k]);
            if (leaves && arrives) {
                crossed.push_back(edge_of(word[k]));
            }
        }
        return crossed;
    }

    // In the order of the mesh edge.
    const std::vector<int>& crossed_along(int h) const {
        return crossed_[at(rings_.edge_of_half_edge[at(h)])];
    }
    int count(int h) const { return static_cast<int>(crossed_along(h).size()); }
    bool is_forward(int h) const {
        return rings_.edges[at(rings_.edge_of_half_edge[at(h)])].from == edges_.from_of(h);
    }
    Holonomy of_side(int h) const {
        const Holonomy& holonomy = holonomies_[at(rings_.edge_of_half_edge[at(h)])];
        return is_forward(h) ? holonomy : holonomy.inverse();
    }

    // Lines run round the corners of a triangle; those next to a corner turn round it.
    Holonomy follow(Crossing start) const {
        Holonomy all;
        if (!is_forward(start.h)) {
            start.i = count(start.h) - 1 - start.i;
        }
        Crossing here = start;
        do {
            const int after = HalfEdges::next(here.h);
            const int before = HalfEdges::previous(here.h);
            const int round_start = (count(here.h) + count(before) - count(after)) / 2;
            if (here.i < round_start) {
                here = {edges_.twin_of(before), here.i};
            } else {
                const int from_end = count(here.h) - 1 - here.i;
                here = {edges_.twin_of(after), count(after) - 1 - from_end};
                all = all * of_side(before).inverse();
            }
            if (here.h < 0) {
                return {};
            }
        } while (here != start);
        return all;
    }

    const HalfEdges& edges_;
    const VertexRings& rings_;
    const std::vector<Holonomy>& holonomies_;
    std::vector<std::vector<int>> crossed_;  // Per mesh edge.
};

void check_vertices(const Hierarchy::Level& finest, const std::vector<int>& loop, std::size_t k) {
    if (loop.size() < 3) {
        refuse("loop-vertices", k, "give at least three vertices");
    }
    for (const int v : loop) {
        if (v < 0 || at(v) >= finest.surface.mesh.positions.size()) {
            refuse("loop-vertices", k, fmt::format("vertex {} is not one of the surface's", v));
        }
    }
}

}  // namespace

ForbiddenLoops::ForbiddenLoops(const Hierarchy& hierarchy,
                               std::span<const std::vector<int>> loops,
                               std::span<const std::vector<int>> kept,
                               const Context& context)
    : level_(hierarchy.levels.back()),
      holonomies_(random_holonomies(level_.flipped.half_edges, level_.flipped.rings)) {
    std::vector<Holonomy> finest = unflipped(level_, holonomies_);
    for (std::size_t k = hierarchy.levels.size() - 1; k > 0; --k) {
        context.check();
        const Hierarchy::Level& finer = hierarchy.levels[k - 1];
        finest = unflipped(finer, prolonged(finest, hierarchy.levels[k].rings, finer));
    }
    const Hierarchy::Level& surface = hierarchy.levels.front();
    const EdgePaths paths(surface, context);
    const std::set<LoopTrace> at_boundary = boundary_traces(holonomies_, level_);
    std::set<LoopTrace> wanted;
    for (const std::vector<int>& loop : kept) {
        wanted.insert(trace_of(round(finest, surface.rings, closed_way(paths, loop))));
    }
    for (std::size_t k = 0; k < loops.size(); ++k) {
        check_vertices(surface, loops[k], k);
        const Holonomy way = round(finest, surface.rings, closed_way(paths, loops[k]));
        const LoopTrace trace = trace_of(way);
        if (way == Holonomy{}) {
            refuse("loop-not-essential", k,
                   "it can be drawn together to a point, so no cylinder goes that way; lead it "
                   "round a handle or a hole");
        }
        if (at_boundary.count(trace) > 0) {
            refuse("loop-at-boundary", k,
                   "it goes round a boundary loop, where there always is a cylinder");
        }
        if (wanted.count(trace) > 0) {
            refuse("loop-kept", k, "it goes the way of one of foliation.loops");
        }
        forbidden_.insert(trace);
    }
}

bool ForbiddenLoops::allow(const GraphMap& map) const {
    const std::vector<Holonomy> lines =
        MiddleLines(level_, holonomies_, map).follow_all(map.graph.edges.size());
    return std::none_of(lines.begin(), lines.end(),
                        [&](const Holonomy& line) { return forbidden_.count(trace_of(line)) > 0; });
}

}  // namespace leafcutter::geometry
