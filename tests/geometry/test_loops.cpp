// Handle and tunnel loops, linking numbers, and loops given by a user.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "geometry/error.h"
#include "geometry/loops/cut_along.h"
#include "geometry/loops/edge_paths.h"
#include "geometry/loops/handle_tunnel.h"
#include "geometry/loops/linking.h"
#include "geometry/loops/tree_cotree.h"
#include "geometry/loops/user_loops.h"
#include "geometry/samples.h"
#include "tests/geometry/prepared_surface.h"

namespace leafcutter::geometry {
namespace {

using testing::at;
using testing::PreparedSurface;

std::vector<Eigen::Vector3d> circle(const Eigen::Vector3d& centre,
                                    const Eigen::Vector3d& a,
                                    const Eigen::Vector3d& b) {
    std::vector<Eigen::Vector3d> line;
    for (int k = 0; k < 40; ++k) {
        const double angle = 2.0 * std::numbers::pi * k / 40;
        line.emplace_back(centre + std::cos(angle) * a + std::sin(angle) * b);
    }
    return line;
}

std::vector<Eigen::Vector3d> line_of(const std::vector<int>& cycle,
                                     const std::vector<Eigen::Vector3d>& positions) {
    std::vector<Eigen::Vector3d> line;
    for (const int v : cycle) {
        line.push_back(positions[at(v)]);
    }
    return line;
}

double length_of(const std::vector<int>& cycle, const TriangleMesh& mesh) {
    double length = 0.0;
    for (std::size_t i = 0; i < cycle.size(); ++i) {
        length += (mesh.positions[at(cycle[i])] - mesh.positions[at(cycle[(i + 1) % cycle.size()])])
                      .norm();
    }
    return length;
}

void expect_disjoint_cycles(const std::vector<std::vector<int>>& cycles, const VertexRings& rings) {
    std::set<int> seen;
    for (const std::vector<int>& cycle : cycles) {
        EXPECT_GE(cycle.size(), 3U);
        for (std::size_t i = 0; i < cycle.size(); ++i) {
            EXPECT_TRUE(seen.insert(cycle[i]).second) << "vertex " << cycle[i];
            EXPECT_NO_THROW(find_edge(rings, cycle[i], cycle[(i + 1) % cycle.size()]));
        }
    }
}

TEST(Linking, CountsHowOftenOneLineGoesThroughTheOther) {
    const auto x = Eigen::Vector3d::UnitX();
    const auto y = Eigen::Vector3d::UnitY();
    const auto z = Eigen::Vector3d::UnitZ();
    const auto ring = circle(Eigen::Vector3d::Zero(), x, y);
    const auto through = circle(x, x, z);
    ASSERT_TRUE(linking_number(ring, through));
    EXPECT_EQ(std::abs(*linking_number(ring, through)), 1);
    EXPECT_EQ(linking_number(ring, through), linking_number(through, ring));
    EXPECT_EQ(linking_number(ring, circle(3.0 * x, x, z)), 0);
    EXPECT_EQ(*linking_number(ring, circle(x, z, x)), -*linking_number(ring, through));
    // Three times round the first ring's line.
    std::vector<Eigen::Vector3d> coil;
    for (int k = 0; k < 300; ++k) {
        const double angle = 2.0 * std::numbers::pi * k / 300;
        const Eigen::Vector3d out = std::cos(angle) * x + std::sin(angle) * y;
        coil.emplace_back(out + 0.2 * (std::cos(3.0 * angle) * out + std::sin(3.0 * angle) * z));
    }
    EXPECT_EQ(std::abs(*linking_number(ring, coil)), 3);
}

TEST(TreeCotree, CyclesAreDualToCochains) {
    for (int genus = 1; genus <= 4; ++genus) {
        SCOPED_TRACE(genus);
        const PreparedSurface surface(testing::make_chain_of_rings(genus, 1500 * genus));
        ASSERT_EQ(surface.genus, genus);
        const DualBasis basis =
            dual_basis(surface.half_edges, static_cast<int>(surface.mesh.positions.size()));
        ASSERT_EQ(basis.cycles.size(), 2U * static_cast<std::size_t>(genus));
        for (std::size_t i = 0; i < basis.cycles.size(); ++i) {
            expect_disjoint_cycles({basis.cycles[i]}, surface.rings);
            for (std::size_t k = 0; k < basis.cochains.size(); ++k) {
                int sum = 0;
                for (std::size_t j = 0; j < basis.cycles[i].size(); ++j) {
                    const int from = basis.cycles[i][j];
                    const int to = basis.cycles[i][(j + 1) % basis.cycles[i].size()];
                    const MeshEdge& edge =
                        surface.rings.edges[at(find_edge(surface.rings, from, to))];
                    const int value = basis.cochains[k][at(edge.half_edge)];
                    sum += edge.from == from ? value : -value;
                }
                EXPECT_EQ(sum, i == k ? 1 : 0);
            }
        }
    }
}

struct Solid {
    const char* name;
    TriangleMesh (*make)();
    int genus;
};

void PrintTo(const Solid& solid, std::ostream* out) {
    *out << solid.name;
}

class LoopsOf : public ::testing::TestWithParam<Solid> {};

// Row T1 of the requirements: a handle loop is unlinked with all loops pushed out of the solid, a
// tunnel loop with all pushed into it, and their intersection matrix is unimodular.
TEST_P(LoopsOf, SolidAreUnlinkedOnTheirSideAndDual) {
    const PreparedSurface surface(GetParam().make());
    ASSERT_EQ(surface.genus, GetParam().genus);
    const LoopSystem system = find_loops(surface.view(), {});
    EXPECT_TRUE(system.embedded);
    ASSERT_EQ(static_cast<int>(system.handle.size()), surface.genus);
    ASSERT_EQ(static_cast<int>(system.tunnel.size()), surface.genus);
    expect_disjoint_cycles(system.handle, surface.rings);
    expect_disjoint_cycles(system.tunnel, surface.rings);
    const auto& on = surface.mesh.positions;
    const auto out = pushed_out(surface.mesh.triangles, on);
    std::vector<Eigen::Vector3d> in;
    for (std::size_t v = 0; v < on.size(); ++v) {
        in.emplace_back(2.0 * on[v] - out[v]);
    }
    std::vector<std::vector<int>> all = system.handle;
    all.insert(all.end(), system.tunnel.begin(), system.tunnel.end());
    Eigen::MatrixXd meets(surface.genus, surface.genus);
    for (int i = 0; i < surface.genus; ++i) {
        for (const std::vector<int>& other : all) {
            EXPECT_EQ(linking_number(line_of(system.handle[at(i)], on), line_of(other, out)), 0);
            EXPECT_EQ(linking_number(line_of(system.tunnel[at(i)], on), line_of(other, in)), 0);
        }
        for (int j = 0; j < surface.genus; ++j) {
            meets(i, j) = *linking_number(line_of(system.handle[at(i)], on),
                                          line_of(system.tunnel[at(j)], in));
        }
    }
    EXPECT_NEAR(std::abs(meets.determinant()), 1.0, 1e-9);
}

// Row T2.
TEST_P(LoopsOf, SolidCutItIntoASphereWithHoles) {
    const PreparedSurface surface(GetParam().make());
    const LoopSystem system = find_loops(surface.view(), {});
    for (const auto& cuts : {system.handle, system.tunnel}) {
        const auto pieces = cut_along(surface.mesh.triangles,
                                      static_cast<int>(surface.mesh.positions.size()), {}, cuts);
        ASSERT_EQ(pieces.size(), 1U);
        EXPECT_EQ(pieces[0].euler, 2 - 2 * surface.genus);
        EXPECT_EQ(static_cast<int>(pieces[0].loops.size()), 2 * surface.genus);
        for (std::size_t k = 0; k < pieces[0].loops.size(); ++k) {
            EXPECT_EQ(pieces[0].loops[k].size(), cuts[at(pieces[0].origins[k].cut)].size());
        }
    }
}

INSTANTIATE_TEST_SUITE_P(
    Formula,
    LoopsOf,
    ::testing::Values(Solid{"torus", [] { return testing::make_torus(16, 40, 0.35); }, 1},
                      Solid{"trefoil", [] { return testing::make_trefoil_tube(0.4); }, 1},
                      Solid{"eight", [] { return make_sample("eight", 3000); }, 2},
                      Solid{"doubletorus", [] { return make_sample("double-torus", 3000); }, 2},
                      Solid{"three", [] { return testing::make_chain_of_rings(3, 5000); }, 3},
                      Solid{"five", [] { return testing::make_chain_of_rings(5, 8000); }, 5}),
    [](const auto& tested) { return std::string(tested.param.name); });

TEST(Loops, OfATorusAreItsMeridianAndItsInnerEquator) {
    const PreparedSurface surface(testing::make_torus(24, 60, 0.35));
    const LoopSystem system = find_loops(surface.view(), {});
    EXPECT_NEAR(length_of(system.handle[0], surface.mesh) / (2.0 * std::numbers::pi * 0.35), 1.0,
                0.02);
    EXPECT_NEAR(length_of(system.tunnel[0], surface.mesh) / (2.0 * std::numbers::pi * 0.65), 1.0,
                0.02);
}

TEST(Loops, OfAKnottedTubeRunRoundItAndAlongIt) {
    const PreparedSurface surface(testing::make_trefoil_tube(0.4));
    const LoopSystem system = find_loops(surface.view(), {});
    const double round = length_of(system.handle[0], surface.mesh);
    EXPECT_NEAR(round / (2.0 * std::numbers::pi * 0.4), 1.0, 0.05);
    EXPECT_GT(length_of(system.tunnel[0], surface.mesh), 8.0 * round);
}

TEST(Loops, OfAnOpenSurfaceKeepClearOfItsBoundary) {
    TriangleMesh mesh = make_sample("double-torus", 3000);
    mesh.triangles.erase(mesh.triangles.begin() + 100);
    const PreparedSurface surface(mesh);
    ASSERT_EQ(surface.loops.size(), 1U);
    const LoopSystem system = find_loops(surface.view(), {});
    EXPECT_TRUE(system.embedded);
    std::vector<std::vector<int>> all = system.handle;
    all.push_back(surface.loops[0]);
    EXPECT_EQ(all.size(), 3U);
    expect_disjoint_cycles(all, surface.rings);
}

TEST(Loops, AreTheSameEveryTime) {
    const PreparedSurface surface(make_sample("eight", 2000));
    EXPECT_EQ(find_loops(surface.view(), {}).tunnel, find_loops(surface.view(), {}).tunnel);
}

// A loop round the tube of a torus, by every fourth of its vertices.
std::vector<int> meridian(int column, int across) {
    std::vector<int> vertices;
    for (int i = 0; i < across; i += 4) {
        vertices.push_back(column * across + i);
    }
    return vertices;
}

TEST(UserLoops, AreClosedByShortestWays) {
    const PreparedSurface surface(testing::make_torus(16, 40, 0.35));
    const std::vector<std::vector<int>> given{meridian(3, 16), meridian(20, 16)};
    const auto closed = close_loops(surface.rings, surface.mesh.positions, given, {});
    ASSERT_EQ(closed.size(), 2U);
    expect_disjoint_cycles(closed, surface.rings);
    for (std::size_t k = 0; k < 2; ++k) {
        EXPECT_EQ(closed[k].size(), 16U);
        for (const int v : given[k]) {
            EXPECT_NE(std::find(closed[k].begin(), closed[k].end(), v), closed[k].end());
        }
    }
}

std::string code_of(const PreparedSurface& surface, const std::vector<std::vector<int>>& given) {
    try {
        close_loops(surface.rings, surface.mesh.positions, given, {});
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::BadOption);
        EXPECT_EQ(std::string(error.what()).rfind("loops[", 0), 0U) << error.what();
        return error.code();
    }
    return "none";
}

TEST(UserLoops, ThatCannotBeClosedAreNamed) {
    const PreparedSurface torus(testing::make_torus(16, 40, 0.35));
    EXPECT_EQ(code_of(torus, {{0, 4}}), "loop-vertices");
    EXPECT_EQ(code_of(torus, {{0, 4, 640}}), "loop-vertices");
    EXPECT_EQ(code_of(torus, {{0, 4, 8, 4}}), "loop-not-simple");
    EXPECT_EQ(code_of(torus, {meridian(3, 16), meridian(3, 16)}), "loops-meet");
    // The second loop would have to leave the disk that the first bounds.
    const int v = 16 * 7 + 5;
    std::vector<int> round;
    for (int k = torus.rings.begin[at(v)]; k < torus.rings.begin[at(v) + 1]; ++k) {
        round.push_back(torus.rings.slots[at(k)].neighbour);
    }
    EXPECT_EQ(code_of(torus, {round, {v, 16 * 20, 16 * 30}}), "loop-blocked");
    const PreparedSurface prism(testing::make_prism(16, 10, 1.0, 2.0));
    EXPECT_EQ(code_of(prism, {{0, 4, 8, 12}}), "loop-at-boundary");
}

}  // namespace
}  // namespace leafcutter::geometry
