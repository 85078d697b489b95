#include "geometry/pants/coarse_maps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "geometry/loops/edge_paths.h"
#include "geometry/pants/decomposition.h"
#include "geometry/parallel.h"

namespace leafcutter::geometry {
namespace {

// Least length of a cylinder, by the longest.
constexpr double kLeastHeight = 0.02;
// Powers tried for evening cells, and steps with each.
constexpr std::array<double, 2> kEveningPowers{-0.25, -0.5};
constexpr int kEveningSteps = 3;
// What a factor e of loop length costs, in units of unevenness.
constexpr double kLengthShare = 0.1;
constexpr double kScoreStep = 1e-3;

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

// The vertices of a closed line of edges inside the surface, in order.
std::vector<int> trace_cut(const VertexRings& rings,
                           const std::vector<int>& line_of_vertex,
                           int start) {
    std::vector<int> cut{start};
    int previous = -1;
    for (int v = start;;) {
        int next = -1;
        for (int k = rings.begin[at(v)]; k < rings.begin[at(v) + 1] && next < 0; ++k) {
            const int w = rings.slots[at(k)].neighbour;
            if (w != previous && line_of_vertex[at(w)] == line_of_vertex[at(start)]) {
                next = w;
            }
        }
        if (next < 0 || next == start) {
            return cut;
        }
        cut.push_back(next);
        previous = std::exchange(v, next);
    }
}

// The closed lines of a level: boundary loops with the surface to the left, then cuts.
struct Lines {
    std::vector<std::vector<int>> boundary;
    std::vector<std::vector<int>> cuts;
};

std::vector<int> trace_boundary(const std::vector<int>& next, int start) {
    std::vector<int> loop{start};
    for (int v = next[at(start)]; v != start; v = next[at(v)]) {
        loop.push_back(v);
    }
    return loop;
}

Lines lines_of(const Hierarchy& hierarchy, const Hierarchy::Level& level) {
    const HalfEdges& edges = level.flipped.half_edges;
    std::vector<int> next(level.surface.line_of_vertex.size(), -1);
    for (int h = 0; h < edges.size(); ++h) {
        if (edges.twin_of(h) < 0) {
            next[at(edges.from_of(h))] = edges.to_of(h);
        }
    }
    Lines lines;
    std::vector<char> seen;
    for (std::size_t v = 0; v < level.surface.line_of_vertex.size(); ++v) {
        const int line = level.surface.line_of_vertex[v];
        if (line < 0) {
            continue;
        }
        seen.resize(std::max(seen.size(), at(line) + 1), 0);
        if (std::exchange(seen[at(line)], char{1}) != 0) {
            continue;
        }
        const int start = static_cast<int>(v);
        const bool boundary = line < hierarchy.boundary_lines;
        auto& of_kind = boundary ? lines.boundary : lines.cuts;
        const std::size_t place = at(boundary ? line : line - hierarchy.boundary_lines);
        of_kind.resize(std::max(of_kind.size(), place + 1));
        of_kind[place] = boundary
                             ? trace_boundary(next, start)
                             : trace_cut(level.flipped.rings, level.surface.line_of_vertex, start);
    }
    return lines;
}

void set_weights(GraphMap& map, const std::vector<double>& weights) {
    for (std::size_t v = 0; v < map.t.size(); ++v) {
        const std::size_t e = at(map.graph_edge[v]);
        map.t[v] *= weights[e] / map.graph.edges[e].weight;
    }
    for (std::size_t e = 0; e < weights.size(); ++e) {
        map.graph.edges[e].weight = weights[e];
    }
}

// What every graph edge's part of the surface measures, seen from the start of the sweep: long
// limbs get many rows.
std::vector<double> lengths_of_parts(const GraphMap& map, const std::vector<double>& distance) {
    const std::size_t count = map.graph.edges.size();
    std::vector<double> least(count, std::numeric_limits<double>::infinity());
    std::vector<double> most(count, 0.0);
    for (std::size_t v = 0; v < distance.size(); ++v) {
        const std::size_t e = at(map.graph_edge[v]);
        least[e] = std::min(least[e], distance[v]);
        most[e] = std::max(most[e], distance[v]);
    }
    std::vector<double> lengths(count);
    for (std::size_t e = 0; e < count; ++e) {
        lengths[e] = std::max(most[e] - least[e], 0.0);
    }
    const double longest = *std::max_element(lengths.begin(), lengths.end());
    for (double& length : lengths) {
        length = std::max(length, kLeastHeight * longest);
    }
    return lengths;
}

// Per triangle its area and its energy, which is its area in the flat metric: edges share theirs
// out to their triangles evenly.
std::vector<FlatArea> flat_areas(const Hierarchy::Level& level, const GraphMap& map) {
    const FlippedSurface& flipped = level.flipped;
    std::vector<FlatArea> parts(flipped.area.size());
    for (std::size_t t = 0; t < parts.size(); ++t) {
        parts[t].surface = flipped.area[t];
    }
    for (std::size_t e = 0; e < flipped.rings.edges.size(); ++e) {
        const MeshEdge& edge = flipped.rings.edges[e];
        const double d = map.distance(edge.from, edge.to, map.words[e]);
        const double flat = flipped.weights[e] * d * d;
        const int twin = flipped.half_edges.twin_of(edge.half_edge);
        parts[at(edge.half_edge / 3)].flat += twin >= 0 ? 0.5 * flat : flat;
        if (twin >= 0) {
            parts[at(twin / 3)].flat += 0.5 * flat;
        }
    }
    return parts;
}

void judge(CoarseMap& solved, const Hierarchy::Level& level) {
    const std::vector<FlatArea> parts = flat_areas(level, solved.map);
    solved.spread = cell_spread(parts);
    double surface = 0.0;
    double flat = 0.0;
    for (const FlatArea& part : parts) {
        surface += part.surface;
        flat += part.flat;
    }
    const double mean = surface / flat;
    const double least = 1e-12 * flat / static_cast<double>(parts.size());
    double square = 0.0;
    for (std::size_t t = 0; t < parts.size(); ++t) {
        const FlatArea& part = parts[t];
        const double size = std::log(part.surface / (std::max(part.flat, least) * mean));
        square += part.surface > 0.0 ? part.surface * size * size : 0.0;
        const int v = level.flipped.half_edges.from_of(static_cast<int>(3 * t));
        solved.loop_length +=
            std::sqrt(part.surface * part.flat) / solved.map.weight(solved.map.graph_edge[at(v)]);
    }
    solved.unevenness = std::sqrt(square / surface);
    // Differences that a draft doesn't know are no differences: equals keep their order.
    solved.score =
        kScoreStep * std::round((solved.unevenness +
                                 kLengthShare * std::log(solved.loop_length / std::sqrt(surface))) /
                                kScoreStep);
}

// Candidates on the flipped surface, whose edges have numbers of their own: a flip keeps them.
std::vector<PantsCandidate> candidates_of(const Hierarchy::Level& level,
                                          Lines lines,
                                          const CoarseOptions& options,
                                          const Context& context) {
    const VertexRings& numbered = level.flipped.rings;
    const std::vector<std::array<int, 3>> triangles = triangles_of(level.flipped.half_edges);
    const VertexRings rings = build_vertex_rings(
        level.flipped.half_edges, static_cast<int>(level.surface.mesh.positions.size()));
    std::vector<int> number;
    std::vector<double> weights;
    for (const MeshEdge& edge : rings.edges) {
        number.push_back(numbered.edge_of_half_edge[at(edge.half_edge)]);
        weights.push_back(level.flipped.weights[at(number.back())]);
    }
    const DecompositionSurface surface{
        triangles, level.surface.mesh.positions, rings,
        weights,   std::move(lines.boundary),    std::move(lines.cuts)};
    std::vector<PantsCandidate> candidates =
        pants_candidates(surface, options.pants, options.function, options.attempt, context);
    for (PantsCandidate& candidate : candidates) {
        std::vector<Word> words(candidate.map.words.size());
        for (std::size_t e = 0; e < words.size(); ++e) {
            const bool same = numbered.edges[at(number[e])].from == rings.edges[e].from;
            Word& word = candidate.map.words[e];
            words[at(number[e])] = same ? std::move(word) : reversed(word);
        }
        candidate.map.words = std::move(words);
    }
    return candidates;
}

CoarseMap solve_one(const Hierarchy::Level& level,
                    GraphMap map,
                    MapStart start,
                    const Context& context) {
    CoarseMap solved;
    solved.map = std::move(map);
    solved.report = solve_harmonic_map(solved.map, level.flipped.rings, level.flipped.weights,
                                       {start, MapAccuracy::Draft}, context);
    judge(solved, level);
    return solved;
}

// Gives long thin cylinders more height and short fat ones less: weights times the aspect ratio
// circumference / height, relative to its mean, to a small negative power. The contrary, making all
// ratios equal, makes cells uneven.
std::vector<double> evened_weights(const CoarseMap& solved,
                                   const Hierarchy::Level& level,
                                   double power) {
    const std::vector<MetricGraph::Edge>& edges = solved.map.graph.edges;
    const std::vector<FlatArea> parts = flat_areas(level, solved.map);
    std::vector<double> flat(edges.size(), 0.0);
    for (std::size_t t = 0; t < parts.size(); ++t) {
        const int v = level.flipped.half_edges.from_of(static_cast<int>(3 * t));
        flat[at(solved.map.graph_edge[at(v)])] += parts[t].flat;
    }
    std::vector<double> weights;
    double mean = 0.0;
    for (std::size_t e = 0; e < edges.size(); ++e) {
        const double h = edges[e].weight;
        weights.push_back(std::log(std::max(flat[e], 1e-12 * h * h) / (h * h)));
        mean += weights.back() / static_cast<double>(edges.size());
    }
    for (std::size_t e = 0; e < edges.size(); ++e) {
        weights[e] = edges[e].weight * std::exp(power * (weights[e] - mean));
    }
    return weights;
}

void check_weights(const std::vector<double>& weights, const MetricGraph& graph) {
    if (weights.size() != graph.edges.size()) {
        throw Error(ErrorKind::BadOption, "wrong-number-of-weights",
                    fmt::format("foliation.weights: {} given, but the surface has {} cylinders",
                                weights.size(), graph.edges.size()));
    }
}

// A candidate with both rules for its weights.
std::vector<CoarseMap> solve_candidate(const Hierarchy::Level& level,
                                       const PantsCandidate& candidate,
                                       const std::vector<double>& distance,
                                       const Context& context) {
    std::vector<CoarseMap> solved;
    GraphMap first = candidate.map;
    set_weights(first, lengths_of_parts(first, distance));
    solved.push_back(solve_one(level, std::move(first), MapStart::Cold, context));
    solved.back().name = candidate.name + ", weights by length";
    GraphMap second = solved.back().map;
    set_weights(second, std::vector<double>(second.graph.edges.size(), 1.0));
    solved.push_back(solve_one(level, std::move(second), MapStart::Warm, context));
    solved.back().name = candidate.name + ", equal weights";
    return solved;
}

// The best of a few steps from a solved map towards even cells. Going on for long would flatten
// short cylinders to nothing.
CoarseMap with_even_cells(const Hierarchy::Level& level,
                          const CoarseMap& start,
                          double power,
                          const Context& context) {
    CoarseMap best = start;
    CoarseMap last = start;
    for (int step = 0; step < kEveningSteps; ++step) {
        GraphMap map = last.map;
        set_weights(map, evened_weights(last, level, power));
        last = solve_one(level, std::move(map), MapStart::Warm, context);
        last.name = start.name + ", evened";
        if (!(last.score < best.score)) {
            break;
        }
        best = last;
    }
    return best;
}

// The same decompositions in the same order, with weights as given: the numbers of cylinders are
// then those that automatic weights report.
std::vector<CoarseMap> with_weights(const Hierarchy::Level& level,
                                    std::vector<CoarseMap> automatic,
                                    const std::vector<double>& weights,
                                    const Context& context) {
    for (const CoarseMap& map : automatic) {
        check_weights(weights, map.map.graph);
    }
    for_each_task(automatic.size(), context, [&](std::size_t i, const Context& own) {
        GraphMap map = std::move(automatic[i].map);
        set_weights(map, weights);
        std::string name = std::move(automatic[i].name);
        automatic[i] = solve_one(level, std::move(map), MapStart::Warm, own);
        automatic[i].name = std::move(name);
    });
    return automatic;
}

void keep_allowed(std::vector<CoarseMap>& maps, const CoarseOptions& options) {
    if (!options.is_allowed) {
        return;
    }
    maps.erase(std::remove_if(maps.begin(), maps.end(),
                              [&](const CoarseMap& map) { return !options.is_allowed(map.map); }),
               maps.end());
    if (maps.empty()) {
        throw Error(ErrorKind::SelfCheck, "none-allowed",
                    "every decomposition found has a cylinder that is forbidden");
    }
}

}  // namespace

std::vector<CoarseMap> solve_coarsest(const Hierarchy& hierarchy,
                                      const CoarseOptions& options,
                                      const Context& context) {
    const Hierarchy::Level& level = hierarchy.levels.back();
    Lines lines = lines_of(hierarchy, level);
    const std::vector<double> distance =
        path_lengths(level.rings, level.surface.mesh.positions,
                     lines.boundary.empty() ? std::vector<int>{0} : lines.boundary.front());
    const std::vector<PantsCandidate> candidates =
        candidates_of(level, std::move(lines), options, context);
    std::vector<std::vector<CoarseMap>> of_candidate(candidates.size());
    std::vector<std::string> failures(candidates.size());
    for_each_task(candidates.size(), context, [&](std::size_t i, const Context& own) {
        try {
            of_candidate[i] = solve_candidate(level, candidates[i], distance, own);
        } catch (const Error& error) {
            failures[i] = error.what();  // Others may do.
        }
    });
    std::vector<CoarseMap> all;
    for (std::vector<CoarseMap>& some : of_candidate) {
        std::move(some.begin(), some.end(), std::back_inserter(all));
    }
    std::stable_sort(all.begin(), all.end(),
                     [](const CoarseMap& a, const CoarseMap& b) { return a.score < b.score; });
    if (all.empty()) {
        throw Error(ErrorKind::SelfCheck, "no-map",
                    fmt::format("harmonic map: {}", fmt::join(failures, "; ")));
    }
    keep_allowed(all, options);
    {
        std::array<CoarseMap, kEveningPowers.size()> evened;
        for_each_task(evened.size(), context, [&](std::size_t i, const Context& own) {
            evened[i] = with_even_cells(level, all.front(), kEveningPowers[i], own);
        });
        for (CoarseMap& map : evened) {
            if (map.score < all.front().score) {
                all.insert(all.begin(), std::move(map));
            }
        }
    }
    if (options.weights) {
        return with_weights(level, std::move(all), *options.weights, context);
    }
    return all;
}

CoarseMap with_other_weights(const Hierarchy::Level& level,
                             const CoarseMap& start,
                             const std::vector<double>& weights,
                             const Context& context) {
    GraphMap map = start.map;
    set_weights(map, weights);
    CoarseMap solved = solve_one(level, std::move(map), MapStart::Warm, context);
    solved.name = start.name;
    return solved;
}

}  // namespace leafcutter::geometry
