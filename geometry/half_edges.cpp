#include "geometry/half_edges.h"

#include <algorithm>
#include <string>

#include "geometry/error.h"

namespace leafcutter::geometry {
namespace {

// Half-edges bucketed by the lower of their two vertices: start offsets and the sorted list.
struct Buckets {
    std::vector<int> start;
    std::vector<int> half_edges;
};

Buckets bucket_by_lower_vertex(const HalfEdges& edges, int vertex_count) {
    Buckets buckets;
    buckets.start.assign(static_cast<std::size_t>(vertex_count) + 1, 0);
    buckets.half_edges.resize(edges.from.size());
    const auto lower = [&](int h) {
        return static_cast<std::size_t>(std::min(edges.from_of(h), edges.to_of(h)));
    };
    for (int h = 0; h < edges.size(); ++h) {
        ++buckets.start[lower(h) + 1];
    }
    for (std::size_t v = 1; v < buckets.start.size(); ++v) {
        buckets.start[v] += buckets.start[v - 1];
    }
    std::vector<int> cursor(buckets.start.begin(), buckets.start.end() - 1);
    for (int h = 0; h < edges.size(); ++h) {
        buckets.half_edges[static_cast<std::size_t>(cursor[lower(h)]++)] = h;
    }
    return buckets;
}

[[noreturn]] void refuse_edge(const HalfEdges& edges, int h) {
    throw Error(ErrorKind::BadMesh, "non-manifold-edges",
                "edge " + std::to_string(edges.from_of(h)) + "-" + std::to_string(edges.to_of(h)) +
                    " has more than two triangles, or two of opposite orientation");
}

// Pairs `h` with its opposite among `candidates`, which share its lower vertex.
void pair_twin(HalfEdges& edges, int h, std::span<const int> candidates) {
    for (const int other : candidates) {
        if (edges.from_of(h) == edges.from_of(other) && edges.to_of(h) == edges.to_of(other)) {
            refuse_edge(edges, h);
        }
        if (edges.from_of(h) == edges.to_of(other) && edges.to_of(h) == edges.from_of(other)) {
            edges.twin[static_cast<std::size_t>(h)] = other;
            edges.twin[static_cast<std::size_t>(other)] = h;
        }
    }
}

}  // namespace

HalfEdges build_half_edges(std::span<const std::array<int, 3>> triangles, int vertex_count) {
    HalfEdges edges;
    edges.from.reserve(triangles.size() * 3);
    for (const auto& triangle : triangles) {
        edges.from.insert(edges.from.end(), triangle.begin(), triangle.end());
    }
    edges.twin.assign(edges.from.size(), -1);
    const Buckets buckets = bucket_by_lower_vertex(edges, vertex_count);
    const std::span<const int> all(buckets.half_edges);
    for (int v = 0; v < vertex_count; ++v) {
        const auto first = static_cast<std::size_t>(buckets.start[static_cast<std::size_t>(v)]);
        const auto last = static_cast<std::size_t>(buckets.start[static_cast<std::size_t>(v) + 1]);
        for (std::size_t i = first; i < last; ++i) {
            pair_twin(edges, buckets.half_edges[i], all.subspan(i + 1, last - i - 1));
        }
    }
    return edges;
}

std::vector<std::array<int, 3>> triangles_of(const HalfEdges& edges) {
    std::vector<std::array<int, 3>> triangles(edges.from.size() / 3);
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        for (std::size_t k = 0; k < 3; ++k) {
            triangles[t][k] = edges.from[3 * t + k];
        }
    }
    return triangles;
}

}  // namespace leafcutter::geometry
