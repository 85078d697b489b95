#include "geometry/cases/sphere_cover.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "geometry/error.h"
#include "geometry/sparse_solver.h"

namespace leafcutter::geometry {
namespace {

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

// Turns round its start vertex to the next half-edge that leaves it.
int turned(const HalfEdges& edges, int half_edge) {
    return edges.twin_of(HalfEdges::previous(half_edge));
}

std::vector<int> some_half_edge(const HalfEdges& edges, int vertex_count) {
    std::vector<int> out(at(vertex_count), -1);
    for (int h = edges.size() - 1; h >= 0; --h) {
        out[at(edges.from_of(h))] = h;
    }
    return out;
}

// Marks both half-edges of edges that the cover changes sheets across: those tree edges that have
// an odd number of the points on either side.
std::vector<char> sheet_cut(const HalfEdges& edges,
                            int vertex_count,
                            const std::array<int, 4>& points) {
    const std::vector<int> start = some_half_edge(edges, vertex_count);
    std::vector<int> entry(at(vertex_count), -1);  // Half-edge from the parent.
    std::vector<char> reached(at(vertex_count), 0);
    std::vector<int> queue{points[0]};
    reached[at(points[0])] = 1;
    for (std::size_t i = 0; i < queue.size(); ++i) {
        int h = start[at(queue[i])];
        do {
            const int to = edges.to_of(h);
            if (reached[at(to)] == 0) {
                reached[at(to)] = 1;
                entry[at(to)] = h;
                queue.push_back(to);
            }
            h = turned(edges, h);
        } while (h != start[at(queue[i])]);
    }
    std::vector<char> odd(at(vertex_count), 0);
    for (const int point : points) {
        odd[at(point)] = 1;
    }
    std::vector<char> cut(edges.from.size(), 0);
    for (std::size_t i = queue.size(); i-- > 1;) {
        const int h = entry[at(queue[i])];
        if (odd[at(queue[i])] != 0) {
            cut[at(h)] = 1;
            cut[at(edges.twin_of(h))] = 1;
            char& parent = odd[at(edges.from_of(h))];
            parent = static_cast<char>(1 - parent);
        }
    }
    return cut;
}

// A vertex of the cover as a function of the unknown of the vertex below: sign x unknown + shift.
struct OddPlace {
    int unknown = -1;  // -1: branched, the value is known.
    double sign = 0.0;
    std::array<double, 2> shift{};
};

struct OddUnknowns {
    std::vector<OddPlace> places;  // Per vertex of the cover.
    int count = 0;
};

OddUnknowns odd_unknowns(const BranchedCover& cover, const OddCochains& cochains) {
    OddUnknowns out;
    out.places.resize(cover.vertex_below.size());
    for (std::size_t v = 0; v < cover.above.size(); ++v) {
        const auto [one, other] = cover.above[v];
        const std::array<double, 2> fold{static_cast<double>(cochains.fold[0][v]),
                                         static_cast<double>(cochains.fold[1][v])};
        if (one == other) {
            out.places[at(one)].shift = {0.5 * fold[0], 0.5 * fold[1]};
            continue;
        }
        out.places[at(one)] = {.unknown = out.count, .sign = 1.0, .shift = {}};
        out.places[at(other)] = {.unknown = out.count, .sign = -1.0, .shift = fold};
        ++out.count;
    }
    return out;
}

// E = 1/2 sum of w (value(to) - value(from) + jump)^2 as a function of the unknowns.
std::vector<MatrixEntry> odd_matrix(const OddUnknowns& unknowns,
                                    std::span<const WeightedEdge> edges) {
    std::vector<MatrixEntry> lower;
    lower.reserve(3 * edges.size());
    for (const WeightedEdge& edge : edges) {
        const OddPlace& a = unknowns.places[at(edge.from)];
        const OddPlace& b = unknowns.places[at(edge.to)];
        if (a.unknown == b.unknown) {
            if (a.unknown >= 0 && a.sign != b.sign) {
                lower.push_back({a.unknown, a.unknown, 4.0 * edge.weight});
            }
            continue;
        }
        if (a.unknown >= 0) {
            lower.push_back({a.unknown, a.unknown, edge.weight});
        }
        if (b.unknown >= 0) {
            lower.push_back({b.unknown, b.unknown, edge.weight});
        }
        if (a.unknown >= 0 && b.unknown >= 0) {
            lower.push_back({std::max(a.unknown, b.unknown), std::min(a.unknown, b.unknown),
                             -edge.weight * a.sign * b.sign});
        }
    }
    return lower;
}

Eigen::VectorXd odd_right_side(const OddUnknowns& unknowns,
                               std::span<const WeightedEdge> edges,
                               std::span<const Jump> jump,
                               std::size_t k) {
    Eigen::VectorXd right = Eigen::VectorXd::Zero(unknowns.count);
    for (std::size_t e = 0; e < edges.size(); ++e) {
        const OddPlace& a = unknowns.places[at(edges[e].from)];
        const OddPlace& b = unknowns.places[at(edges[e].to)];
        const double known = edges[e].weight * (b.shift[k] - a.shift[k] + jump[e][k]);
        if (a.unknown >= 0) {
            right[a.unknown] += a.sign * known;
        }
        if (b.unknown >= 0) {
            right[b.unknown] -= b.sign * known;
        }
    }
    return right;
}

}  // namespace

BranchedCover branched_cover(const HalfEdges& edges,
                             int vertex_count,
                             const std::array<int, 4>& points) {
    const std::vector<char> cut = sheet_cut(edges, vertex_count, points);
    const int half = edges.size();
    BranchedCover cover;
    cover.edges.from.assign(2 * at(half), -1);
    cover.edges.twin.resize(2 * at(half));
    for (int h = 0; h < half; ++h) {
        const int twin = edges.twin_of(h);
        const bool changes = cut[at(h)] != 0;
        cover.edges.twin[at(h)] = changes ? twin + half : twin;
        cover.edges.twin[at(h + half)] = changes ? twin : twin + half;
    }
    cover.above.assign(at(vertex_count), {-1, -1});
    for (int h = 0; h < 2 * half; ++h) {
        if (cover.edges.from_of(h) >= 0) {
            continue;
        }
        const int vertex = cover.vertex_count();
        const int below = edges.from_of(h % half);
        cover.vertex_below.push_back(below);
        std::array<int, 2>& above = cover.above[at(below)];
        above = {above[0] < 0 ? vertex : above[0], vertex};
        for (int out = h; cover.edges.from_of(out) < 0; out = turned(cover.edges, out)) {
            cover.edges.from[at(out)] = vertex;
        }
    }
    return cover;
}

TriangleMesh cover_mesh(const TriangleMesh& surface, const BranchedCover& cover) {
    TriangleMesh mesh;
    mesh.positions.reserve(cover.vertex_below.size());
    for (const int below : cover.vertex_below) {
        mesh.positions.push_back(surface.positions[at(below)]);
    }
    mesh.triangles.reserve(cover.edges.from.size() / 3);
    for (int h = 0; h < cover.edges.size(); h += 3) {
        mesh.triangles.push_back(
            {cover.edges.from_of(h), cover.edges.from_of(h + 1), cover.edges.from_of(h + 2)});
    }
    return mesh;
}

OddCochains odd_cochains(const BranchedCover& cover, int first) {
    std::vector<Cochain> basis = cohomology_basis(cover.edges, cover.vertex_count());
    const auto fail = [] {
        throw Error(ErrorKind::SelfCheck, "cover-not-odd",
                    "sphere-pillowcase: the double cover of the surface is not the torus it should "
                    "be");
    };
    if (basis.size() != 2 || cover.above[at(first)][0] != cover.above[at(first)][1]) {
        fail();
    }
    OddCochains out;
    out.jump = {std::move(basis[0]), std::move(basis[1])};
    const std::vector<int> start = some_half_edge(cover.edges, cover.vertex_count());
    std::vector<char> reached(cover.above.size(), 0);
    std::vector<int> queue{first};
    reached[at(first)] = 1;
    for (auto& fold : out.fold) {
        fold.assign(cover.above.size(), 0);
    }
    const auto rise = [&](int h, std::size_t k) {
        return -(out.jump[k][at(h)] + out.jump[k][at(cover.other_sheet(h))]);
    };
    for (std::size_t i = 0; i < queue.size(); ++i) {
        const int from = queue[i];
        const int begin = start[at(cover.above[at(from)][0])];
        int h = begin;
        do {
            const int to = cover.vertex_below[at(cover.edges.to_of(h))];
            for (std::size_t k = 0; k < 2; ++k) {
                const int value = out.fold[k][at(from)] + rise(h, k);
                if (reached[at(to)] != 0 && out.fold[k][at(to)] != value) {
                    fail();
                }
                out.fold[k][at(to)] = value;
            }
            if (reached[at(to)] == 0) {
                reached[at(to)] = 1;
                queue.push_back(to);
            }
            h = turned(cover.edges, h);
        } while (h != begin);
    }
    return out;
}

HarmonicForms solve_odd_forms(const BranchedCover& cover,
                              const OddCochains& cochains,
                              std::span<const WeightedEdge> edges,
                              std::span<const Jump> jump) {
    const OddUnknowns unknowns = odd_unknowns(cover, cochains);
    const SparseSolver solver(unknowns.count, odd_matrix(unknowns, edges));
    HarmonicForms forms;
    forms.jump = cochains.jump;
    for (std::size_t k = 0; k < 2; ++k) {
        const Eigen::VectorXd solution = solver.solve(odd_right_side(unknowns, edges, jump, k));
        if (!solution.allFinite()) {
            throw Error(ErrorKind::SelfCheck, "singular-system",
                        "a harmonic form of the pillowcase is not finite: the mesh is too "
                        "degenerate; repair or remesh it");
        }
        forms.values[k].resize(cover.vertex_count());
        for (std::size_t v = 0; v < unknowns.places.size(); ++v) {
            const OddPlace& place = unknowns.places[v];
            const double unknown = place.unknown >= 0 ? solution[place.unknown] : 0.0;
            forms.values[k][static_cast<Eigen::Index>(v)] = place.sign * unknown + place.shift[k];
        }
    }
    forms.gram.setZero();
    for (std::size_t e = 0; e < edges.size(); ++e) {
        Eigen::Vector2d rise;
        for (std::size_t k = 0; k < 2; ++k) {
            rise[static_cast<Eigen::Index>(k)] =
                forms.values[k][edges[e].to] - forms.values[k][edges[e].from] + jump[e][k];
        }
        forms.gram += edges[e].weight * rise * rise.transpose();
    }
    return forms;
}

}  // namespace leafcutter::geometry
