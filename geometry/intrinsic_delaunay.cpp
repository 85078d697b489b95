#include "geometry/intrinsic_delaunay.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace leafcutter::geometry {
namespace {

// Least excess of two sides over the third, in mean edge lengths (Sharp and Crane's delta).
constexpr double kLeastExcess = 1e-6;
// A flip must gain more than rounding, in units of the cotangents compared.
constexpr double kCotangentTolerance = 1e-10;
// Flips end by themselves in exact arithmetic; this many for each edge end them in any other.
constexpr int kMostFlipsPerEdge = 200;

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

void set_lengths(IntrinsicTriangulation& out, const TriangleMesh& mesh) {
    const int count = out.edges.size();
    out.length.resize(at(count));
    double sum = 0.0;
    for (int h = 0; h < count; ++h) {
        out.length[at(h)] =
            (mesh.positions[at(out.edges.to_of(h))] - mesh.positions[at(out.edges.from_of(h))])
                .stableNorm();
        sum += out.length[at(h)];
    }
    const double least_excess = count > 0 ? kLeastExcess * sum / count : 0.0;
    double missing = 0.0;
    for (int h = 0; h < count; ++h) {
        const double excess = out.length[at(HalfEdges::next(h))] +
                              out.length[at(HalfEdges::previous(h))] - out.length[at(h)];
        missing = std::max(missing, least_excess - excess);
    }
    out.added_length = missing;
    for (double& length : out.length) {
        length += missing;
    }
}

// Length of the other diagonal of the two triangles at `h`, laid flat side by side.
double other_diagonal(const IntrinsicTriangulation& mesh, int h) {
    const int twin = mesh.edges.twin_of(h);
    const double base = mesh.length[at(h)];
    const auto apex = [&](double left, double right) {
        const double x = (base * base + left * left - right * right) / (2.0 * base);
        return std::pair(x, 2.0 * triangle_area(base, left, right) / base);
    };
    const auto [cx, cy] =
        apex(mesh.length[at(HalfEdges::previous(h))], mesh.length[at(HalfEdges::next(h))]);
    const auto [dx, dy] =
        apex(mesh.length[at(HalfEdges::next(twin))], mesh.length[at(HalfEdges::previous(twin))]);
    return std::hypot(cx - dx, cy + dy);
}

struct Slot {
    int from;
    int twin;
    double length;
    Jump jump;
};

Slot read_slot(const IntrinsicTriangulation& mesh, int h) {
    return {mesh.edges.from_of(h), mesh.edges.twin_of(h), mesh.length[at(h)], mesh.jump[at(h)]};
}

// Flips the edge a-b of triangles abc and bad to c-d. Slots: h a->b, then b->c, c->a; t b->a, a->d,
// d->b; afterwards h c->d, d->b, b->c; t d->c, c->a, a->d.
void flip(IntrinsicTriangulation& mesh, int h) {
    const int t = mesh.edges.twin_of(h);
    const int h1 = HalfEdges::next(h);
    const int h2 = HalfEdges::previous(h);
    const int t1 = HalfEdges::next(t);
    const int t2 = HalfEdges::previous(t);
    const double diagonal = other_diagonal(mesh, h);
    const std::array<std::pair<int, int>, 4> moves{{{t2, h1}, {h1, h2}, {h2, t1}, {t1, t2}}};
    const auto moved = [&](int half_edge) {
        for (const auto& [old_place, new_place] : moves) {
            if (old_place == half_edge) {
                return new_place;
            }
        }
        return half_edge;
    };
    const std::array<Slot, 4> slots{read_slot(mesh, t2), read_slot(mesh, h1), read_slot(mesh, h2),
                                    read_slot(mesh, t1)};
    for (std::size_t k = 0; k < 4; ++k) {
        const int place = moves[k].second;
        const int twin = slots[k].twin < 0 ? -1 : moved(slots[k].twin);
        mesh.edges.from[at(place)] = slots[k].from;
        mesh.edges.twin[at(place)] = twin;
        if (twin >= 0) {
            mesh.edges.twin[at(twin)] = place;
        }
        mesh.length[at(place)] = slots[k].length;
        mesh.jump[at(place)] = slots[k].jump;
    }
    mesh.edges.from[at(h)] = slots[2].from;  // c
    mesh.edges.from[at(t)] = slots[0].from;  // d
    mesh.length[at(h)] = diagonal;
    mesh.length[at(t)] = diagonal;
    for (std::size_t k = 0; k < 2; ++k) {
        const int through_a = slots[2].jump[k] + slots[3].jump[k];
        mesh.jump[at(h)][k] = through_a;
        mesh.jump[at(t)][k] = -through_a;
    }
}

bool wants_flip(const IntrinsicTriangulation& mesh, int h) {
    const int twin = mesh.edges.twin_of(h);
    if (twin < 0 || twin / 3 == h / 3) {
        return false;
    }
    const double here = facing_cotangent(mesh, h);
    const double there = facing_cotangent(mesh, twin);
    return here + there < -kCotangentTolerance * (1.0 + std::abs(here) + std::abs(there));
}

void make_delaunay(IntrinsicTriangulation& mesh) {
    std::vector<int> stack;
    std::vector<char> waiting(mesh.length.size(), 0);
    for (int h = mesh.edges.size() - 1; h >= 0; --h) {
        if (mesh.edges.is_first(h)) {
            stack.push_back(h);
            waiting[at(h)] = 1;
        }
    }
    const long most = static_cast<long>(kMostFlipsPerEdge) * static_cast<long>(stack.size());
    while (!stack.empty() && mesh.flips < most) {
        const int h = stack.back();
        stack.pop_back();
        waiting[at(h)] = 0;
        if (!wants_flip(mesh, h)) {
            continue;
        }
        flip(mesh, h);
        ++mesh.flips;
        const int t = mesh.edges.twin_of(h);
        mesh.flip_log.push_back({h, t});
        for (const int side : {HalfEdges::next(h), HalfEdges::previous(h), HalfEdges::next(t),
                               HalfEdges::previous(t)}) {
            if (waiting[at(side)] == 0) {
                waiting[at(side)] = 1;
                stack.push_back(side);
            }
        }
    }
}

}  // namespace

std::vector<double> undo_flips(const IntrinsicTriangulation& triangulation,
                               std::vector<double> values) {
    for (std::size_t i = triangulation.flip_log.size(); i-- > 0;) {
        // The places of flip(), read backwards.
        const auto [h, t] = triangulation.flip_log[i];
        double& h1 = values[at(HalfEdges::next(h))];
        double& h2 = values[at(HalfEdges::previous(h))];
        double& t1 = values[at(HalfEdges::next(t))];
        double& t2 = values[at(HalfEdges::previous(t))];
        const double through_d = t2 + h1;
        const double d_to_b = h1;
        h1 = h2;
        h2 = t1;
        t1 = t2;
        t2 = d_to_b;
        values[at(h)] = through_d;
        values[at(t)] = -through_d;
    }
    return values;
}

double facing_cotangent(const IntrinsicTriangulation& triangulation, int half_edge) {
    const double a = triangulation.length[at(half_edge)];
    const double b = triangulation.length[at(HalfEdges::next(half_edge))];
    const double c = triangulation.length[at(HalfEdges::previous(half_edge))];
    // A floor for the area keeps the cotangents of a triangle that rounding made flat finite.
    const double longest = std::max({a, b, c});
    const double area = std::max(triangle_area(a, b, c), 1e-12 * longest * longest);
    return ((b - a) * (b + a) + c * c) / (4.0 * area);
}

IntrinsicTriangulation intrinsic_delaunay(const TriangleMesh& mesh,
                                          const HalfEdges& edges,
                                          std::span<const Jump> jump) {
    IntrinsicTriangulation out;
    out.vertex_count = static_cast<int>(mesh.positions.size());
    out.edges = edges;
    out.jump.assign(edges.from.size(), Jump{0, 0});
    std::copy(jump.begin(), jump.end(), out.jump.begin());
    set_lengths(out, mesh);
    make_delaunay(out);
    return out;
}

}  // namespace leafcutter::geometry
