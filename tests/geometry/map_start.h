// First maps of small surfaces into their dual trees, and what the preimages of graph edges look
// like.

#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "geometry/disjoint_sets.h"
#include "geometry/half_edges.h"
#include "geometry/laplacian.h"
#include "geometry/pants/initial_map.h"
#include "geometry/pants/reeb_graph.h"
#include "geometry/samples.h"
#include "geometry/topology.h"
#include "tests/geometry/surfaces.h"

namespace leafcutter::testing {

struct MapStart {
    TriangleMesh mesh;
    geometry::VertexRings rings;
    std::vector<double> weights;  // Per mesh edge.
    geometry::GraphMap map;
};

// `mesh` without vertices that no triangle uses.
inline TriangleMesh without_unused(const TriangleMesh& mesh) {
    std::vector<int> fresh(mesh.positions.size(), -1);
    TriangleMesh out;
    for (const auto& triangle : mesh.triangles) {
        std::array<int, 3> corners{};
        for (std::size_t k = 0; k < 3; ++k) {
            int& name = fresh[at(triangle[k])];
            if (name < 0) {
                name = static_cast<int>(out.positions.size());
                out.positions.push_back(mesh.positions[at(triangle[k])]);
            }
            corners[k] = name;
        }
        out.triangles.push_back(corners);
    }
    return out;
}

// A sphere with round holes about Fibonacci's points: even, without symmetry.
inline TriangleMesh make_holed_sphere(int holes, int faces) {
    TriangleMesh mesh = geometry::make_sample("sphere", faces);
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& p : mesh.positions) {
        centre += p / static_cast<double>(mesh.positions.size());
    }
    std::vector<Eigen::Vector3d> axes;
    for (int k = 0; k < holes; ++k) {
        const double z = 1.0 - (2.0 * k + 1.0) / holes;
        const double turn = k * std::numbers::pi * (3.0 - std::sqrt(5.0));
        const double r = std::sqrt(1.0 - z * z);
        axes.emplace_back(r * std::cos(turn), r * std::sin(turn), z);
    }
    const auto in_hole = [&](int v) {
        const Eigen::Vector3d direction = (mesh.positions[at(v)] - centre).normalized();
        return std::any_of(axes.begin(), axes.end(), [&](const Eigen::Vector3d& axis) {
            return direction.dot(axis) > std::cos(0.3);
        });
    };
    std::erase_if(mesh.triangles, [&](const std::array<int, 3>& triangle) {
        return std::any_of(triangle.begin(), triangle.end(), in_hole);
    });
    return without_unused(mesh);
}

// The function swept is one coordinate on closed surfaces; on open ones it is harmonic, 0 on the
// first boundary loop and 1 on the others, of which there are some. All weights of the graph are 1.
inline MapStart start_map(TriangleMesh mesh, int axis) {
    using namespace geometry;
    MapStart start;
    start.mesh = std::move(mesh);
    const int count = static_cast<int>(start.mesh.positions.size());
    const HalfEdges half_edges = build_half_edges(start.mesh.triangles, count);
    start.rings = build_vertex_rings(half_edges, count);
    const std::vector<WeightedEdge> edges = positive_edges(start.mesh, half_edges, 1e-3);
    for (const WeightedEdge& edge : edges) {
        start.weights.push_back(edge.weight);
    }
    const auto loops = analyse_topology(to_mesh(start.mesh)).boundary_loops;
    Eigen::VectorXd values(count);
    for (int v = 0; v < count; ++v) {
        values[v] = start.mesh.positions[at(v)][axis];
    }
    std::vector<char> is_low(loops.size(), 0);
    if (!loops.empty()) {
        is_low.front() = 1;
        std::vector<char> held(at(count), 0);
        for (std::size_t k = 0; k < loops.size(); ++k) {
            for (const int v : loops[k]) {
                held[at(v)] = 1;
                values[v] = k == 0 ? 0.0 : 1.0;
            }
        }
        values = HarmonicSolver(edges, held).solve(std::move(values));
    }
    const std::vector<double> swept(values.begin(), values.end());
    const ReebGraph reeb = build_reeb_graph(start.mesh.triangles, swept, loops, is_low);
    start.map = initial_map(reeb, start.rings, loops);
    return start;
}

// Gives graph edges that join two different nodes another weight.
inline void set_link_weights(geometry::GraphMap& map, double weight) {
    for (std::size_t v = 0; v < map.t.size(); ++v) {
        const geometry::MetricGraph::Edge& edge = map.graph.edges[at(map.graph_edge[v])];
        map.t[v] *= edge.from != edge.to ? weight / edge.weight : 1.0;
    }
    for (geometry::MetricGraph::Edge& edge : map.graph.edges) {
        edge.weight = edge.from != edge.to ? weight : edge.weight;
    }
}

// What the map takes to the inside of one graph edge, as far as homotopy goes. An annulus has one
// component and Euler characteristic 0.
struct Preimage {
    int components = 0;
    int euler = 0;
};

struct Preimages {
    std::vector<Preimage> of_edge;
    int three_prongs = 0;  // Triangles whose corners lie in three legs.
    int torn = 0;          // Triangles with one side that leaves its edge: there must be none.
    int long_words = 0;    // Mesh edges that pass a graph edge whole: there must be none.
};

// Where no mesh edge passes a graph edge whole, the preimage of an open edge can be drawn back onto
// the vertices, mesh edges and triangles that lie in it entirely.
inline Preimages preimages(const MapStart& start, const geometry::GraphMap& map) {
    Preimages result;
    result.of_edge.resize(map.graph.edges.size());
    geometry::DisjointSets sets(start.mesh.positions.size());
    for (std::size_t e = 0; e < start.rings.edges.size(); ++e) {
        const auto& edge = start.rings.edges[e];
        result.long_words += map.words[e].size() > 2 ? 1 : 0;
        if (map.words[e].empty()) {
            --result.of_edge[at(map.graph_edge[at(edge.from)])].euler;
            sets.unite(static_cast<std::uint32_t>(edge.from), static_cast<std::uint32_t>(edge.to));
        }
    }
    for (std::uint32_t v = 0; v < start.mesh.positions.size(); ++v) {
        Preimage& own = result.of_edge[at(map.graph_edge[v])];
        ++own.euler;
        own.components += sets.find(v) == v ? 1 : 0;
    }
    for (std::size_t t = 0; t < start.mesh.triangles.size(); ++t) {
        int cut = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            cut += map.words[at(start.rings.edge_of_half_edge[3 * t + k])].empty() ? 0 : 1;
        }
        result.three_prongs += cut == 3 ? 1 : 0;
        result.torn += cut == 1 ? 1 : 0;
        if (cut == 0) {
            ++result.of_edge[at(map.graph_edge[at(start.mesh.triangles[t][0])])].euler;
        }
    }
    return result;
}

}  // namespace leafcutter::testing
