// Quads that go on across the leaves of F* between rectangles: what theory says of them holds on
// any surface with sources and sinks.

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <numeric>
#include <queue>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "geometry/cases/one_form.h"
#include "geometry/error.h"
#include "geometry/quads/critical_sides.h"
#include "geometry/quads/edge_parity.h"
#include "geometry/quads/quad_edges.h"
#include "geometry/quads/quad_mesh.h"
#include "geometry/quads/threads.h"
#include "geometry/samples.h"
#include "geometry/surface_measures.h"
#include "geometry/topology.h"
#include "tests/geometry/surfaces.h"

namespace leafcutter::geometry {
namespace {

using testing::at;
using testing::to_mesh;

struct Ball {
    Eigen::Vector3d centre;
    double radius;
};

// The mesh without the triangles that have a corner in one of the balls.
TriangleMesh without(const TriangleMesh& mesh, const std::vector<Ball>& balls) {
    std::vector<int> fresh(mesh.positions.size(), -1);
    TriangleMesh out;
    for (const auto& t : mesh.triangles) {
        const auto taken = [&](int v) {
            return std::any_of(balls.begin(), balls.end(), [&](const Ball& ball) {
                return (mesh.positions[at(v)] - ball.centre).norm() < ball.radius;
            });
        };
        if (std::any_of(t.begin(), t.end(), taken)) {
            continue;
        }
        std::array<int, 3> corners{};
        for (std::size_t k = 0; k < 3; ++k) {
            int& name = fresh[at(t[k])];
            if (name < 0) {
                name = static_cast<int>(out.positions.size());
                out.positions.push_back(mesh.positions[at(t[k])]);
            }
            corners[k] = name;
        }
        out.triangles.push_back(corners);
    }
    return out;
}

TriangleMesh square_with_two_holes() {
    return without(testing::make_square(40), {{{0.3, 0.35, 0.0}, 0.1}, {{0.7, 0.6, 0.0}, 0.14}});
}

TriangleMesh torus_with_two_holes() {
    return without(testing::make_torus(32, 80, 0.4),
                   {{{1.3, 0.2, 0.0}, 0.2}, {{-0.6, -0.9, 0.3}, 0.2}});
}

// Two zeros at one height, but for the mesh: between the holes.
TriangleMesh symmetric_square() {
    return without(testing::make_square(48),
                   {{{0.2, 0.5, 0.0}, 0.08}, {{0.5, 0.5, 0.0}, 0.08}, {{0.8, 0.5, 0.0}, 0.08}});
}

struct Model {
    Foliation foliation;
    double area = 0.0;
    int euler = 0;
};

Model flow_through(const TriangleMesh& mesh, const FlowEnds& ends) {
    Model model;
    const Topology topology = analyse_topology(to_mesh(mesh));
    model.euler = topology.euler;
    model.foliation = foliate_one_form(mesh, topology.boundary_loops, ends, {}, {});
    model.area = surface_area(mesh);
    return model;
}

// From the first loop to all others.
Model flow_from_first(const TriangleMesh& mesh) {
    const std::size_t loops = analyse_topology(to_mesh(mesh)).boundary_loops.size();
    std::vector<int> sinks(loops - 1);
    std::iota(sinks.begin(), sinks.end(), 1);
    return flow_through(mesh, {{0}, sinks});
}

GridOptions about(const Model& model, double cells) {
    GridOptions options;
    options.strip_width_mm = std::sqrt(model.area / cells);
    options.may_narrow = false;
    return options;
}

int conflicts(const QuadMesh& mesh) {
    const QuadNeighbours neighbours = find_neighbours(mesh.quads);
    std::vector<int> colour(mesh.quads.size(), -1);
    int alike = 0;
    for (std::size_t seed = 0; seed < colour.size(); ++seed) {
        std::queue<std::size_t> next;
        if (colour[seed] < 0) {
            colour[seed] = 0;
            next.push(seed);
        }
        for (; !next.empty(); next.pop()) {
            for (const QuadSide& side : neighbours.across[next.front()]) {
                if (side.quad < 0) {
                    continue;
                }
                int& other = colour[at(side.quad)];
                if (other < 0) {
                    other = 1 - colour[next.front()];
                    next.push(at(side.quad));
                }
                alike += other == colour[next.front()] ? 1 : 0;
            }
        }
    }
    return alike;
}

// How many vertices inside have so many quads around them.
std::map<int, int> inner_valences(const QuadMesh& mesh) {
    const QuadNeighbours neighbours = find_neighbours(mesh.quads);
    std::vector<int> quads(mesh.vertices.size(), 0);
    std::vector<char> outside(mesh.vertices.size(), 0);
    for (std::size_t q = 0; q < mesh.quads.size(); ++q) {
        for (std::size_t side = 0; side < 4; ++side) {
            ++quads[at(mesh.quads[q][side])];
            if (neighbours.across[q][side].quad < 0) {
                outside[at(mesh.quads[q][side])] = 1;
                outside[at(mesh.quads[q][(side + 1) % 4])] = 1;
            }
        }
    }
    std::map<int, int> valences;
    for (std::size_t v = 0; v < quads.size(); ++v) {
        if (outside[v] == 0) {
            ++valences[quads[v]];
        }
    }
    return valences;
}

int euler_of(const QuadMesh& mesh) {
    return static_cast<int>(mesh.vertices.size()) - find_neighbours(mesh.quads).edges +
           static_cast<int>(mesh.quads.size());
}

// One mesh: its topology is the surface's, zeros have eight quads around them, colours alternate
// and there are as many cells as asked for.
void expect_one_mesh(const Model& model, double cells) {
    SCOPED_TRACE(cells);
    const QuadMesh mesh = build_quad_mesh(model.foliation, about(model, cells));
    EXPECT_EQ(find_neighbours(mesh.quads).faults, 0);
    EXPECT_EQ(euler_of(mesh), model.euler);
    EXPECT_EQ(conflicts(mesh), 0);
    std::map<int, int> irregular = inner_valences(mesh);
    EXPECT_GT(irregular[4], 0);
    irregular.erase(4);
    std::map<int, int> wanted;
    for (const Singularity& singularity : model.foliation.singularities) {
        ++wanted[2 * singularity.prongs];
    }
    EXPECT_EQ(irregular, wanted);
    EXPECT_NEAR(static_cast<double>(mesh.quads.size()) / cells, 1.0, 0.11);
    const double area = std::accumulate(mesh.surface_area.begin(), mesh.surface_area.end(), 0.0);
    EXPECT_NEAR(area / model.area, 1.0, 1e-9);
    EXPECT_EQ(mesh.warnings, std::vector<std::string>{});
}

TEST(ConformingRectangles, AreOneMeshOnAnySurface) {
    for (const TriangleMesh& mesh : {square_with_two_holes(), torus_with_two_holes()}) {
        const Model model = flow_from_first(mesh);
        for (const double cells : {800.0, 2500.0, 9000.0}) {
            expect_one_mesh(model, cells);
        }
    }
}

TEST(ConformingRectangles, LetZerosAtOneHeightShareARow) {
    const Model model = flow_from_first(symmetric_square());
    ASSERT_EQ(model.foliation.singularities.size(), 2U);
    for (const double cells : {1200.0, 4000.0}) {
        expect_one_mesh(model, cells);
        const QuadMesh mesh = build_quad_mesh(model.foliation, about(model, cells));
        for (std::size_t c = 0; c < mesh.grids.size(); ++c) {
            const std::vector<double>& levels = mesh.grids[c].f_levels;
            const double mean = levels.back() / mesh.grids[c].rows;
            for (std::size_t i = 1; i < levels.size(); ++i) {
                EXPECT_GT(levels[i] - levels[i - 1], 0.1 * mean);
            }
        }
    }
}

TEST(ConformingRectangles, FlowRoundLoopsThatAreNeither) {
    const TriangleMesh mesh = square_with_two_holes();
    const Model model = flow_through(mesh, {{0}, {1}});
    const QuadMesh quads = build_quad_mesh(model.foliation, about(model, 1500.0));
    EXPECT_EQ(find_neighbours(quads.quads).faults, 0);
    EXPECT_EQ(euler_of(quads), model.euler);
    EXPECT_EQ(conflicts(quads), 0);
    std::map<int, int> valences = inner_valences(quads);
    valences.erase(4);
    EXPECT_TRUE(valences.empty());
}

TEST(ConformingRectangles, ShareTheirRowsSoThatWeftCloses) {
    const Model model = flow_from_first(square_with_two_holes());
    const QuadMesh mesh = build_quad_mesh(model.foliation, about(model, 2000.0));
    const auto weft = trace_threads(mesh, Family::Weft, ThreadEnds::AtCriticalLeaves);
    for (const Thread& thread : weft) {
        EXPECT_TRUE(thread.closed);
    }
    const auto warp = trace_threads(mesh, Family::Warp, ThreadEnds::AtCriticalLeaves);
    int cols = 0;
    for (const CylinderGrid& grid : mesh.grids) {
        cols += grid.cols;
    }
    EXPECT_EQ(static_cast<int>(warp.size()), cols);
}

TEST(ConformingRectangles, HaveTheCountsThatAreFixed) {
    const Model model = flow_from_first(square_with_two_holes());
    ASSERT_EQ(model.foliation.cylinders.size(), 2U);
    GridOptions options = about(model, 2000.0);
    options.all.rows = 17;
    options.per_cylinder = {{.rows = 17, .cols = 6}, {.rows = 17, .cols = 10}};
    const QuadMesh mesh = build_quad_mesh(model.foliation, options);
    EXPECT_EQ(mesh.grids[0].rows, 17);
    EXPECT_EQ(mesh.grids[0].cols, 6);
    EXPECT_EQ(mesh.grids[1].cols, 10);
    EXPECT_EQ(conflicts(mesh), 0);

    options.per_cylinder[1].cols = 9;
    try {
        build_quad_mesh(model.foliation, options);
        FAIL() << "an odd ring was taken";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::BadOption);
        EXPECT_EQ(error.code(), "odd-cols");
    }
    options.parity = Parity::Any;
    EXPECT_EQ(build_quad_mesh(model.foliation, options).grids[1].cols, 9);
}

TEST(ConformingRectangles, RefuseStripsTooWideAndNameThoseThatWillDo) {
    const Model model = flow_from_first(square_with_two_holes());
    try {
        build_quad_mesh(model.foliation, about(model, 4.0));
        FAIL() << "too few quads were taken";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::BadOption);
        EXPECT_EQ(error.code(), "strips-too-wide");
        const std::string what = error.what();
        const std::size_t place = what.find("use at most ");
        ASSERT_NE(place, std::string::npos);
        GridOptions options = about(model, 4.0);
        options.strip_width_mm = std::stod(what.substr(place + 12));
        EXPECT_EQ(conflicts(build_quad_mesh(model.foliation, options)), 0);
    }
}

// By trying all labels.
double least_cost(int nodes, const std::vector<ParityEdge>& edges) {
    double least = 1e300;
    for (unsigned way = 0; way < (1U << static_cast<unsigned>(nodes)); ++way) {
        double cost = 0.0;
        for (const ParityEdge& edge : edges) {
            cost += edge.cost[((way >> static_cast<unsigned>(edge.from)) ^
                               (way >> static_cast<unsigned>(edge.to))) &
                              1U];
        }
        least = std::min(least, cost);
    }
    return least;
}

TEST(EdgeParity, CostsLeastAndIsEvenRoundEveryCycle) {
    std::minstd_rand random(7);
    std::uniform_real_distribution<double> cost(0.0, 1.0);
    for (int nodes = 1; nodes <= 9; ++nodes) {
        std::uniform_int_distribution<int> node(0, nodes - 1);
        std::vector<ParityEdge> edges;
        for (int e = 0; e < 2 * nodes; ++e) {
            edges.push_back({node(random), node(random), {cost(random), cost(random)}});
        }
        const std::vector<int> parities = cheapest_parities(nodes, edges);
        std::vector<ParityEdge> chosen = edges;
        double sum = 0.0;
        for (std::size_t e = 0; e < edges.size(); ++e) {
            sum += edges[e].cost[at(parities[e])];
            chosen[e].cost = {parities[e] == 0 ? 0.0 : 1.0, parities[e] == 1 ? 0.0 : 1.0};
        }
        EXPECT_NEAR(sum, least_cost(nodes, edges), 1e-12);
        EXPECT_EQ(least_cost(nodes, chosen), 0.0);  // There are labels that say just these.
    }
}

}  // namespace
}  // namespace leafcutter::geometry
