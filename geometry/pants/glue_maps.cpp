#include "geometry/pants/glue_maps.h"

#include <cstddef>
#include <utility>

#include "geometry/loops/edge_paths.h"

namespace leafcutter::geometry {
namespace {

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

// Where an edge of a piece's graph goes in that of the whole: t there = offset + scale x t here.
struct NewPlace {
    Dart forward = -1;  // What its forward dart becomes.
    double offset = 0.0;
    double scale = 1.0;
};

class Gluer {
public:
    Gluer(std::size_t cuts, const VertexRings& rings) : rings_(rings) {
        map_.graph.edges.resize(cuts);
        const std::size_t vertices = rings.begin.size() - 1;
        map_.graph_edge.assign(vertices, -1);
        map_.t.assign(vertices, 0.0);
        map_.fixed.assign(vertices, 0);
        map_.words.resize(rings.edges.size());
    }

    void add(const MappedPiece& part) {
        const std::vector<NewPlace> places = place_edges(part);
        const auto is_on_cut = cut_vertices(part.piece);
        for (std::size_t v = 0; v < part.map.t.size(); ++v) {
            const NewPlace& place = places[at(part.map.graph_edge[v])];
            const std::size_t whole = at(part.piece.source_vertex[v]);
            map_.graph_edge[whole] = edge_of(place.forward);
            map_.t[whole] = place.offset + place.scale * part.map.t[v];
            map_.fixed[whole] = part.map.fixed[v];
            if (is_on_cut[v] != 0) {
                map_.fixed[whole] = 0;
            }
        }
        for (std::size_t e = 0; e < part.rings.edges.size(); ++e) {
            const int from = part.piece.source_vertex[at(part.rings.edges[e].from)];
            const int to = part.piece.source_vertex[at(part.rings.edges[e].to)];
            const std::size_t whole = at(find_edge(rings_, from, to));
            Word word;
            for (const Dart dart : part.map.words[e]) {
                const Dart forward = places[at(edge_of(dart))].forward;
                word.push_back(runs_forward(dart) ? forward : reversed(forward));
            }
            map_.words[whole] = rings_.edges[whole].from == from ? word : reversed(word);
        }
    }

    GraphMap take() { return std::move(map_); }

private:
    // Names the nodes and edges of one piece.
    std::vector<NewPlace> place_edges(const MappedPiece& part) {
        const MetricGraph& graph = part.map.graph;
        std::vector<int> cut_at(at(graph.nodes), -1);
        std::vector<char> is_left(at(graph.nodes), 0);
        for (std::size_t k = 0; k < part.piece.loops.size(); ++k) {
            const std::size_t v = at(part.piece.loops[k].front());
            const MetricGraph::Edge& edge = graph.edges[at(part.map.graph_edge[v])];
            const std::size_t node = at(part.map.t[v] < 0.5 ? edge.from : edge.to);
            cut_at[node] = part.piece.origins[k].cut;
            is_left[node] = part.piece.origins[k].left ? 1 : 0;
        }
        std::vector<int> name(at(graph.nodes), -1);
        for (std::size_t n = 0; n < name.size(); ++n) {
            if (cut_at[n] < 0) {
                name[n] = map_.graph.nodes++;
            }
        }
        std::vector<NewPlace> places;
        for (const MetricGraph::Edge& edge : graph.edges) {
            const bool ends_in_cut = cut_at[at(edge.to)] >= 0;
            if (!ends_in_cut && cut_at[at(edge.from)] < 0) {
                places.push_back({2 * static_cast<int>(map_.graph.edges.size()), 0.0, 1.0});
                map_.graph.edges.push_back({name[at(edge.from)], name[at(edge.to)], 1.0});
                continue;
            }
            const std::size_t end = at(ends_in_cut ? edge.to : edge.from);
            const int inner = name[at(ends_in_cut ? edge.from : edge.to)];
            MetricGraph::Edge& glued = map_.graph.edges[at(cut_at[end])];
            (is_left[end] != 0 ? glued.from : glued.to) = inner;
            places.push_back(half_of(cut_at[end], is_left[end] != 0, ends_in_cut));
        }
        return places;
    }

    // A leg of the left side is the first half of the glued edge.
    static NewPlace half_of(int cut, bool is_left, bool ends_in_cut) {
        const bool with = is_left == ends_in_cut;  // The leg runs as the glued edge does.
        const double start = is_left ? 0.0 : 0.5;
        return {2 * cut + (with ? 0 : 1), with ? start : start + 0.5, with ? 0.5 : -0.5};
    }

    static std::vector<char> cut_vertices(const CutPiece& piece) {
        std::vector<char> on_cut(piece.source_vertex.size(), 0);
        for (std::size_t k = 0; k < piece.loops.size(); ++k) {
            for (const int v : piece.loops[k]) {
                on_cut[at(v)] = piece.origins[k].cut >= 0 ? 1 : 0;
            }
        }
        return on_cut;
    }

    const VertexRings& rings_;
    GraphMap map_;
};

}  // namespace

GraphMap glue_maps(std::span<const MappedPiece> pieces,
                   std::size_t cuts,
                   const VertexRings& rings) {
    Gluer gluer(cuts, rings);
    for (const MappedPiece& piece : pieces) {
        gluer.add(piece);
    }
    return gluer.take();
}

}  // namespace leafcutter::geometry
