#include "geometry/pants/prong_places.h"

#include <algorithm>
#include <cstddef>
#include <optional>

#include "geometry/pants/tree_triangle.h"

namespace leafcutter::geometry {
namespace {

// Points keep this part of a triangle away from its sides, as where the surface is sliced.
constexpr double kFromSide = 0.05;

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

// A triangle and the ways along its sides.
struct Sides {
    std::array<int, 3> corners{};
    Word ab;
    Word bc;
    Word ac;
};

Word way_along(const Hierarchy::Level& level, const GraphMap& map, int half_edge) {
    const VertexRings& rings = level.flipped.rings;
    const std::size_t edge = at(rings.edge_of_half_edge[at(half_edge)]);
    const bool forward = rings.edges[edge].from == level.flipped.half_edges.from_of(half_edge);
    return forward ? map.words[edge] : reversed(map.words[edge]);
}

// From vertex `v` along `way`, as far as its dart number `end`, not included.
double length_of_start(const GraphMap& map, int v, const Word& way, std::size_t end) {
    double length = map.remaining(v, way.front());
    for (std::size_t k = 1; k < end; ++k) {
        length += map.weight(edge_of(way[k]));
    }
    return length;
}

// Distances of the corners from the node where their three ways meet, if they meet in one.
std::optional<std::array<double, 3>> distances_from_node(const GraphMap& map, const Sides& sides) {
    if (sides.ab.empty() || sides.ac.empty() || sides.bc.empty()) {
        return std::nullopt;
    }
    const int shared = shared_darts(sides.ab, sides.bc, sides.ac);
    if (shared <= 0 || at(shared) == sides.ab.size() || at(shared) == sides.ac.size()) {
        return std::nullopt;
    }
    const auto [a, b, c] = sides.corners;
    return std::array{length_of_start(map, a, sides.ab, at(shared)),
                      length_of_start(map, b, reversed(sides.ab), sides.ab.size() - at(shared)),
                      length_of_start(map, c, reversed(sides.ac), sides.ac.size() - at(shared))};
}

}  // namespace

std::vector<ProngPlace> prong_places(const Hierarchy::Level& level, const GraphMap& map) {
    std::vector<ProngPlace> places;
    const HalfEdges& edges = level.flipped.half_edges;
    for (int h = 0; h < edges.size(); h += 3) {
        const Sides sides{{edges.from_of(h), edges.from_of(h + 1), edges.from_of(h + 2)},
                          way_along(level, map, h),
                          way_along(level, map, h + 1),
                          reversed(way_along(level, map, h + 2))};
        const auto distances = distances_from_node(map, sides);
        if (!distances) {
            continue;
        }
        const double longest = *std::max_element(distances->begin(), distances->end());
        ProngPlace place{sides.corners, Eigen::Vector3d::Zero()};
        double sum = 0.0;
        for (std::size_t k = 0; k < 3; ++k) {
            const double share = 1.0 / std::max((*distances)[k], kFromSide * longest);
            sum += share;
            place.position += share * level.surface.mesh.positions[at(sides.corners[k])];
        }
        place.position /= sum;
        places.push_back(place);
    }
    return places;
}

}  // namespace leafcutter::geometry
