// Collapses of half-edges v -> u: v and its two triangles go, its other neighbours are joined to u.
//
// After H. Hoppe, "Progressive meshes", 1996, and Dey et al., "Topology preserving edge
// contraction", 1999 (the link condition), in passes over independent sets.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "geometry/pants/level.h"

namespace leafcutter::geometry {
namespace {

// More neighbours than this in all and the merged vertex would be a hub.
constexpr int kMostNeighbours = 16;
// A closed line of fewer edges isn't simplicial.
constexpr int kLeastLine = 3;
// Passes that remove less than this part of the vertices are not worth repeating.
constexpr double kSlowPass = 0.03;
constexpr double kLastPass = 0.002;
constexpr int kCheckEvery = 4096;
// 2 x area over squared edges below which a triangle has no direction.
constexpr double kFlat = 1e-9;

// What a collapse may do to triangles. The surface may be one of flipped edges, folded here and
// there in space, so the limits give way when they stop progress.
struct Limits {
    double least_cosine;  // Between a triangle's normal before and after.
    double worst_shape;   // Sum of squared edges over 2 x area: 3.5 at best.
    double visited;       // Part of the vertices a pass looks at, shortest edges first.
};
constexpr std::array<Limits, 4> kLimits{{{0.3, 60.0, 0.6},
                                         {0.1, 60.0, 0.6},
                                         {-2.0, 60.0, 1.0},
                                         {-2.0, std::numeric_limits<double>::infinity(), 1.0}}};

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

struct Side {  // Half-edge 3t + k as in HalfEdges, both of its values in one place.
    int from = -1;
    int twin = -1;
};

struct RingEntry {
    int neighbour = 0;
    int half_edge = 0;  // Out of the middle, in the triangle before the next neighbour; -1: a gap.
};

class Collapser {
public:
    Collapser(const LinedSurface& fine, const CoarsenOptions& options, const Context& context);
    Coarser run();

private:
    struct Choice {
        std::size_t slot = 0;  // Of ring_.
        double shape = std::numeric_limits<double>::infinity();
    };

    int next_from(int h) const { return sides_[at(HalfEdges::next(h))].from; }
    int apex(int h) const { return sides_[at(HalfEdges::previous(h))].from; }
    bool on_boundary(int v) const { return sides_[at(out_[at(v)])].twin < 0; }
    bool on_line(int v) const { return line_[at(v)] >= 0 || on_boundary(v); }

    std::vector<std::pair<float, int>> shortest_first(double part) const;
    int pass(const Limits& limits);
    void look(int v);
    bool may_go(int v) const;
    bool is_line_slot(int v, std::size_t slot) const;
    double worst_shape(std::size_t slot, const Limits& limits, double give_up) const;
    bool keeps_topology(int v, std::size_t slot) const;
    bool keeps_lines(int v, std::size_t slot) const;
    bool keeps_apex(int apex) const;
    void collapse(int v, std::size_t slot);
    int close_triangle(int h, int kept);
    Coarser compact();

    const LinedSurface& fine_;
    const CoarsenOptions& options_;
    const Context& context_;
    const std::vector<Eigen::Vector3d>& positions_;
    const std::vector<int>& line_;
    std::vector<Side> sides_;
    std::vector<int> out_;     // A half-edge out of each vertex: a boundary one's own first.
    std::vector<int> degree_;  // Neighbours; 0: gone.
    std::vector<int> parent_;  // What a vertex was collapsed to, itself if it is there.
    std::vector<int> line_size_;
    std::vector<int> locked_;               // Number of the pass in which its neighbours changed.
    std::vector<int> mark_;                 // Number of the look at which it was a neighbour.
    std::vector<RingEntry> ring_;           // Of the vertex looked at, counter-clockwise.
    std::vector<Eigen::Vector3d> normals_;  // Per slot of ring_: twice the area vector.
    bool closed_ = true;                    // ring_ goes on from its end to its start.
    int pass_ = 0;
    int looks_ = 0;
    std::size_t left_ = 0;  // Vertices.
};

Collapser::Collapser(const LinedSurface& fine,
                     const CoarsenOptions& options,
                     const Context& context)
    : fine_(fine),
      options_(options),
      context_(context),
      positions_(fine.mesh.positions),
      line_(fine.line_of_vertex) {
    const std::size_t count = positions_.size();
    const HalfEdges edges = build_half_edges(fine.mesh.triangles, static_cast<int>(count));
    sides_.resize(edges.from.size());
    out_.assign(count, -1);
    degree_.assign(count, 0);
    for (int h = 0; h < edges.size(); ++h) {
        sides_[at(h)] = {edges.from_of(h), edges.twin_of(h)};
        int& out = out_[at(edges.from_of(h))];
        out = out < 0 || edges.twin_of(h) < 0 ? h : out;
        ++degree_[at(edges.from_of(h))];
        degree_[at(edges.to_of(h))] += edges.twin_of(h) < 0 ? 1 : 0;
    }
    for (std::size_t v = 0; v < count; ++v) {
        parent_.push_back(static_cast<int>(v));
        if (line_[v] >= 0) {
            line_size_.resize(std::max(line_size_.size(), at(line_[v]) + 1), 0);
            ++line_size_[at(line_[v])];
        }
    }
    locked_.assign(count, 0);
    mark_.assign(count, 0);
    left_ = count;
}

// Vertices by the mean square of their edges.
std::vector<std::pair<float, int>> Collapser::shortest_first(double part) const {
    std::vector<float> sum(positions_.size(), 0.0F);
    std::vector<int> edges(positions_.size(), 0);
    for (std::size_t h = 0; h < sides_.size(); ++h) {
        const int from = sides_[h].from;
        if (from >= 0) {
            const int to = next_from(static_cast<int>(h));
            sum[at(from)] +=
                static_cast<float>((positions_[at(to)] - positions_[at(from)]).squaredNorm());
            ++edges[at(from)];
        }
    }
    std::vector<std::pair<float, int>> order;
    order.reserve(left_);
    for (std::size_t v = 0; v < sum.size(); ++v) {
        if (edges[v] > 0) {
            order.emplace_back(sum[v] / static_cast<float>(edges[v]), static_cast<int>(v));
        }
    }
    const auto wanted = static_cast<std::size_t>(part * static_cast<double>(order.size()));
    if (wanted < order.size()) {
        std::nth_element(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(wanted),
                         order.end());
        order.resize(wanted);
    }
    std::sort(order.begin(), order.end());
    return order;
}

void Collapser::look(int v) {
    ring_.clear();
    ++looks_;
    const int start = out_[at(v)];
    int h = start;
    closed_ = true;
    do {
        ring_.push_back({next_from(h), h});
        const int last = HalfEdges::previous(h);
        h = sides_[at(last)].twin;
        if (h < 0) {
            ring_.push_back({sides_[at(last)].from, -1});
            closed_ = false;
        }
    } while (h >= 0 && h != start);
    normals_.clear();
    for (std::size_t k = 0; k < ring_.size(); ++k) {
        mark_[at(ring_[k].neighbour)] = looks_;
        if (ring_[k].half_edge >= 0) {
            const Eigen::Vector3d& left = positions_[at(ring_[k].neighbour)];
            const Eigen::Vector3d& right = positions_[at(ring_[(k + 1) % ring_.size()].neighbour)];
            normals_.emplace_back((left - positions_[at(v)]).cross(right - positions_[at(v)]));
        }
    }
}

// Line vertices go if their line has enough others and passes straight through them.
bool Collapser::may_go(int v) const {
    if (!on_line(v)) {
        return true;
    }
    const int line = line_[at(v)];
    if (line < 0 || line_size_[at(line)] <= std::max(options_.least_line_vertices, kLeastLine)) {
        return false;
    }
    int along = 0;
    for (std::size_t k = 0; k < ring_.size(); ++k) {
        along += is_line_slot(v, k) ? 1 : 0;
    }
    return along == 2;
}

bool Collapser::is_line_slot(int v, std::size_t slot) const {
    if (line_[at(v)] < 0 || line_[at(ring_[slot].neighbour)] != line_[at(v)]) {
        return false;
    }
    return closed_ || slot == 0 || slot + 1 == ring_.size();
}

// The worst triangle after the collapse to ring slot `slot`; infinity if one is against the limits.
double Collapser::worst_shape(std::size_t slot, const Limits& limits, double give_up) const {
    constexpr double kNo = std::numeric_limits<double>::infinity();
    const std::size_t count = ring_.size();
    const Eigen::Vector3d& u = positions_[at(ring_[slot].neighbour)];
    double worst = 0.0;
    for (std::size_t k = 0; k < normals_.size(); ++k) {
        const std::size_t after = k + 1 == count ? 0 : k + 1;
        if (k == slot || after == slot) {
            continue;
        }
        const Eigen::Vector3d left = positions_[at(ring_[k].neighbour)] - u;
        const Eigen::Vector3d right = positions_[at(ring_[after].neighbour)] - u;
        const Eigen::Vector3d normal = left.cross(right);
        const double size = normal.norm();
        const double squares =
            left.squaredNorm() + right.squaredNorm() + (right - left).squaredNorm();
        worst = std::max(worst, squares / std::max(size, kFlat * squares));
        if (worst > limits.worst_shape || worst >= give_up) {
            return kNo;
        }
        const double old_size = normals_[k].norm();
        if (old_size > kFlat * squares &&
            normal.dot(normals_[k]) < limits.least_cosine * size * old_size) {
            return kNo;
        }
    }
    return worst;
}

// A vertex that loses a neighbour keeps a ring.
bool Collapser::keeps_apex(int apex) const {
    return degree_[at(apex)] >= (on_boundary(apex) ? 3 : 4);
}

// The link condition: v and u share the two corners facing their edge (one on the boundary) and
// nothing else.
bool Collapser::keeps_topology(int v, std::size_t slot) const {
    const int u = ring_[slot].neighbour;
    if (degree_[at(u)] + degree_[at(v)] > kMostNeighbours) {
        return false;
    }
    const std::size_t count = ring_.size();
    int facing = 0;
    if (closed_ || slot + 1 < count) {
        ++facing;
        if (!keeps_apex(ring_[(slot + 1) % count].neighbour)) {
            return false;
        }
    }
    if (closed_ || slot > 0) {
        ++facing;
        if (!keeps_apex(ring_[(slot + count - 1) % count].neighbour)) {
            return false;
        }
    }
    int shared = 0;
    const int start = out_[at(u)];
    int h = start;
    do {
        shared += mark_[at(next_from(h))] == looks_ ? 1 : 0;
        const int last = HalfEdges::previous(h);
        h = sides_[at(last)].twin;
        if (h < 0) {
            shared += mark_[at(sides_[at(last)].from)] == looks_ ? 1 : 0;
        }
    } while (h >= 0 && h != start);
    return shared == facing;
}

// No new edge joins two vertices of lines, but for the one that replaces two edges of v's line.
bool Collapser::keeps_lines(int v, std::size_t slot) const {
    const bool along = on_line(v);
    if (along && !is_line_slot(v, slot)) {
        return false;
    }
    const int u = ring_[slot].neighbour;
    if (!on_line(u)) {
        return true;
    }
    const std::size_t count = ring_.size();
    for (std::size_t k = 0; k < count; ++k) {
        const std::size_t apart = (k + count - slot) % count;
        const bool facing = apart <= 1 || apart + 1 == count;
        const bool other_line_edge = along && is_line_slot(v, k);
        if (k == slot || !on_line(ring_[k].neighbour)) {
            continue;
        }
        if (closed_ && other_line_edge && facing) {
            return false;  // u is already joined to it, beside the line.
        }
        if (!other_line_edge && !facing) {
            return false;
        }
    }
    return true;
}

// Joins the two outer sides of a triangle that goes; `h` is its side between the two vertices that
// become one. Returns the outer side that starts at the kept vertex, or -1.
int Collapser::close_triangle(int h, int kept) {
    const std::array<int, 2> inner{HalfEdges::next(h), HalfEdges::previous(h)};
    const std::array<int, 2> outer{sides_[at(inner[0])].twin, sides_[at(inner[1])].twin};
    const int tip = sides_[at(inner[1])].from;
    for (std::size_t k = 0; k < 2; ++k) {
        if (outer[k] >= 0) {
            sides_[at(outer[k])].twin = outer[1 - k];
        }
    }
    if (out_[at(tip)] == inner[1]) {
        out_[at(tip)] = outer[0];
    }
    --degree_[at(tip)];
    for (const int side : {h, inner[0], inner[1]}) {
        sides_[at(side)].from = -1;
    }
    return outer[1] >= 0 && sides_[at(outer[1])].from == kept ? outer[1] : -1;
}

void Collapser::collapse(int v, std::size_t slot) {
    const int u = ring_[slot].neighbour;
    std::array<int, 2> sides{ring_[slot].half_edge, -1};  // v -> u and u -> v.
    if (closed_ || slot > 0) {
        const RingEntry& before = ring_[(slot + ring_.size() - 1) % ring_.size()];
        sides[1] = HalfEdges::previous(before.half_edge);
    }
    for (const RingEntry& entry : ring_) {
        locked_[at(entry.neighbour)] = pass_;
        if (entry.half_edge >= 0) {
            sides_[at(entry.half_edge)].from = u;
        }
    }
    std::array<int, 4> out{-1, -1, out_[at(u)], out_[at(v)]};
    degree_[at(u)] += degree_[at(v)] - 2;
    for (std::size_t k = 0; k < 2; ++k) {
        if (sides[k] >= 0) {
            out[k] = close_triangle(sides[k], u);
            --degree_[at(u)];
        }
    }
    int kept = -1;
    for (const int h : out) {
        if (h >= 0 && sides_[at(h)].from == u && (kept < 0 || sides_[at(h)].twin < 0)) {
            kept = h;
        }
    }
    out_[at(u)] = kept;
    degree_[at(v)] = 0;
    parent_[at(v)] = u;
    if (line_[at(v)] >= 0) {
        --line_size_[at(line_[at(v)])];
    }
    --left_;
}

// Returns how many vertices went.
int Collapser::pass(const Limits& limits) {
    ++pass_;
    int gone = 0;
    int visits = 0;
    for (const auto& [length, v] : shortest_first(limits.visited)) {
        if (++visits % kCheckEvery == 0) {
            context_.check();
        }
        if (left_ <= options_.target_vertices) {
            break;
        }
        if (locked_[at(v)] == pass_) {
            continue;
        }
        look(v);
        if (!may_go(v)) {
            continue;
        }
        Choice best;
        for (std::size_t slot = 0; slot < ring_.size(); ++slot) {
            const double shape = worst_shape(slot, limits, best.shape);
            if (shape < best.shape && keeps_lines(v, slot) && keeps_topology(v, slot)) {
                best = {slot, shape};
            }
        }
        if (std::isfinite(best.shape)) {
            collapse(v, best.slot);
            ++gone;
        }
    }
    return gone;
}

Coarser Collapser::compact() {
    Coarser out;
    std::vector<int> name(positions_.size(), -1);
    for (std::size_t v = 0; v < positions_.size(); ++v) {
        if (parent_[v] == static_cast<int>(v)) {
            name[v] = static_cast<int>(out.surface.mesh.positions.size());
            out.surface.mesh.positions.push_back(positions_[v]);
            out.surface.line_of_vertex.push_back(line_[v]);
        }
    }
    out.surface.mesh.triangles.reserve(2 * left_);
    for (std::size_t h = 0; h < sides_.size(); h += 3) {
        if (sides_[h].from >= 0) {
            out.surface.mesh.triangles.push_back({name[at(sides_[h].from)],
                                                  name[at(sides_[h + 1].from)],
                                                  name[at(sides_[h + 2].from)]});
        }
    }
    out.representative.reserve(positions_.size());
    for (std::size_t v = 0; v < positions_.size(); ++v) {
        int kept = static_cast<int>(v);
        while (parent_[at(kept)] != kept) {
            parent_[at(kept)] = parent_[at(parent_[at(kept)])];  // Path halving.
            kept = parent_[at(kept)];
        }
        out.representative.push_back(name[at(kept)]);
    }
    return out;
}

Coarser Collapser::run() {
    for (std::size_t stage = 0; stage < kLimits.size() && left_ > options_.target_vertices;) {
        const auto before = static_cast<double>(left_);
        const int gone = pass(kLimits[stage]);
        const bool last = stage + 1 == kLimits.size();
        stage += gone < (last ? kLastPass : kSlowPass) * before ? 1 : 0;
    }
    return compact();
}

}  // namespace

Coarser coarsen(const LinedSurface& fine, const CoarsenOptions& options, const Context& context) {
    return Collapser(fine, options, context).run();
}

}  // namespace leafcutter::geometry
