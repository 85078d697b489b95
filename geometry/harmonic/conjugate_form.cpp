#include "geometry/harmonic/conjugate_form.h"

#include <algorithm>
#include <cstddef>

#include "geometry/intrinsic_delaunay.h"
#include "geometry/laplacian.h"

namespace leafcutter::geometry {
namespace {

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

Eigen::VectorXd between_sources_and_sinks(const std::vector<WeightedEdge>& edges,
                                          const std::vector<std::uint8_t>& lines) {
    std::vector<char> held(lines.size(), 0);
    Eigen::VectorXd f = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(lines.size()));
    for (std::size_t v = 0; v < lines.size(); ++v) {
        held[v] = (lines[v] & (SourceLoop | SinkLoop)) != 0 ? 1 : 0;
        f[static_cast<Eigen::Index>(v)] = (lines[v] & SinkLoop) != 0 ? 1.0 : 0.0;
    }
    return HarmonicSolver(edges, held).solve(std::move(f));
}

// A closed cochain of the class that the conjugate has. The fluxes w (f_j - f_i) are a closed
// cochain on the dual edges: their sums round interior vertices vanish. It is integrated from a
// first triangle of each vertex round its fan to the others; the value of a half-edge is that of
// the dual path between the first triangles of its ends.
std::vector<double> class_of_fluxes(const IntrinsicTriangulation& mesh,
                                    const std::vector<WeightedEdge>& edges,
                                    const Eigen::VectorXd& f) {
    const int count = mesh.edges.size();
    // Moving to the left round a vertex, flux towards it raises g.
    std::vector<double> weight(at(count), 0.0);
    for (const WeightedEdge& edge : edges) {
        weight[at(edge.half_edge)] = edge.weight;
        if (mesh.edges.twin_of(edge.half_edge) >= 0) {
            weight[at(mesh.edges.twin_of(edge.half_edge))] = edge.weight;
        }
    }
    std::vector<double> from_first(at(count), 0.0);  // Per corner, at its outgoing half-edge.
    for (const int start : first_outgoing(mesh.edges, mesh.vertex_count)) {
        if (start < 0) {
            continue;
        }
        double sum = 0.0;
        for (int h = turn_left(mesh.edges, start); h >= 0 && h != start;
             h = turn_left(mesh.edges, h)) {
            sum += weight[at(h)] * (f[mesh.edges.from_of(h)] - f[mesh.edges.to_of(h)]);
            from_first[at(h)] = sum;
        }
    }
    std::vector<double> jump(at(count));
    for (int h = 0; h < count; ++h) {
        jump[at(h)] = from_first[at(h)] - from_first[at(HalfEdges::next(h))];
    }
    return jump;
}

// Vertices of one natural loop have one value of g between them: `offset` says how their stored
// values differ, so that g is constant there.
struct NaturalLoops {
    std::vector<int> representative;  // Per vertex.
    std::vector<double> offset;
};

NaturalLoops join_natural_loops(const IntrinsicTriangulation& mesh,
                                const std::vector<std::uint8_t>& lines,
                                const std::vector<double>& jump) {
    NaturalLoops natural;
    natural.representative.resize(lines.size());
    for (std::size_t v = 0; v < lines.size(); ++v) {
        natural.representative[v] = static_cast<int>(v);
    }
    natural.offset.assign(lines.size(), 0.0);
    for (const std::vector<int>& walk : boundary_walks(mesh.edges)) {
        const int first = mesh.edges.from_of(walk.front());
        if ((lines[at(first)] & NaturalLoop) == 0) {
            continue;
        }
        for (std::size_t i = 0; i + 1 < walk.size(); ++i) {
            const int v = mesh.edges.to_of(walk[i]);
            natural.representative[at(v)] = first;
            natural.offset[at(v)] =
                natural.offset[at(mesh.edges.from_of(walk[i]))] - jump[at(walk[i])];
        }
    }
    return natural;
}

// The harmonic form of the class of `jump`: natural at sources and sinks, constant along natural
// loops. Per half-edge of the intrinsic triangulation.
std::vector<double> harmonic_rise(const IntrinsicTriangulation& mesh,
                                  std::vector<WeightedEdge> edges,
                                  const std::vector<std::uint8_t>& lines,
                                  std::vector<double> jump) {
    const NaturalLoops natural = join_natural_loops(mesh, lines, jump);
    for (int h = 0; h < mesh.edges.size(); ++h) {
        jump[at(h)] +=
            natural.offset[at(mesh.edges.to_of(h))] - natural.offset[at(mesh.edges.from_of(h))];
    }
    std::vector<double> edge_jump;
    edge_jump.reserve(edges.size());
    for (WeightedEdge& edge : edges) {
        edge.from = natural.representative[at(edge.from)];
        edge.to = natural.representative[at(edge.to)];
        edge_jump.push_back(jump[at(edge.half_edge)]);
    }
    std::vector<char> held(lines.size(), 0);
    for (std::size_t v = 0; v < held.size(); ++v) {
        held[v] = natural.representative[v] != static_cast<int>(v) ? 1 : 0;
    }
    held[at(natural.representative.front())] = 1;
    const Eigen::VectorXd g =
        HarmonicSolver(edges, held).solve(Eigen::VectorXd::Zero(mesh.vertex_count), edge_jump);
    for (int h = 0; h < mesh.edges.size(); ++h) {
        jump[at(h)] += g[natural.representative[at(mesh.edges.to_of(h))]] -
                       g[natural.representative[at(mesh.edges.from_of(h))]];
    }
    return jump;
}

}  // namespace

ConjugateForm solve_conjugate_form(const ChartSurface& surface) {
    const IntrinsicTriangulation delaunay = intrinsic_delaunay(surface.mesh, surface.edges);
    const std::vector<WeightedEdge> edges = cotangent_edges(delaunay);
    const Eigen::VectorXd f = between_sources_and_sinks(edges, surface.lines);
    const std::vector<double> rise =
        harmonic_rise(delaunay, edges, surface.lines, class_of_fluxes(delaunay, edges, f));
    ConjugateForm form;
    form.f.assign(f.data(), f.data() + f.size());
    form.flux = 2.0 * dirichlet_energy(edges, f);
    for (const WeightedEdge& edge : edges) {
        form.conjugate += edge.weight * rise[at(edge.half_edge)] * rise[at(edge.half_edge)];
    }
    form.rise = undo_flips(delaunay, rise);
    for (int h = 0; h < surface.edges.size(); ++h) {
        const int twin = surface.edges.twin_of(h);
        if (twin > h) {
            form.rise[at(twin)] = -form.rise[at(h)];  // Exactly.
        } else if (twin < 0 && (surface.lines[at(surface.edges.from_of(h))] & NaturalLoop) != 0) {
            form.rise[at(h)] = 0.0;
        }
    }
    return form;
}

std::vector<std::vector<int>> boundary_walks(const HalfEdges& edges) {
    const auto last = std::max_element(edges.from.begin(), edges.from.end());
    std::vector<int> outgoing(last == edges.from.end() ? 0 : at(*last) + 1, -1);
    std::vector<char> seen(edges.from.size(), 0);
    for (int h = 0; h < edges.size(); ++h) {
        if (edges.twin_of(h) < 0) {
            outgoing[at(edges.from_of(h))] = h;
        }
    }
    std::vector<std::vector<int>> walks;
    for (int h = 0; h < edges.size(); ++h) {
        if (edges.twin_of(h) >= 0 || seen[at(h)] != 0) {
            continue;
        }
        walks.emplace_back();
        for (int k = h; seen[at(k)] == 0; k = outgoing[at(edges.to_of(k))]) {
            seen[at(k)] = 1;
            walks.back().push_back(k);
        }
    }
    return walks;
}

std::vector<int> first_outgoing(const HalfEdges& edges, int vertex_count) {
    std::vector<int> first(at(vertex_count), -1);
    for (int h = 0; h < edges.size(); ++h) {
        int& out = first[at(edges.from_of(h))];
        if (out < 0 || edges.twin_of(h) < 0) {
            out = h;
        }
    }
    return first;
}

}  // namespace leafcutter::geometry
