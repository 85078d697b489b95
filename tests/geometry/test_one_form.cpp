// Surfaces between sources and sinks: how many rectangles, where they meet, and that together they
// are one harmonic function.

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <numbers>
#include <numeric>
#include <random>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "geometry/cases/one_form.h"
#include "geometry/harmonic/conjugate_form.h"
#include "geometry/harmonic/form_parts.h"
#include "geometry/harmonic/form_zeros.h"
#include "geometry/harmonic/leaf_cut.h"
#include "geometry/io/read_mesh.h"
#include "geometry/repair.h"
#include "geometry/samples.h"
#include "geometry/surface_measures.h"
#include "geometry/topology.h"
#include "tests/geometry/chart_checks.h"
#include "tests/geometry/surfaces.h"

namespace leafcutter::geometry {
namespace {

using testing::at;
using testing::to_mesh;
using Loops = std::vector<std::vector<int>>;

// The mesh without the triangles that have a corner in the holes.
TriangleMesh with_holes(const TriangleMesh& mesh,
                        const std::function<bool(const Eigen::Vector3d&)>& in_hole) {
    std::vector<int> fresh(mesh.positions.size(), -1);
    TriangleMesh out;
    for (const auto& t : mesh.triangles) {
        if (std::any_of(t.begin(), t.end(),
                        [&](int v) { return in_hole(mesh.positions[at(v)]); })) {
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

struct Disc {
    Eigen::Vector3d centre;
    double radius;
};

TriangleMesh with_discs_out(const TriangleMesh& mesh, const std::vector<Disc>& discs) {
    return with_holes(mesh, [&](const Eigen::Vector3d& p) {
        return std::any_of(discs.begin(), discs.end(), [&](const Disc& disc) {
            return (p - disc.centre).norm() < disc.radius;
        });
    });
}

// A sphere without the triangles near some of its points.
TriangleMesh sphere_with_holes(int holes) {
    const TriangleMesh sphere = make_sample("sphere", 6000);
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& p : sphere.positions) {
        centre += p / static_cast<double>(sphere.positions.size());
    }
    std::vector<Eigen::Vector3d> axes;
    for (int k = 0; k < holes; ++k) {  // Fibonacci's points: even, without symmetry.
        const double z = 1.0 - (2.0 * k + 1.0) / holes;
        const double turn = k * std::numbers::pi * (3.0 - std::sqrt(5.0));
        const double r = std::sqrt(1.0 - z * z);
        axes.emplace_back(r * std::cos(turn), r * std::sin(turn), z);
    }
    return with_holes(sphere, [&](const Eigen::Vector3d& p) {
        return std::any_of(axes.begin(), axes.end(), [&](const Eigen::Vector3d& axis) {
            return (p - centre).normalized().dot(axis) > std::cos(0.25);
        });
    });
}

Loops loops_of(const TriangleMesh& mesh) {
    return analyse_topology(to_mesh(mesh)).boundary_loops;
}

double length_of(const TriangleMesh& mesh, const std::vector<int>& loop) {
    double length = 0.0;
    for (std::size_t i = 0; i < loop.size(); ++i) {
        length +=
            (mesh.positions[at(loop[(i + 1) % loop.size()])] - mesh.positions[at(loop[i])]).norm();
    }
    return length;
}

int longest(const TriangleMesh& mesh, const Loops& loops) {
    const auto found = std::max_element(loops.begin(), loops.end(),
                                        [&](const std::vector<int>& a, const std::vector<int>& b) {
                                            return length_of(mesh, a) < length_of(mesh, b);
                                        });
    return static_cast<int>(found - loops.begin());
}

std::vector<int> all_but(std::size_t count, const std::vector<int>& left_out) {
    std::vector<int> rest;
    for (int k = 0; k < static_cast<int>(count); ++k) {
        if (std::find(left_out.begin(), left_out.end(), k) == left_out.end()) {
            rest.push_back(k);
        }
    }
    return rest;
}

int order_of_zeros(const Foliation& foliation) {
    int order = 0;
    for (const Singularity& singularity : foliation.singularities) {
        EXPECT_EQ(singularity.prongs % 2, 0);
        order += singularity.prongs / 2 - 1;
    }
    return order;
}

// By how much f differs, at most, between the two sides of a seam.
double seam_gap(const Foliation& foliation) {
    std::map<std::tuple<double, double, double>, std::pair<double, double>> range;
    for (const Cylinder& part : foliation.cylinders) {
        const std::vector<Eigen::Vector2d> gf = testing::vertex_gf(part);
        for (std::size_t v = 0; v < gf.size(); ++v) {
            const Eigen::Vector3d& p = part.mesh.positions[v];
            const auto [place, fresh] =
                range.try_emplace({p.x(), p.y(), p.z()}, gf[v].y(), gf[v].y());
            place->second.first = std::min(place->second.first, gf[v].y());
            place->second.second = std::max(place->second.second, gf[v].y());
        }
    }
    double worst = 0.0;
    for (const auto& [place, ends] : range) {
        worst = std::max(worst, ends.second - ends.first);
    }
    return worst;
}

// Charts of height 1 without a fault.
void expect_sound_rectangles(const Foliation& foliation) {
    EXPECT_EQ(foliation.mode, FoliationMode::OneForm);
    EXPECT_EQ(foliation.graph.edges.size(), foliation.cylinders.size());
    EXPECT_EQ(foliation.graph.nodes, 2);
    for (const Cylinder& part : foliation.cylinders) {
        EXPECT_TRUE(testing::is_sound(part));
        EXPECT_EQ(part.shape, ChartShape::Rectangle);
        EXPECT_DOUBLE_EQ(part.height, 1.0);
    }
}

double sum_over_parts(const Foliation& foliation,
                      const std::function<double(const Cylinder&)>& value) {
    return std::accumulate(foliation.cylinders.begin(), foliation.cylinders.end(), 0.0,
                           [&](double sum, const Cylinder& part) { return sum + value(part); });
}

// What holds for every one-form: rectangles of height 1 that are the whole surface, as wide
// together as the flux, which is twice the energy, their f equal along seams.
void expect_rectangles(const TriangleMesh& mesh, const Foliation& foliation) {
    expect_sound_rectangles(foliation);
    const auto area = [](const Cylinder& part) { return surface_area(part.mesh); };
    const auto width = [](const Cylinder& part) { return part.width; };
    EXPECT_NEAR(sum_over_parts(foliation, area) / surface_area(mesh), 1.0, 1e-9);
    EXPECT_NEAR(sum_over_parts(foliation, width) / (2.0 * foliation.energy), 1.0, 0.02);
    EXPECT_LT(seam_gap(foliation), 0.02);
    // Euler: the zeros and the lines between them and the loops cut the surface into disks.
    EXPECT_EQ(static_cast<int>(foliation.cylinders.size()),
              analyse_topology(to_mesh(mesh)).euler -
                  static_cast<int>(foliation.singularities.size()) +
                  static_cast<int>(foliation.critical_graph.size()));
}

// Euler: each simple zero parts its surroundings into two rectangles more, each natural loop one.
void expect_simple_zeros(const TriangleMesh& mesh, const Foliation& foliation, int natural = 0) {
    expect_rectangles(mesh, foliation);
    const int zeros = -analyse_topology(to_mesh(mesh)).euler - natural;
    EXPECT_EQ(static_cast<int>(foliation.singularities.size()), zeros);
    EXPECT_EQ(order_of_zeros(foliation), zeros);
    EXPECT_EQ(static_cast<int>(foliation.cylinders.size()), 2 * zeros + natural);
    EXPECT_EQ(static_cast<int>(foliation.critical_graph.size()), 4 * zeros + 2 * natural);
}

Foliation from_longest(const TriangleMesh& mesh) {
    const Loops loops = loops_of(mesh);
    const int source = longest(mesh, loops);
    return foliate_one_form(mesh, loops, {{source}, all_but(loops.size(), {source})}, {}, {});
}

TEST(OneForm, HasOneZeroBetweenTwoSinks) {
    const TriangleMesh mesh = with_discs_out(testing::make_square(40),
                                             {{{0.3, 0.35, 0.0}, 0.1}, {{0.7, 0.6, 0.0}, 0.14}});
    expect_simple_zeros(mesh, from_longest(mesh));
}

TEST(OneForm, CutsSpheresWithHolesIntoRectangles) {
    for (int holes = 3; holes <= 9; ++holes) {
        SCOPED_TRACE(holes);
        const TriangleMesh mesh = sphere_with_holes(holes);
        const Foliation foliation = from_longest(mesh);
        expect_rectangles(mesh, foliation);
        EXPECT_EQ(order_of_zeros(foliation), holes - 2);
        EXPECT_GT(static_cast<int>(foliation.cylinders.size()), holes - 2);
    }
}

TEST(OneForm, GoesRoundHandlesToo) {
    const TriangleMesh torus = with_discs_out(testing::make_torus(32, 80, 0.4),
                                              {{{1.3, 0.2, 0.0}, 0.2}, {{-0.6, -0.9, 0.3}, 0.2}});
    expect_simple_zeros(torus, from_longest(torus));

    TriangleMesh two = make_sample("double-torus", 8000);
    const auto [low, high] = std::minmax_element(
        two.positions.begin(), two.positions.end(),
        [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) { return a.x() < b.x(); });
    const double radius = 0.1 * (*high - *low).norm();
    two = with_discs_out(two, {{*low, radius}, {*high, 0.8 * radius}});
    // Symmetric: leaves run from zero to zero.
    const Foliation foliation = from_longest(two);
    expect_rectangles(two, foliation);
    EXPECT_EQ(order_of_zeros(foliation), 4);
}

TEST(OneForm, TakesAnyChoiceOfSourcesAndSinks) {
    const TriangleMesh mesh = sphere_with_holes(6);
    const Loops loops = loops_of(mesh);
    expect_simple_zeros(mesh, foliate_one_form(mesh, loops, {{0, 3}, {1, 2, 4, 5}}, {}, {}));
    expect_simple_zeros(mesh, foliate_one_form(mesh, loops, {{5, 1, 2}, {0, 3, 4}}, {}, {}));
}

TEST(OneForm, ExchangedSourcesAndSinksHaveTheSameFlux) {
    const TriangleMesh mesh = sphere_with_holes(5);
    const Loops loops = loops_of(mesh);
    const Foliation one = foliate_one_form(mesh, loops, {{0, 3}, {1, 2, 4}}, {}, {});
    const Foliation other = foliate_one_form(mesh, loops, {{1, 2, 4}, {0, 3}}, {}, {});
    EXPECT_NEAR(one.energy / other.energy, 1.0, 1e-9);
    EXPECT_EQ(one.cylinders.size(), other.cylinders.size());
}

TEST(OneForm, LeavesFlowAroundLoopsThatAreNeither) {
    const TriangleMesh mesh = sphere_with_holes(5);
    const Loops loops = loops_of(mesh);
    expect_simple_zeros(mesh, foliate_one_form(mesh, loops, {{0}, {4, 1}}, {}, {}), 2);
    expect_simple_zeros(mesh, foliate_one_form(mesh, loops, {{2}, {4}}, {}, {}), 3);
}

TEST(OneForm, MakesEqualPartsOfASymmetricSurface) {
    const TriangleMesh mesh = with_discs_out(testing::make_square(40),
                                             {{{0.25, 0.5, 0.0}, 0.11}, {{0.75, 0.5, 0.0}, 0.11}});
    const Foliation foliation = from_longest(mesh);
    expect_simple_zeros(mesh, foliation);
    ASSERT_EQ(foliation.cylinders.size(), 2U);
    EXPECT_NEAR(foliation.cylinders[0].width / foliation.cylinders[1].width, 1.0, 0.01);
    ASSERT_EQ(foliation.singularities.size(), 1U);
    EXPECT_LT((foliation.singularities[0].position - Eigen::Vector3d(0.5, 0.5, 0.0)).norm(), 0.03);
}

// The form has a triple zero in the middle, which a mesh parts into simple ones; leaves from one
// run into the next. No part of no width may be left of that.
TEST(OneForm, JoinsZerosThatTheMeshPartsFromEachOther) {
    for (const bool random : {false, true}) {
        SCOPED_TRACE(random);
        const TriangleMesh square = testing::make_grid(
            {.across = 48,
             .along = 48,
             .position = [](double u, double v) { return Eigen::Vector3d(u, v, 0.0); },
             .random_diagonals = random});
        const TriangleMesh mesh = with_discs_out(square, {{{0.25, 0.25, 0.0}, 0.1},
                                                          {{0.75, 0.25, 0.0}, 0.1},
                                                          {{0.25, 0.75, 0.0}, 0.1},
                                                          {{0.75, 0.75, 0.0}, 0.1}});
        const Foliation foliation = from_longest(mesh);
        expect_rectangles(mesh, foliation);
        EXPECT_EQ(order_of_zeros(foliation), 3);
        ASSERT_EQ(foliation.cylinders.size(), 4U);
        for (const Cylinder& part : foliation.cylinders) {
            EXPECT_NEAR(part.width / (0.5 * foliation.energy), 1.0, 0.05);
        }
    }
}

TEST(OneForm, IsOneRingBetweenTwoLoops) {
    const TriangleMesh mesh = testing::make_ring(40, 10, 0.5, 1.0);
    const Foliation foliation = foliate_one_form(mesh, loops_of(mesh), {{0}, {1}}, {}, {});
    EXPECT_EQ(foliation.mode, FoliationMode::OneForm);
    ASSERT_EQ(foliation.cylinders.size(), 1U);
    EXPECT_EQ(foliation.cylinders[0].shape, ChartShape::Annulus);
    EXPECT_TRUE(foliation.singularities.empty());
    EXPECT_NEAR(foliation.cylinders[0].width / (2.0 * std::numbers::pi / std::log(2.0)), 1.0, 0.01);
}

// The code of the error that refuses this choice on a sphere with three holes.
std::string refusal_of(const FlowEnds& ends) {
    const TriangleMesh mesh = sphere_with_holes(3);
    try {
        foliate_one_form(mesh, loops_of(mesh), ends, {}, {});
    } catch (const Error& error) {
        return error.kind() == ErrorKind::BadOption ? error.code() : "another kind";
    }
    return "nothing";
}

TEST(OneForm, RefusesLoopsThatAreNotThere) {
    EXPECT_EQ(refusal_of({{}, {1}}), "bad-sources");
    EXPECT_EQ(refusal_of({{0}, {}}), "bad-sinks");
    EXPECT_EQ(refusal_of({{3}, {1}}), "bad-sources");
    EXPECT_EQ(refusal_of({{0}, {-1}}), "bad-sinks");
    EXPECT_EQ(refusal_of({{0, 0}, {1}}), "bad-sources");
    EXPECT_EQ(refusal_of({{0, 1}, {1}}), "bad-sinks");
}

TEST(OneForm, TellsItsProgressInOrder) {
    std::vector<double> told;
    Context context;
    context.progress = [&](std::string_view, double fraction) { told.push_back(fraction); };
    const TriangleMesh mesh = sphere_with_holes(4);
    foliate_one_form(mesh, loops_of(mesh), {{0}, {1, 2, 3}}, {}, context);
    ASSERT_FALSE(told.empty());
    EXPECT_TRUE(std::is_sorted(told.begin(), told.end()));
    EXPECT_LE(told.back(), 1.0);
}

TEST(OneForm, IsTheSameWhateverTheThreads) {
    const TriangleMesh mesh = sphere_with_holes(5);
    const Loops loops = loops_of(mesh);
    Context two_threads;
    two_threads.threads = 2;
    const Foliation one = foliate_one_form(mesh, loops, {{0}, {1, 2, 3, 4}}, {}, {});
    const Foliation other = foliate_one_form(mesh, loops, {{0}, {1, 2, 3, 4}}, {}, two_threads);
    ASSERT_EQ(one.cylinders.size(), other.cylinders.size());
    for (std::size_t k = 0; k < one.cylinders.size(); ++k) {
        EXPECT_EQ(one.cylinders[k].corner_gf, other.cylinders[k].corner_gf);
        EXPECT_EQ(one.cylinders[k].mesh.positions, other.cylinders[k].mesh.positions);
    }
}

TEST(OneForm, StopsWhenAsked) {
    std::stop_source stop;
    Context context;
    context.stop = stop.get_token();
    context.progress = [&](std::string_view, double) { stop.request_stop(); };
    const TriangleMesh mesh = sphere_with_holes(4);
    EXPECT_THROW(foliate_one_form(mesh, loops_of(mesh), {{0}, {1, 2, 3}}, {}, context), Cancelled);
}

// Needles, slivers and jitter: the same number of zeros and parts, or the count is not topology's.
TEST(OneForm, CountsTheSameOnBadTriangles) {
    std::minstd_rand random(11);
    for (int round = 0; round < 2; ++round) {
        SCOPED_TRACE(round);
        TriangleMesh square = testing::make_grid(
            {.across = 30,
             .along = 30,
             .position = [](double u, double v) { return Eigen::Vector3d(u, v, 0.0); },
             .random_diagonals = true,
             .seed = static_cast<unsigned>(round)});
        testing::jitter(square, 0.008, random);
        TriangleMesh mesh = with_discs_out(
            square, {{{0.3, 0.3, 0.0}, 0.1}, {{0.7, 0.4, 0.0}, 0.12}, {{0.45, 0.75, 0.0}, 0.09}});
        testing::add_needles(mesh, 200, random);
        const Foliation foliation = from_longest(mesh);
        expect_rectangles(mesh, foliation);
        EXPECT_EQ(order_of_zeros(foliation), 2);
        EXPECT_EQ(foliation.cylinders.size(), 4U);
    }
}

// The paper's hand: eight rectangles from the wrist to five finger tips (table 2).
TEST(OneForm, CutsTheHandIntoEightRectangles) {
    const std::filesystem::path path =
        std::filesystem::path(LEAFCUTTER_SHARED_DIR) / "data" / "meshes" / "hand-6-boundaries.obj";
    std::ifstream file(path, std::ios::binary);
    if (!file) {
        GTEST_SKIP() << "no shared data";
    }
    const std::vector<char> bytes((std::istreambuf_iterator<char>(file)), {});
    const RepairedMesh repaired =
        repair(read_mesh(std::as_bytes(std::span(bytes)), path.filename().string()));
    const TriangleMesh mesh = to_triangle_mesh(repaired.mesh);
    const Foliation foliation = from_longest(mesh);
    expect_simple_zeros(mesh, foliation);
    EXPECT_EQ(foliation.cylinders.size(), 8U);
    EXPECT_TRUE(foliation.warnings.empty());
}

// The surface and the form that one_form.cpp solves for, to look at what it cuts.
struct Cut {
    ChartSurface surface;
    ConjugateForm form;
    FormZeros zeros;
};

Cut solve(const TriangleMesh& mesh) {
    const Loops loops = loops_of(mesh);
    const int source = longest(mesh, loops);
    std::vector<std::uint8_t> lines(mesh.positions.size(), 0);
    for (std::size_t k = 0; k < loops.size(); ++k) {
        for (const int v : loops[k]) {
            lines[at(v)] = static_cast<std::uint8_t>(
                BoundaryLoop | (static_cast<int>(k) == source ? SourceLoop : SinkLoop));
        }
    }
    Cut cut;
    cut.surface = start_surface(mesh, lines);
    cut.form = solve_conjugate_form(cut.surface);
    cut.zeros = make_regular(cut.surface, cut.form.rise, FormRepair::Everywhere);
    return cut;
}

TEST(ConjugateForm, RisesByTheFluxRoundTheSourceAndNowhereElse) {
    const TriangleMesh mesh = sphere_with_holes(5);
    const Cut cut = solve(mesh);
    double source = 0.0;
    double all = 0.0;
    for (const std::vector<int>& walk : boundary_walks(cut.surface.edges)) {
        for (const int h : walk) {
            all += cut.form.rise[at(h)];
            const bool is_source =
                (cut.surface.lines[at(cut.surface.edges.from_of(h))] & SourceLoop) != 0;
            source += is_source ? cut.form.rise[at(h)] : 0.0;
        }
    }
    EXPECT_NEAR(source / cut.form.flux, 1.0, 1e-9);
    EXPECT_NEAR(all, 0.0, 1e-9);
    for (int h = 0; h < cut.surface.edges.size(); h += 3) {
        ASSERT_NEAR(cut.form.rise[at(h)] + cut.form.rise[at(h + 1)] + cut.form.rise[at(h + 2)], 0.0,
                    1e-12);
    }
    // The conjugate has no less energy, and as much in the limit.
    EXPECT_GE(cut.form.conjugate, cut.form.flux);
    EXPECT_LT(cut.form.conjugate, 1.05 * cut.form.flux);
}

TEST(LeafCut, LeavesOnlyRiseFromSourceToSink) {
    const Cut cut = solve(sphere_with_holes(6));
    const CutSurface surface = cut_along_leaves(cut.surface, cut.form, cut.zeros.zeros, {});
    EXPECT_LT(surface.worst_turn, 1e-3);
    EXPECT_EQ(cut_lines(surface).size(), 4 * cut.zeros.zeros.size());
    double flux = 0.0;
    for (const FormPart& part : separate_parts(surface)) {
        EXPECT_GT(part.flux, 0.0);
        flux += part.flux;
    }
    EXPECT_NEAR(flux / cut.form.flux, 1.0, 1e-9);
}

}  // namespace
}  // namespace leafcutter::geometry
