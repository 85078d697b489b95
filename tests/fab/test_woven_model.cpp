#include <cmath>
#include <map>
#include <numbers>

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "fab/strips/crossings.h"
#include "fab/weave/slab.h"
#include "fab/weave/thickness.h"
#include "fab/weave/weave.h"
#include "fab/weave/woven_gaps.h"
#include "fab/weave/woven_model.h"
#include "geometry/quads/threads.h"
#include "geometry/samples.h"
#include "geometry/surface_measures.h"
#include "tests/geometry/surfaces.h"
#include "tests/support/quad_grids.h"

namespace leafcutter::fab {
namespace {

using Eigen::Vector3d;
using geometry::ChartShape;
using geometry::QuadMesh;

constexpr double kPi = std::numbers::pi;

const WovenRules kPaper{
    .thickness_mm = {0.2, 0.2}, .min_width_mm = {1.0, 1.0}, .clearance_mm = 0.2};

struct Woven {
    std::vector<Strip> strips;
    Crossings crossings;
    WovenModel model;
};

Woven woven(const QuadMesh& mesh,
            const WovenRules& rules = kPaper,
            WeavePattern pattern = WeavePattern::Plain) {
    Woven result;
    for (const Family family : {Family::Weft, Family::Warp}) {
        for (const geometry::Thread& thread :
             geometry::trace_threads(mesh, family, geometry::ThreadEnds::AtCriticalLeaves)) {
            Strip& strip = result.strips.emplace_back();
            strip.id = fmt::format("{}", result.strips.size());
            strip.family = family;
            strip.closed = thread.closed;
            strip.quads = thread.quads;
        }
    }
    WeaveParams params;
    params.pattern = pattern;
    result.crossings = crossings_of(result.strips, weave_cells(mesh, params));
    result.model = build_woven_model(mesh, result.strips, result.crossings, rules);
    return result;
}

QuadMesh saddle() {
    return test::quad_grid({12, 12}, ChartShape::Rectangle, [](double g, double f) {
        const double x = 120.0 * (g - 0.5);
        const double y = 120.0 * (f - 0.5);
        return Vector3d(x, y, x * y / 60.0);
    });
}

// A band of the sphere between 70° south and north.
QuadMesh sphere() {
    return test::quad_grid({12, 24}, ChartShape::Annulus, [](double g, double f) {
        const double latitude = 140.0 / 180.0 * kPi * (f - 0.5);
        const double longitude = 2.0 * kPi * g;
        return Vector3d(40.0 * std::cos(latitude) * std::cos(longitude),
                        40.0 * std::cos(latitude) * std::sin(longitude), 40.0 * std::sin(latitude));
    });
}

// Two holes: singular points with six cells round them.
QuadMesh eight() {
    const geometry::Foliation foliation = geometry::compute_foliation(
        leafcutter::testing::to_mesh(geometry::make_sample("eight", 3000)));
    double area = 0.0;
    for (const geometry::Cylinder& cylinder : foliation.cylinders) {
        area += geometry::surface_area(cylinder.mesh);
    }
    geometry::GridOptions grid;
    grid.strip_width_mm = std::sqrt(area / 600.0);
    QuadMesh mesh = geometry::build_quad_mesh(foliation, grid);
    for (Vector3d& vertex : mesh.vertices) {
        vertex *= 10.0 / grid.strip_width_mm;
    }
    return mesh;
}

void expect_no_contact(const Woven& made) {
    ASSERT_TRUE(made.model.smallest_gap_mm);
    EXPECT_GT(*made.model.smallest_gap_mm, 0.0);
    EXPECT_LT(*made.model.smallest_gap_mm, 0.01) << "strips that cross touch";
    EXPECT_EQ(made.model.overlaps, 0);
    EXPECT_EQ(made.model.side_overlaps, 0);
}

double volume(const Solid& solid) {
    double sum = 0.0;
    for (const auto& [i, j, k] : solid.triangles) {
        const auto at = [&](int v) -> const Vector3d& {
            return solid.vertices[static_cast<std::size_t>(v)];
        };
        sum += at(i).dot(at(j).cross(at(k))) / 6.0;
    }
    return sum;
}

double middle_area(const WovenStrip& strip) {
    double sum = 0.0;
    for (std::size_t i = 0; i < strip.segments.size(); ++i) {
        const WovenRung& one = strip.rungs[i];
        const WovenRung& two = strip.rungs[(i + 1) % strip.rungs.size()];
        sum += (two.left - one.right).cross(one.left - one.right).norm() / 2.0 +
               (two.left - one.right).cross(two.right - one.right).norm() / 2.0;
    }
    return sum;
}

double middle_length(const WovenStrip& strip) {
    double sum = 0.0;
    for (std::size_t i = 0; i < strip.segments.size(); ++i) {
        const WovenRung& one = strip.rungs[i];
        const WovenRung& two = strip.rungs[(i + 1) % strip.rungs.size()];
        sum += (two.left + two.right - one.left - one.right).norm() / 2.0;
    }
    return sum;
}

TEST(WovenModel, LaysNoStripIntoAnother) {
    for (const WeavePattern pattern :
         {WeavePattern::Plain, WeavePattern::Twill2x2, WeavePattern::Satin5,
          WeavePattern::Basket2x2, WeavePattern::DoubleWarp, WeavePattern::DoubleWeft}) {
        expect_no_contact(woven(test::flat_grid({10, 10}, 10.0), kPaper, pattern));
        expect_no_contact(woven(saddle(), kPaper, pattern));
        expect_no_contact(woven(sphere(), kPaper, pattern));
        expect_no_contact(woven(test::torus_grid({40, 20}, 60.0, 25.0), kPaper, pattern));
    }
}

TEST(WovenModel, KeepsApartWhereSixCellsMeet) {
    const QuadMesh mesh = eight();
    ASSERT_GT(mesh.quads.size(), 300U);
    expect_no_contact(woven(mesh));
}

TEST(WovenModel, TakesFamiliesOfDifferentThickness) {
    WovenRules rules = kPaper;
    rules.thickness_mm = {0.1, 0.35};
    expect_no_contact(woven(saddle(), rules));
    expect_no_contact(woven(sphere(), rules));
}

TEST(WovenModel, CountsStripsThatAreTooThickForTheirGaps) {
    WovenRules rules = kPaper;
    rules.thickness_mm = {1.5, 1.5};
    const Woven thick = woven(test::flat_grid({10, 10}, 10.0), rules);
    EXPECT_EQ(thick.model.tight_crossings, 100);
    EXPECT_GT(thick.model.lacking_mm, 0.5);
    ASSERT_EQ(thick.model.tight.size(), 200U);
    EXPECT_EQ(thick.model.tight.front().depth_mm, thick.model.lacking_mm);
    // Drawn narrower, they pass.
    EXPECT_GT(thick.model.narrowed_mm, 0.3);
    expect_no_contact(thick);

    rules.clearance_mm = clearance_need({1.5, 0.0}, {1.5, 0.0}).pass_mm;
    const Woven loose = woven(test::flat_grid({10, 10}, 10.0), rules);
    expect_no_contact(loose);
    EXPECT_EQ(loose.model.tight_crossings, 0);
    EXPECT_EQ(loose.model.narrowed_cells, 0);
}

TEST(WovenModel, DrawsStripsNarrowerWhereTheSurfaceIsCreased) {
    // Two walls that meet at an angle of 60 degrees.
    const QuadMesh mesh = test::quad_grid({8, 8}, ChartShape::Rectangle, [](double g, double f) {
        const double x = 80.0 * (g - 0.5);
        return Vector3d(0.5 * x, 80.0 * f, std::abs(x) * std::sqrt(0.75));
    });
    const Woven made = woven(mesh);
    EXPECT_GT(made.model.tight_crossings, 0);
    EXPECT_LE(made.model.tight_crossings, 16) << "the cells along the crease";
    EXPECT_EQ(made.model.overlaps, 0);
    EXPECT_EQ(made.model.side_overlaps, 0);
    EXPECT_GT(*made.model.smallest_gap_mm, 0.0);
    EXPECT_LT(made.model.narrowed_mm, 0.5);
}

TEST(WovenModel, SeesAStripThatLiesInItsNeighbour) {
    Woven made = woven(test::flat_grid({6, 6}, 10.0));
    ASSERT_NEAR(*made.model.smallest_side_gap_mm, 0.4, 1e-9);
    for (WovenRung& rung : made.model.strips[2].rungs) {
        rung.left += Vector3d(0.0, 0.5, 0.0);
    }
    measure_gaps(made.strips, made.model);
    EXPECT_NEAR(*made.model.smallest_side_gap_mm, -0.1, 1e-9);
    EXPECT_GT(made.model.side_overlaps, 0);
}

TEST(WovenModel, MakesClosedSolidsFacingOut) {
    for (const QuadMesh& mesh : {test::flat_grid({8, 8}, 10.0), saddle(), sphere(),
                                 test::torus_grid({40, 20}, 60.0, 25.0)}) {
        const Woven made = woven(mesh);
        const std::vector<Solid> solids = solids_of(made.strips, made.model);
        ASSERT_EQ(solids.size(), made.strips.size());
        for (std::size_t i = 0; i < solids.size(); ++i) {
            std::map<std::pair<int, int>, int> edges;
            for (const auto& t : solids[i].triangles) {
                for (std::size_t k = 0; k < 3; ++k) {
                    ++edges[{t[k], t[(k + 1) % 3]}];
                }
            }
            for (const auto& [edge, count] : edges) {
                ASSERT_EQ(count, 1) << solids[i].name;
                ASSERT_TRUE(edges.contains({edge.second, edge.first})) << solids[i].name;
            }
            const double expected = 0.2 * middle_area(made.model.strips[i]);
            EXPECT_NEAR(volume(solids[i]), expected, 0.02 * expected) << solids[i].name;
        }
    }
}

TEST(WovenModel, IsAsLongAsStripsAreCut) {
    const Woven made = woven(test::flat_grid({10, 10}, 10.0));
    const std::vector<double> lengths(10, 10.0);
    for (std::size_t i = 0; i < made.strips.size(); ++i) {
        double cut = 10 * 10.0;
        for (const double extra :
             crimp_extra_mm(made.crossings[i], lengths, {0.2, 0.2, 0.4, 0.0}, false)) {
            cut += extra;
        }
        // Its ends stop half a clearance before the border; chords are shorter than arcs.
        EXPECT_NEAR(middle_length(made.model.strips[i]), cut - 0.2, 0.004 * 9);
    }
}

TEST(WovenModel, LiesOverAndUnderAsTheWeaveSays) {
    const Woven made = woven(test::flat_grid({6, 6}, 10.0), kPaper, WeavePattern::Twill2x2);
    for (std::size_t i = 0; i < made.strips.size(); ++i) {
        const WovenStrip& strip = made.model.strips[i];
        for (std::size_t k = 0; k < strip.segments.size(); ++k) {
            if (strip.segments[k].crossing) {
                const bool top =
                    made.crossings[i][static_cast<std::size_t>(strip.segments[k].cell)].on_top;
                EXPECT_NEAR(strip.rungs[k].left.z(), top ? 0.101 : -0.101, 1e-9);
                EXPECT_NEAR(strip.rungs[k + 1].right.z(), top ? 0.101 : -0.101, 1e-9);
            }
        }
    }
}

}  // namespace
}  // namespace leafcutter::fab
