// Surfaces of negative Euler characteristic: how many cylinders, whether they are sound, and the
// energy that makes them.

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "geometry/foliation.h"
#include "geometry/half_edges.h"
#include "geometry/io/read_mesh.h"
#include "geometry/laplacian.h"
#include "geometry/mesh.h"
#include "geometry/pants/harmonic_map.h"
#include "geometry/pants/initial_map.h"
#include "geometry/pants/local_step.h"
#include "geometry/pants/reeb_graph.h"
#include "geometry/pants/split_long_edges.h"
#include "geometry/repair.h"
#include "geometry/samples.h"
#include "geometry/topology.h"
#include "tests/geometry/chart_checks.h"
#include "tests/geometry/surfaces.h"

namespace leafcutter::geometry {
namespace {

using testing::at;
using testing::to_mesh;

double area_of(const TriangleMesh& mesh) {
    double area = 0.0;
    for (const auto& t : mesh.triangles) {
        const Eigen::Vector3d& a = mesh.positions[at(t[0])];
        area += 0.5 * (mesh.positions[at(t[1])] - a).cross(mesh.positions[at(t[2])] - a).norm();
    }
    return area;
}

// The invariants of section 3.2: 3g - 3 + 2b cylinders, as many prongs as Euler asks for, every
// chart sound, no part of the surface lost, and the energy that the cylinders have.
void expect_pants(const Mesh& mesh, double energy_tolerance = 0.05) {
    const Topology topology = analyse_topology(mesh);
    const int loops = static_cast<int>(topology.boundary_loops.size());
    const int genus = (2 - loops - topology.euler) / 2;
    FoliationOptions whole;
    whole.puncture = PunctureChoice::None;
    const Foliation foliation = compute_foliation(mesh, whole);
    EXPECT_EQ(foliation.mode, FoliationMode::Pants);
    ASSERT_EQ(static_cast<int>(foliation.cylinders.size()), 3 * genus - 3 + 2 * loops);
    EXPECT_EQ(static_cast<int>(foliation.singularities.size()), -2 * topology.euler);
    double area = 0.0;
    double modules = 0.0;
    for (const Cylinder& cylinder : foliation.cylinders) {
        EXPECT_TRUE(testing::is_sound(cylinder));
        EXPECT_EQ(cylinder.shape, ChartShape::Annulus);
        area += area_of(cylinder.mesh);
        modules += cylinder.width * cylinder.height;
    }
    EXPECT_NEAR(area / area_of(to_triangle_mesh(mesh)), 1.0, 1e-9);
    EXPECT_NEAR(2.0 * foliation.energy / modules, 1.0, energy_tolerance);
}

// A sphere without the triangles near some of its points.
TriangleMesh sphere_with_holes(int holes) {
    TriangleMesh mesh = make_sample("sphere", 6000);
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& p : mesh.positions) {
        centre += p / static_cast<double>(mesh.positions.size());
    }
    std::vector<Eigen::Vector3d> axes;
    for (int k = 0; k < holes; ++k) {  // Fibonacci's points: even, without symmetry.
        const double z = 1.0 - (2.0 * k + 1.0) / holes;
        const double turn = k * std::numbers::pi * (3.0 - std::sqrt(5.0));
        const double r = std::sqrt(1.0 - z * z);
        axes.emplace_back(r * std::cos(turn), r * std::sin(turn), z);
    }
    std::erase_if(mesh.triangles, [&](const std::array<int, 3>& t) {
        return std::any_of(axes.begin(), axes.end(), [&](const Eigen::Vector3d& axis) {
            return std::any_of(t.begin(), t.end(), [&](int v) {
                return (mesh.positions[at(v)] - centre).normalized().dot(axis) > std::cos(0.3);
            });
        });
    });
    return mesh;
}

// Without vertices that no triangle uses.
Mesh compact(const TriangleMesh& mesh) {
    std::vector<int> fresh(mesh.positions.size(), -1);
    TriangleMesh out;
    for (const auto& t : mesh.triangles) {
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
    return to_mesh(out);
}

TEST(Pants, CutsClosedSurfacesIntoCylinders) {
    for (const char* name : {"eight", "double-torus"}) {
        SCOPED_TRACE(name);
        expect_pants(to_mesh(make_sample(name, 6000)));
    }
}

TEST(Pants, CutsOpenSurfacesIntoCylinders) {
    for (int holes = 3; holes <= 6; ++holes) {
        SCOPED_TRACE(holes);
        expect_pants(compact(sphere_with_holes(holes)));
    }
}

TEST(Pants, AreChosenByNameToo) {
    FoliationOptions options;
    options.mode = FoliationMode::Pants;
    EXPECT_EQ(compute_foliation(compact(sphere_with_holes(3)), options).cylinders.size(), 3U);
}

// A first map of a closed sample, its function one coordinate.
struct Start {
    TriangleMesh mesh;
    VertexRings rings;
    std::vector<double> weights;
    GraphMap map;
};

Start start_on(const char* name, int faces, int axis) {
    Start start;
    start.mesh = make_sample(name, faces);
    const int count = static_cast<int>(start.mesh.positions.size());
    const HalfEdges half_edges = build_half_edges(start.mesh.triangles, count);
    start.rings = build_vertex_rings(half_edges, count);
    for (const WeightedEdge& edge : positive_edges(start.mesh, half_edges, 1e-3)) {
        start.weights.push_back(edge.weight);
    }
    std::vector<double> values;
    for (const Eigen::Vector3d& p : start.mesh.positions) {
        values.push_back(p[axis]);
    }
    const ReebGraph reeb = build_reeb_graph(start.mesh.triangles, values, {}, {});
    start.map = initial_map(reeb, start.rings, {});
    return start;
}

TEST(HarmonicMap, NoStepRaisesTheEnergy) {
    for (const int axis : {0, 1, 2}) {
        Start start = start_on("double-torus", 600, axis);
        LocalStep step(start.map, start.rings, start.weights);
        double before = map_energy(start.map, start.rings, start.weights);
        for (int sweep = 0; sweep < 4; ++sweep) {
            for (int v = 0; v < static_cast<int>(start.map.t.size()); ++v) {
                step.centre(v);
                const double after = map_energy(start.map, start.rings, start.weights);
                ASSERT_LE(after, before * (1.0 + 1e-6)) << "vertex " << v << " axis " << axis;
                before = after;
            }
        }
        const HarmonicMapReport report =
            solve_harmonic_map(start.map, start.rings, start.weights, MapStart::Warm, {});
        EXPECT_TRUE(report.converged);
        EXPECT_LT(report.energy, before);
        EXPECT_LT(report.residual, 1e-6);
    }
}

TEST(HarmonicMap, DependsOnItsClassOnly) {
    Start start = start_on("eight", 3000, 0);
    GraphMap scrambled = start.map;
    std::mt19937 random(5);
    std::uniform_real_distribution<double> anywhere(0.01, 0.99);
    for (double& t : scrambled.t) {
        t = anywhere(random);
    }
    const auto solve = [&](GraphMap& map) {
        return solve_harmonic_map(map, start.rings, start.weights, MapStart::Cold, {});
    };
    const HarmonicMapReport straight = solve(start.map);
    const HarmonicMapReport detour = solve(scrambled);
    EXPECT_TRUE(straight.converged);
    EXPECT_TRUE(detour.converged);
    EXPECT_NEAR(detour.energy / straight.energy, 1.0, 1e-8);
}

TEST(HarmonicMap, LiesInATree) {
    // Nowhere do two sides of a triangle add up to less than the third, which a path that was
    // reduced where it must not be would break.
    Start start = start_on("eight", 3000, 0);
    solve_harmonic_map(start.map, start.rings, start.weights, MapStart::Cold, {});
    while (split_long_edges(start.mesh, start.rings, start.map) > 0) {
    }
    for (std::size_t t = 0; t < start.mesh.triangles.size(); ++t) {
        std::array<double, 3> side{};
        int cut = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            const int e = start.rings.edge_of_half_edge[3 * t + k];
            const MeshEdge& edge = start.rings.edges[at(e)];
            const Word& word = start.map.words[at(e)];
            EXPECT_LE(word.size(), 2U);
            cut += word.empty() ? 0 : 1;
            side[k] = start.map.distance(edge.from, edge.to, word);
        }
        EXPECT_NE(cut, 1) << t;
        for (std::size_t k = 0; k < 3; ++k) {
            EXPECT_LE(side[k], side[(k + 1) % 3] + side[(k + 2) % 3] + 1e-9) << t;
        }
    }
}

struct Model {
    const char* file;
    double energy_tolerance;
};

void PrintTo(const Model& model, std::ostream* out) {
    *out << model.file;
}

class PantsModel : public ::testing::TestWithParam<Model> {};

TEST_P(PantsModel, IsCutIntoSoundCylinders) {
    const std::filesystem::path path =
        std::filesystem::path(LEAFCUTTER_SHARED_DIR) / "data" / "meshes" / GetParam().file;
    std::ifstream file(path, std::ios::binary);
    if (!file) {
        GTEST_SKIP() << "no shared data";
    }
    const std::vector<char> bytes((std::istreambuf_iterator<char>(file)), {});
    const RepairedMesh repaired =
        repair(read_mesh(std::as_bytes(std::span(bytes)), GetParam().file));
    expect_pants(repaired.mesh, GetParam().energy_tolerance);
}

// Fertility is made of needles: clamped weights cost it a tenth.
INSTANTIATE_TEST_SUITE_P(Shared,
                         PantsModel,
                         ::testing::Values(Model{"eight-7k.off", 0.05},
                                           Model{"fertility.off", 0.15},
                                           Model{"hand-6-boundaries.obj", 0.05},
                                           Model{"cat-7-boundaries.obj", 0.05},
                                           Model{"plane-windows.obj", 0.05}),
                         [](const auto& tested) {
                             std::string name = tested.param.file;
                             name.resize(name.find('.'));
                             std::erase(name, '-');
                             return name;
                         });

}  // namespace
}  // namespace leafcutter::geometry
