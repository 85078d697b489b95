#include "geometry/loops/cut_along.h"

#include <cstddef>
#include <cstdint>

#include "geometry/disjoint_sets.h"
#include "geometry/half_edges.h"

namespace leafcutter::geometry {
namespace {

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

class Cutter {
public:
    Cutter(std::span<const std::array<int, 3>> triangles,
           int vertex_count,
           std::span<const std::vector<int>> boundary_loops,
           std::span<const std::vector<int>> cuts)
        : triangles_(triangles),
          edges_(build_half_edges(triangles, vertex_count)),
          boundary_of_(at(vertex_count), -1),
          cut_of_(at(vertex_count), -1),
          next_(at(vertex_count), -1) {
        for (std::size_t k = 0; k < boundary_loops.size(); ++k) {
            for (const int v : boundary_loops[k]) {
                boundary_of_[at(v)] = static_cast<int>(k);
            }
        }
        for (std::size_t k = 0; k < cuts.size(); ++k) {
            for (std::size_t i = 0; i < cuts[k].size(); ++i) {
                cut_of_[at(cuts[k][i])] = static_cast<int>(k);
                next_[at(cuts[k][i])] = cuts[k][(i + 1) % cuts[k].size()];
            }
        }
    }

    std::vector<CutPiece> cut() {
        part();
        std::vector<CutPiece> pieces;
        std::vector<int> piece_of(triangles_.size(), -1);    // Per representative triangle.
        std::vector<int> vertex_of(edges_.from.size(), -1);  // Per representative corner.
        std::vector<std::vector<int>> half_edges;            // Per piece and triangle: its first.
        for (std::size_t t = 0; t < triangles_.size(); ++t) {
            int& number = piece_of[triangle_sets_.find(static_cast<std::uint32_t>(t))];
            if (number < 0) {
                number = static_cast<int>(pieces.size());
                pieces.emplace_back();
                half_edges.emplace_back();
            }
            CutPiece& piece = pieces[at(number)];
            std::array<int, 3> corners{};
            for (std::size_t k = 0; k < 3; ++k) {
                int& v = vertex_of[corner_sets_.find(static_cast<std::uint32_t>(3 * t + k))];
                if (v < 0) {
                    v = static_cast<int>(piece.source_vertex.size());
                    piece.source_vertex.push_back(triangles_[t][k]);
                }
                corners[k] = v;
            }
            piece.triangles.push_back(corners);
            half_edges[at(number)].push_back(static_cast<int>(3 * t));
        }
        for (std::size_t k = 0; k < pieces.size(); ++k) {
            find_loops(pieces[k], half_edges[k]);
        }
        return pieces;
    }

private:
    bool is_cut(int half_edge) const {
        const int a = edges_.from_of(half_edge);
        const int b = edges_.to_of(half_edge);
        return cut_of_[at(a)] >= 0 && (next_[at(a)] == b || next_[at(b)] == a);
    }

    // Joins triangles, and their corners at a vertex, across all edges that aren't cut.
    void part() {
        triangle_sets_ = DisjointSets(triangles_.size());
        corner_sets_ = DisjointSets(edges_.from.size());
        for (int h = 0; h < edges_.size(); ++h) {
            const int twin = edges_.twin_of(h);
            if (twin < 0 || is_cut(h)) {
                continue;
            }
            triangle_sets_.unite(static_cast<std::uint32_t>(h / 3),
                                 static_cast<std::uint32_t>(twin / 3));
            corner_sets_.unite(static_cast<std::uint32_t>(h),
                               static_cast<std::uint32_t>(HalfEdges::next(twin)));
        }
    }

    void find_loops(CutPiece& piece, const std::vector<int>& first_half_edge) const {
        const int count = static_cast<int>(piece.source_vertex.size());
        const HalfEdges own = build_half_edges(piece.triangles, count);
        int boundary_edges = 0;
        std::vector<int> leaving(at(count), -1);  // Per boundary vertex: its boundary half-edge.
        for (int h = 0; h < own.size(); ++h) {
            if (own.twin_of(h) < 0) {
                leaving[at(own.from_of(h))] = h;
                ++boundary_edges;
            }
        }
        const int edges = (own.size() + boundary_edges) / 2;
        piece.euler = count - edges + static_cast<int>(piece.triangles.size());
        for (int v = 0; v < count; ++v) {
            if (leaving[at(v)] < 0) {
                continue;
            }
            const int h = leaving[at(v)];
            piece.origins.push_back(origin_of(first_half_edge[at(h / 3)] + h % 3));
            std::vector<int> loop;
            for (int w = v; leaving[at(w)] >= 0;) {
                loop.push_back(w);
                const int to = own.to_of(leaving[at(w)]);
                leaving[at(w)] = -1;
                w = to;
            }
            piece.loops.push_back(std::move(loop));
        }
    }

    LoopOrigin origin_of(int half_edge) const {
        const int from = edges_.from_of(half_edge);
        if (edges_.twin_of(half_edge) < 0) {
            return {boundary_of_[at(from)], -1, false};
        }
        return {-1, cut_of_[at(from)], next_[at(from)] == edges_.to_of(half_edge)};
    }

    std::span<const std::array<int, 3>> triangles_;
    HalfEdges edges_;
    std::vector<int> boundary_of_;  // Per vertex.
    std::vector<int> cut_of_;
    std::vector<int> next_;  // Along its cut.
    DisjointSets triangle_sets_{0};
    DisjointSets corner_sets_{0};
};

}  // namespace

std::vector<CutPiece> cut_along(std::span<const std::array<int, 3>> triangles,
                                int vertex_count,
                                std::span<const std::vector<int>> boundary_loops,
                                std::span<const std::vector<int>> cuts) {
    return Cutter(triangles, vertex_count, boundary_loops, cuts).cut();
}

}  // namespace leafcutter::geometry
