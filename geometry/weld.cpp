#include "geometry/weld.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "geometry/disjoint_sets.h"
#include "geometry/error.h"

namespace leafcutter::geometry {

namespace {

// Text exports keep six or seven digits.
constexpr double kWeldTolerance = 1e-6;  // Of the diagonal of the open edges' bounding box.

using Places = std::vector<std::uint32_t>;  // Per vertex: the least vertex at its position.

bool is_degenerate(const Triangle& t) {
    return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
}

std::vector<std::uint32_t> open_sides(std::span<const Triangle> triangles) {
    std::vector<std::uint32_t> open;
    for_each_edge(sorted_sides(triangles), [&](std::span<const Side> sides) {
        if (sides.size() == 1) {
            open.push_back(sides[0].index);
        }
    });
    return open;
}

std::vector<std::uint32_t> end_points(std::span<const Triangle> triangles,
                                      std::span<const std::uint32_t> sides) {
    std::vector<std::uint32_t> vertices;
    vertices.reserve(2 * sides.size());
    for (const std::uint32_t side : sides) {
        vertices.push_back(side_start(triangles, side));
        vertices.push_back(side_end(triangles, side));
    }
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    return vertices;
}

Places own_places(std::size_t count) {
    Places places(count);
    for (std::uint32_t vertex = 0; vertex < count; ++vertex) {
        places[vertex] = vertex;
    }
    return places;
}

Places exact_places(std::span<const Eigen::Vector3d> positions,
                    std::vector<std::uint32_t> vertices) {
    const auto less = [&](std::uint32_t a, std::uint32_t b) {
        const Eigen::Vector3d& p = positions[a];
        const Eigen::Vector3d& q = positions[b];
        for (int axis = 0; axis < 3; ++axis) {
            if (p[axis] != q[axis]) {
                return p[axis] < q[axis];
            }
        }
        return a < b;
    };
    std::sort(vertices.begin(), vertices.end(), less);
    Places places = own_places(positions.size());
    for (std::size_t i = 1; i < vertices.size(); ++i) {
        if (positions[vertices[i]] == positions[vertices[i - 1]]) {
            places[vertices[i]] = places[vertices[i - 1]];
        }
    }
    return places;
}

// A grid over the bounding box whose cells are twice the tolerance wide: what is near a point lies
// in its cell or in the neighbours towards which the point leans.
class NearGrid {
public:
    NearGrid(std::span<const Eigen::Vector3d> positions, std::span<const std::uint32_t> vertices);

    bool has_extent() const { return tolerance_ > 0.0; }
    Places clusters() const;  // Needs an extent.

private:
    using Cell = std::array<std::int64_t, 3>;
    Cell cell_of(const Eigen::Vector3d& p, const Eigen::Vector3d& shift) const;
    static std::uint64_t key_of(const Cell& cell);
    void unite_with_cell(std::uint32_t vertex, std::uint64_t key, DisjointSets& sets) const;

    std::span<const Eigen::Vector3d> positions_;
    std::span<const std::uint32_t> vertices_;
    Eigen::Vector3d origin_;
    double tolerance_ = 0.0;
    std::vector<std::pair<std::uint64_t, std::uint32_t>> cells_;  // Sorted.
};

NearGrid::NearGrid(std::span<const Eigen::Vector3d> positions,
                   std::span<const std::uint32_t> vertices)
    : positions_(positions), vertices_(vertices) {
    Eigen::Vector3d low = positions[vertices[0]];
    Eigen::Vector3d high = low;
    for (const std::uint32_t vertex : vertices) {
        low = low.cwiseMin(positions[vertex]);
        high = high.cwiseMax(positions[vertex]);
    }
    origin_ = low;
    tolerance_ = kWeldTolerance * (high - low).norm();
    for (const std::uint32_t vertex : has_extent() ? vertices : vertices.first(0)) {
        cells_.emplace_back(key_of(cell_of(positions[vertex], Eigen::Vector3d::Zero())), vertex);
    }
    std::sort(cells_.begin(), cells_.end());
}

NearGrid::Cell NearGrid::cell_of(const Eigen::Vector3d& p, const Eigen::Vector3d& shift) const {
    Cell cell;
    for (int axis = 0; axis < 3; ++axis) {
        const double steps = (p[axis] + shift[axis] - origin_[axis]) / (2.0 * tolerance_);
        cell[static_cast<std::size_t>(axis)] = static_cast<std::int64_t>(std::floor(steps)) + 1;
    }
    return cell;
}

std::uint64_t NearGrid::key_of(const Cell& cell) {
    // At most 1 / (2 * kWeldTolerance) cells an axis fit 21 bits.
    constexpr unsigned kAxisBits = 21;
    std::uint64_t key = 0;
    for (const std::int64_t step : cell) {
        key = (key << kAxisBits) | static_cast<std::uint64_t>(step);
    }
    return key;
}

void NearGrid::unite_with_cell(std::uint32_t vertex, std::uint64_t key, DisjointSets& sets) const {
    auto it = std::lower_bound(cells_.begin(), cells_.end(), std::pair(key, std::uint32_t{0}));
    // A crowded cell is one cluster anyway, so its first few members do.
    constexpr int kEnough = 32;
    for (int seen = 0; it != cells_.end() && it->first == key && seen < kEnough; ++it, ++seen) {
        if ((positions_[it->second] - positions_[vertex]).norm() <= tolerance_) {
            sets.unite(it->second, vertex);
        }
    }
}

Places NearGrid::clusters() const {
    DisjointSets sets(positions_.size());
    for (const std::uint32_t vertex : vertices_) {
        for (int octant = 0; octant < 8; ++octant) {
            Eigen::Vector3d shift;
            for (int axis = 0; axis < 3; ++axis) {
                const bool up = ((octant >> axis) & 1) != 0;
                shift[axis] = up ? tolerance_ : -tolerance_;
            }
            unite_with_cell(vertex, key_of(cell_of(positions_[vertex], shift)), sets);
        }
    }
    Places places = own_places(positions_.size());
    for (const std::uint32_t vertex : vertices_) {
        places[vertex] = sets.find(vertex);
    }
    return places;
}

// The open sides that join two different places, grouped by these places.
std::vector<Side> sides_between_places(std::span<const Triangle> triangles,
                                       std::span<const std::uint32_t> open,
                                       const Places& places) {
    std::vector<Side> sides;
    sides.reserve(open.size());
    for (const std::uint32_t side : open) {
        const std::uint32_t from = places[side_start(triangles, side)];
        const std::uint32_t to = places[side_end(triangles, side)];
        if (from != to) {
            sides.push_back({edge_key(from, to), side});
        }
    }
    std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
        return a.edge != b.edge ? a.edge < b.edge : a.index < b.index;
    });
    return sides;
}

using SidePair = std::pair<std::uint32_t, std::uint32_t>;

// Unites the ends of two open sides that lie at the same two places.
void unite_sides(std::span<const Triangle> triangles,
                 const Places& places,
                 const SidePair& sides,
                 DisjointSets& sets) {
    const std::uint32_t a = side_start(triangles, sides.first);
    const std::uint32_t b = side_end(triangles, sides.first);
    const std::uint32_t c = side_start(triangles, sides.second);
    const std::uint32_t d = side_end(triangles, sides.second);
    const bool head_to_tail = places[a] == places[d];
    sets.unite(a, head_to_tail ? d : c);
    sets.unite(b, head_to_tail ? c : d);
}

// Tells a slit from a seam. A boundary that lies on itself all along is a slit made on purpose, as
// between the lips of a face, if its surface has other boundaries; on a surface that would be
// closed without it, it is a seam of the file. Seams between boundaries, or along a part of one,
// are always seams.
class Slits {
public:
    Slits(std::span<const Triangle> triangles,
          std::span<const std::uint32_t> open,
          std::size_t vertices)
        : triangles_(triangles), boundaries_(vertices), pieces_(vertices), loops_(vertices) {
        for (const std::uint32_t side : open) {
            boundaries_.unite(side_start(triangles, side), side_end(triangles, side));
        }
        for (const Triangle& t : triangles) {
            pieces_.unite(t[0], t[1]);
            pieces_.unite(t[0], t[2]);
        }
        for (const std::uint32_t side : open) {
            ++loop_of(side).unmatched;
        }
    }

    // Removes the pairs that would close a slit; returns how many slits there are.
    std::size_t remove_from(std::vector<SidePair>& pairs, std::span<const std::uint32_t> open);

private:
    struct Loop {
        std::size_t unmatched = 0;
        bool alone = true;  // Matched with itself only.
        bool counted = false;
    };
    Loop& loop_of(std::uint32_t side) {
        return loops_[boundaries_.find(side_start(triangles_, side))];
    }
    std::uint32_t piece_of(std::uint32_t side) {
        return pieces_.find(side_start(triangles_, side));
    }
    void match(const std::vector<SidePair>& pairs);

    std::span<const Triangle> triangles_;
    DisjointSets boundaries_;  // Of vertices, joined along open sides.
    DisjointSets pieces_;      // Of vertices, joined by faces.
    std::vector<Loop> loops_;  // By representative in boundaries_.
};

void Slits::match(const std::vector<SidePair>& pairs) {
    std::vector<char> matched(3 * triangles_.size(), 0);
    for (const SidePair& pair : pairs) {
        for (const std::uint32_t side : {pair.first, pair.second}) {
            loop_of(side).unmatched -= matched[side] == 0 ? 1 : 0;
            matched[side] = 1;
        }
        if (&loop_of(pair.first) != &loop_of(pair.second)) {
            loop_of(pair.first).alone = false;
            loop_of(pair.second).alone = false;
            pieces_.unite(side_start(triangles_, pair.first), side_start(triangles_, pair.second));
        }
    }
}

std::size_t Slits::remove_from(std::vector<SidePair>& pairs, std::span<const std::uint32_t> open) {
    match(pairs);
    std::vector<char> stays_open(loops_.size(), 0);  // By representative in pieces_.
    for (const std::uint32_t side : open) {
        if (loop_of(side).unmatched > 0) {
            stays_open[piece_of(side)] = 1;
        }
    }
    std::size_t slits = 0;
    std::erase_if(pairs, [&](const SidePair& pair) {
        Loop& loop = loop_of(pair.first);
        const bool is_slit =
            loop.alone && loop.unmatched == 0 && stays_open[piece_of(pair.first)] != 0;
        slits += is_slit && !loop.counted ? 1 : 0;
        loop.counted = loop.counted || is_slit;
        return is_slit;
    });
    return slits;
}

std::size_t drop_degenerate(std::vector<Triangle>& triangles) {
    return std::erase_if(triangles, is_degenerate);
}

// Drops lone triangles, all three sides open, that have two corners at one place or lie exactly on
// another lone one: in a file without shared vertices that is how such faces look.
void drop_lone_faces(const Places& places, std::vector<Triangle>& triangles, WeldResult& result) {
    std::vector<int> open_count(triangles.size(), 0);
    for (const std::uint32_t side : open_sides(triangles)) {
        ++open_count[side / 3];
    }
    std::vector<std::pair<Triangle, std::uint32_t>> lone;  // Sorted places, face.
    std::vector<char> dropped(triangles.size(), 0);
    for (std::uint32_t face = 0; face < triangles.size(); ++face) {
        if (open_count[face] != 3) {
            continue;
        }
        Triangle key;
        std::transform(triangles[face].begin(), triangles[face].end(), key.begin(),
                       [&](std::uint32_t vertex) { return places[vertex]; });
        std::sort(key.begin(), key.end());
        if (is_degenerate(key)) {
            dropped[face] = 1;
            ++result.degenerate_faces;
        } else {
            lone.emplace_back(key, face);
        }
    }
    std::sort(lone.begin(), lone.end());
    for (std::size_t i = 1; i < lone.size(); ++i) {
        if (lone[i].first == lone[i - 1].first) {
            dropped[lone[i].second] = 1;
            ++result.duplicate_faces;
        }
    }
    std::size_t kept = 0;
    for (std::size_t face = 0; face < triangles.size(); ++face) {
        if (dropped[face] == 0) {
            triangles[kept++] = triangles[face];
        }
    }
    triangles.resize(kept);
}

void apply(DisjointSets& sets, std::vector<Triangle>& triangles) {
    for (Triangle& triangle : triangles) {
        for (std::uint32_t& vertex : triangle) {
            vertex = sets.find(vertex);
        }
    }
}

void weld_exactly(std::span<const Eigen::Vector3d> positions,
                  std::vector<Triangle>& triangles,
                  DisjointSets& sets,
                  WeldResult& result) {
    std::vector<std::uint32_t> open = open_sides(triangles);
    if (open.empty()) {
        return;
    }
    const Places places = exact_places(positions, end_points(triangles, open));
    const std::size_t before = triangles.size();
    drop_lone_faces(places, triangles, result);
    if (triangles.size() != before) {
        open = open_sides(triangles);
    }
    std::vector<SidePair> pairs;
    for_each_edge(sides_between_places(triangles, open, places), [&](std::span<const Side> sides) {
        for (std::size_t i = 1; i < sides.size(); ++i) {
            pairs.emplace_back(sides[0].index, sides[i].index);
        }
    });
    result.slits = Slits(triangles, open, positions.size()).remove_from(pairs, open);
    for (const SidePair& pair : pairs) {
        unite_sides(triangles, places, pair, sets);
    }
    apply(sets, triangles);
    result.degenerate_faces += drop_degenerate(triangles);
}

void weld_nearly(std::span<const Eigen::Vector3d> positions,
                 std::vector<Triangle>& triangles,
                 DisjointSets& sets,
                 WeldResult& result) {
    const std::vector<std::uint32_t> open = open_sides(triangles);
    if (open.empty()) {
        return;
    }
    const std::vector<std::uint32_t> vertices = end_points(triangles, open);
    const NearGrid grid(positions, vertices);
    if (!grid.has_extent()) {
        return;
    }
    const Places places = grid.clusters();
    std::vector<SidePair> pairs;
    for_each_edge(sides_between_places(triangles, open, places), [&](std::span<const Side> sides) {
        const bool head_to_tail =
            sides.size() == 2 && places[side_start(triangles, sides[0].index)] ==
                                     places[side_end(triangles, sides[1].index)];
        if (head_to_tail) {
            pairs.emplace_back(sides[0].index, sides[1].index);
        }
    });
    result.slits = Slits(triangles, open, positions.size()).remove_from(pairs, open);
    if (pairs.empty()) {
        return;
    }
    DisjointSets trial = sets;
    for (const SidePair& pair : pairs) {
        unite_sides(triangles, places, pair, trial);
    }
    std::vector<Triangle> welded = triangles;
    apply(trial, welded);
    const std::size_t dropped = drop_degenerate(welded);
    if (count_non_manifold_edges(welded) <= count_non_manifold_edges(triangles)) {
        triangles = std::move(welded);
        sets = std::move(trial);
        result.degenerate_faces += dropped;
    }
}

void contract_null_edges(std::span<const Eigen::Vector3d> positions,
                         std::vector<Triangle>& triangles,
                         DisjointSets& sets,
                         WeldResult& result) {
    std::pair<std::uint32_t, std::uint32_t> first;
    std::size_t found = 0;
    for (std::uint32_t side = 0; side < 3 * triangles.size(); ++side) {
        const std::uint32_t a = side_start(triangles, side);
        const std::uint32_t b = side_end(triangles, side);
        if (positions[a] == positions[b] && sets.unite(a, b) && found++ == 0) {
            first = {a, b};
        }
    }
    if (found == 0) {
        return;
    }
    const std::size_t before = count_non_manifold_edges(triangles);
    apply(sets, triangles);
    result.degenerate_faces += drop_degenerate(triangles);
    if (count_non_manifold_edges(triangles) > before) {
        throw Error(
            ErrorKind::BadMesh, "degenerate",
            fmt::format("{} edges have length 0 and can't be contracted without tearing the "
                        "surface, first between vertices {} and {} (counted from 0); merge "
                        "them in a mesh editor",
                        found, first.first, first.second));
    }
}

}  // namespace

WeldResult weld(std::span<const Eigen::Vector3d> positions, std::vector<Triangle>& triangles) {
    WeldResult result;
    DisjointSets sets(positions.size());
    weld_exactly(positions, triangles, sets, result);
    weld_nearly(positions, triangles, sets, result);
    contract_null_edges(positions, triangles, sets, result);
    result.representative.resize(positions.size());
    for (std::uint32_t vertex = 0; vertex < positions.size(); ++vertex) {
        result.representative[vertex] = sets.find(vertex);
        result.welded_vertices += result.representative[vertex] != vertex ? 1 : 0;
    }
    return result;
}

}  // namespace leafcutter::geometry
