// Intrinsic Delaunay flips of a surface that must stay simplicial. After A. Bobenko and
// B. Springborn, "A discrete Laplace-Beltrami operator for simplicial surfaces", 2007.
//
// As intrinsic_delaunay.cpp, but edges keep their numbers, lines keep their edges, and flips are
// written down to be undone.

#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/pants/flippable.h"
#include "geometry/pants/level.h"

namespace leafcutter::geometry {
namespace {

// Least excess of two sides over the third, in mean edge lengths (Sharp and Crane, "A Laplacian for
// nonmanifold triangle meshes", SGP 2020).
constexpr double kLeastExcess = 1e-6;
// A flip must gain more than rounding, in units of the cotangents compared.
constexpr double kCotangentTolerance = 1e-10;
// Flips end by themselves in exact arithmetic; this many for each edge end them in any other.
constexpr long kMostFlipsPerEdge = 200;
// Refused flips are tried again after others.
constexpr int kMostRounds = 20;
// Least weight of an edge; equilateral triangles have 0.58. Right angles give many edges weight 0:
// far more than this would be felt in the energy.
constexpr double kLeastWeight = 1e-5;

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

// Kahan's stable form of Heron's formula; 0 where rounding breaks the triangle inequality.
double triangle_area(double a, double b, double c) {
    if (a < b) {
        std::swap(a, b);
    }
    if (b < c) {
        std::swap(b, c);
    }
    if (a < b) {
        std::swap(a, b);
    }
    const double product = (a + (b + c)) * (c - (a - b)) * (c + (a - b)) * (a + (b - c));
    return product > 0.0 ? 0.25 * std::sqrt(product) : 0.0;
}

class Flipper {
public:
    Flipper(const LinedSurface& surface, const VertexRings& rings);
    void run();
    FlippedSurface result() const;

private:
    double length_at(int h) const { return length_[at(mesh_.edge_of(h))]; }
    void measure();
    void set_cotangents(int triangle);
    void relax(int first, std::vector<int>& refused);
    bool wants_flip(int h) const;
    bool may_flip(int h) const;
    bool adjacent(int from, int to) const;
    void flip(int h);

    const LinedSurface& surface_;
    FlippableMesh mesh_;
    std::vector<double> length_;     // Per edge.
    std::vector<double> cotangent_;  // Per half-edge, of the angle that faces it.
    std::vector<double> area_;       // Per triangle.
    std::vector<char> held_;         // Per edge: of a line.
    std::vector<char> on_line_;      // Per vertex.
    std::vector<int> degree_;        // Per vertex.
    std::vector<int> out_;           // Per vertex: a half-edge out of it.
    std::vector<int> flips_;
    std::vector<int> stack_;
    long most_flips_ = 0;
};

Flipper::Flipper(const LinedSurface& surface, const VertexRings& rings)
    : surface_(surface), mesh_(rings) {
    const std::size_t vertices = surface.mesh.positions.size();
    std::vector<char> on_boundary(vertices, 0);
    on_line_.assign(vertices, 0);
    degree_.assign(vertices, 0);
    out_.assign(vertices, -1);
    for (const MeshEdge& edge : rings.edges) {
        const bool boundary = mesh_.twin_of(edge.half_edge) < 0;
        for (const int v : {edge.from, edge.to}) {
            ++degree_[at(v)];
            if (boundary) {
                on_boundary[at(v)] = 1;
            }
        }
    }
    const std::vector<int>& line = surface.line_of_vertex;
    for (std::size_t v = 0; v < vertices; ++v) {
        on_line_[v] = line[v] >= 0 || on_boundary[v] != 0 ? 1 : 0;
    }
    for (int h = 0; h < mesh_.half_edges(); ++h) {
        out_[at(mesh_.from_of(h))] = h;
    }
    held_.reserve(rings.edges.size());
    for (const MeshEdge& edge : rings.edges) {
        const int number = line[at(edge.from)];
        const bool inner_line = number >= 0 && number == line[at(edge.to)] &&
                                on_boundary[at(edge.from)] == 0 && on_boundary[at(edge.to)] == 0;
        held_.push_back(inner_line || mesh_.twin_of(edge.half_edge) < 0 ? 1 : 0);
    }
    most_flips_ = kMostFlipsPerEdge * static_cast<long>(rings.edges.size());
    measure();
}

// Lengths of all edges, made so much longer that no triangle is flat.
void Flipper::measure() {
    const std::vector<Eigen::Vector3d>& positions = surface_.mesh.positions;
    length_.resize(at(mesh_.edges()));
    double sum = 0.0;
    for (int e = 0; e < mesh_.edges(); ++e) {
        const int h = mesh_.half_edge_of(e);
        length_[at(e)] =
            (positions[at(mesh_.to_of(h))] - positions[at(mesh_.from_of(h))]).stableNorm();
        sum += length_[at(e)];
    }
    const double least_excess = length_.empty() ? 0.0 : kLeastExcess * sum / mesh_.edges();
    double missing = 0.0;
    for (int h = 0; h < mesh_.half_edges(); ++h) {
        const double excess =
            length_at(HalfEdges::next(h)) + length_at(HalfEdges::previous(h)) - length_at(h);
        missing = std::max(missing, least_excess - excess);
    }
    for (double& length : length_) {
        length += missing;
    }
    cotangent_.resize(at(mesh_.half_edges()));
    area_.resize(at(mesh_.half_edges() / 3));
    for (int t = 0; t < mesh_.half_edges() / 3; ++t) {
        set_cotangents(t);
    }
}

void Flipper::set_cotangents(int triangle) {
    const int h = 3 * triangle;
    const double a = length_at(h);
    const double b = length_at(h + 1);
    const double c = length_at(h + 2);
    // A floor for the area keeps the cotangents of a triangle that rounding made flat finite.
    const double longest = std::max({a, b, c});
    const double area = std::max(triangle_area(a, b, c), 1e-12 * longest * longest);
    const double scale = 0.25 / area;
    cotangent_[at(h)] = scale * ((b - a) * (b + a) + c * c);
    cotangent_[at(h + 1)] = scale * ((c - b) * (c + b) + a * a);
    cotangent_[at(h + 2)] = scale * ((a - c) * (a + c) + b * b);
    area_[at(triangle)] = area;
}

bool Flipper::wants_flip(int h) const {
    const double here = cotangent_[at(h)];
    const double there = cotangent_[at(mesh_.twin_of(h))];
    return here + there < -kCotangentTolerance * (1.0 + std::abs(here) + std::abs(there));
}

// A flip must not join two vertices a second time, nor two vertices of lines.
bool Flipper::may_flip(int h) const {
    const int c = mesh_.facing(h);
    const int d = mesh_.facing(mesh_.twin_of(h));
    if (c == d || (on_line_[at(c)] != 0 && on_line_[at(d)] != 0)) {
        return false;
    }
    return degree_[at(c)] < degree_[at(d)] ? !adjacent(c, d) : !adjacent(d, c);
}

bool Flipper::adjacent(int from, int to) const {
    const int start = out_[at(from)];
    int h = start;
    do {  // Counter-clockwise, to the boundary where there is one.
        const int last = HalfEdges::previous(h);
        if (mesh_.to_of(h) == to || mesh_.from_of(last) == to) {
            return true;
        }
        h = mesh_.twin_of(last);
    } while (h >= 0 && h != start);
    if (h == start) {
        return false;
    }
    for (int t = mesh_.twin_of(start); t >= 0; t = mesh_.twin_of(HalfEdges::next(t))) {
        if (mesh_.facing(t) == to || mesh_.to_of(HalfEdges::next(t)) == to) {
            return true;
        }
    }
    return false;
}

// Length of the other diagonal of the two triangles at `h`, laid flat side by side.
double other_diagonal(double base,
                      std::pair<double, double> ca_bc,
                      std::pair<double, double> ad_db) {
    const auto apex = [&](double left, double right) {
        const double x = (base * base + left * left - right * right) / (2.0 * base);
        return std::pair(x, 2.0 * triangle_area(base, left, right) / base);
    };
    const auto [cx, cy] = apex(ca_bc.first, ca_bc.second);
    const auto [dx, dy] = apex(ad_db.first, ad_db.second);
    return std::hypot(cx - dx, cy + dy);
}

void Flipper::flip(int h) {
    const int t = mesh_.twin_of(h);
    const int edge = mesh_.edge_of(h);
    for (const int side : {h, t}) {
        --degree_[at(mesh_.from_of(side))];
        ++degree_[at(mesh_.facing(side))];
    }
    length_[at(edge)] = other_diagonal(
        length_[at(edge)], {length_at(HalfEdges::previous(h)), length_at(HalfEdges::next(h))},
        {length_at(HalfEdges::next(t)), length_at(HalfEdges::previous(t))});
    mesh_.flip(h);
    for (const int side : {h, t}) {
        set_cotangents(side / 3);
        for (const int corner : {side, HalfEdges::next(side), HalfEdges::previous(side)}) {
            out_[at(mesh_.from_of(corner))] = corner;
        }
    }
    flips_.push_back(edge);
}

// Flips the edge and whatever that makes necessary nearby.
void Flipper::relax(int first, std::vector<int>& refused) {
    stack_.push_back(first);
    while (!stack_.empty() && static_cast<long>(flips_.size()) < most_flips_) {
        const int edge = stack_.back();
        const int h = mesh_.half_edge_of(edge);
        stack_.pop_back();
        if (held_[at(edge)] != 0 || !wants_flip(h)) {
            continue;
        }
        if (!may_flip(h)) {
            refused.push_back(edge);
            continue;
        }
        flip(h);
        const int t = mesh_.twin_of(h);
        for (const int side : {HalfEdges::next(h), HalfEdges::previous(h), HalfEdges::next(t),
                               HalfEdges::previous(t)}) {
            stack_.push_back(mesh_.edge_of(side));
        }
    }
}

void Flipper::run() {
    std::vector<int> refused;
    for (int e = 0; e < mesh_.edges(); ++e) {
        relax(e, refused);
    }
    std::size_t flips = 0;
    for (int round = 0; round < kMostRounds && flips < flips_.size(); ++round) {
        flips = flips_.size();
        for (const int e : std::exchange(refused, {})) {
            relax(e, refused);
        }
    }
}

FlippedSurface Flipper::result() const {
    FlippedSurface out;
    out.half_edges = mesh_.to_half_edges();
    out.rings = build_vertex_rings(out.half_edges, static_cast<int>(surface_.mesh.positions.size()),
                                   mesh_.edge_numbers());
    out.weights.reserve(length_.size());
    for (int e = 0; e < mesh_.edges(); ++e) {
        const int h = mesh_.half_edge_of(e);
        const int twin = mesh_.twin_of(h);
        const double weight = 0.5 * (cotangent_[at(h)] + (twin < 0 ? 0.0 : cotangent_[at(twin)]));
        out.forced_weights += twin >= 0 && wants_flip(h) ? 1 : 0;
        out.weights.push_back(std::max(weight, kLeastWeight));
    }
    out.area = area_;
    out.flips = flips_;
    return out;
}

}  // namespace

FlippedSurface flip_to_delaunay(const LinedSurface& surface, const VertexRings& rings) {
    Flipper flipper(surface, rings);
    flipper.run();
    return flipper.result();
}

}  // namespace leafcutter::geometry
