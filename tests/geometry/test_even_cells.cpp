// Weights that suit the grid: whole columns at the junctions, cells of even area.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stop_token>
#include <vector>

#include <gtest/gtest.h>

#include "geometry/foliation.h"
#include "geometry/pants/coarse_maps.h"
#include "geometry/pants/even_maps.h"
#include "geometry/pants/fit_weights.h"
#include "geometry/pants/hierarchy.h"
#include "geometry/pants/prepare_surface.h"
#include "geometry/quads/critical_arcs.h"
#include "geometry/quads/junction_counts.h"
#include "geometry/quads/quad_mesh.h"
#include "geometry/quads/relaxed_arcs.h"
#include "geometry/samples.h"
#include "geometry/surface_measures.h"
#include "tests/geometry/surfaces.h"

namespace leafcutter::geometry {
namespace {

using testing::to_mesh;

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

GridOptions grid_of(const TriangleMesh& mesh, double cells) {
    GridOptions grid;
    grid.strip_width_mm = std::sqrt(surface_area(mesh) / cells);
    return grid;
}

JunctionCounts counts_of(const Foliation& foliation, const ArcNetwork& network, double cells) {
    JunctionWish wish;
    wish.cells = cells;
    wish.counts.resize(foliation.cylinders.size());
    wish.paths.assign(foliation.cylinders.size(), "grid");
    return JunctionCounter(foliation, network, wish).choose(cells, {});
}

double variation(const QuadMesh& quads) {
    double sum = 0.0;
    double squares = 0.0;
    for (const double area : quads.surface_area) {
        sum += area;
        squares += area * area;
    }
    const auto count = static_cast<double>(quads.surface_area.size());
    return std::sqrt(squares * count / (sum * sum) - 1.0);
}

class EightsWeights : public ::testing::Test {
protected:
    EightsWeights() {
        const PreparedSurface prepared =
            prepare_surface(make_sample("eight", 5000), {}, {}, Refinement::Allowed, {});
        hierarchy = build_hierarchy(prepared.surface, prepared.boundary_lines, 6000, {});
        maps = solve_coarsest(hierarchy, {}, {});
        solve_harmonic_map(maps.front().map, level().flipped.rings, level().flipped.weights,
                           MapStart::Warm, {});
    }

    const Hierarchy::Level& level() const { return hierarchy.levels.back(); }
    const GraphMap& map() const { return maps.front().map; }
    std::vector<double> circumferences_of(const GraphMap& solved) const {
        return circumferences(solved, level().flipped.rings, level().flipped.weights);
    }
    CircumferenceWish wish(const std::vector<double>& factors) const {
        CircumferenceWish wish;
        wish.circumferences = circumferences_of(map());
        for (std::size_t e = 0; e < factors.size(); ++e) {
            wish.circumferences[e] *= factors[e];
        }
        wish.columns.assign(factors.size(), 40.0);
        wish.weights = weights_of(map().graph);
        return wish;
    }

    Hierarchy hierarchy;
    std::vector<CoarseMap> maps;
};

// Twice the energy is the sum of weight x circumference.
TEST_F(EightsWeights, HaveCircumferencesThatShareOutTheEnergy) {
    const std::vector<double> around = circumferences_of(map());
    double sum = 0.0;
    for (std::size_t e = 0; e < around.size(); ++e) {
        EXPECT_GT(around[e], 0.0);
        sum += around[e] * map().graph.edges[e].weight;
    }
    const double energy = map_energy(map(), level().flipped.rings, level().flipped.weights);
    EXPECT_NEAR(sum / (2.0 * energy), 1.0, 1e-9);
}

TEST_F(EightsWeights, ReachCircumferencesInWantedProportions) {
    const CircumferenceWish wanted = wish({1.01, 0.995, 1.0});
    const std::vector<double> found = circumferences_of(fit_weights(level(), map(), wanted, {}));
    for (std::size_t e = 1; e < found.size(); ++e) {
        const double wished = wanted.circumferences[e] / wanted.circumferences[0];
        EXPECT_NEAR(found[e] / found[0] / wished, 1.0, 1e-3) << "cylinder " << e;
    }
}

TEST_F(EightsWeights, MoveNoFurtherThanAllowed) {
    CircumferenceWish far = wish({1.5, 0.7, 1.0});
    far.most_change = 0.05;
    const std::vector<double> found = weights_of(fit_weights(level(), map(), far, {}).graph);
    double moved = 0.0;
    for (std::size_t a = 0; a < found.size(); ++a) {
        for (std::size_t b = 0; b < found.size(); ++b) {
            const double change = found[a] / found[b] / (far.weights[a] / far.weights[b]) - 1.0;
            EXPECT_LE(change, 0.0501);
            moved = std::max(moved, change);
        }
    }
    EXPECT_GT(moved, 0.02);  // It did try.
}

TEST_F(EightsWeights, EvenOutTheForecast) {
    constexpr double kCells = 1000.0;
    const double before = forecast_grid(level(), map(), kCells).variation;
    const std::vector<CoarseMap> evened = even_maps(hierarchy, maps, kCells, {});
    EXPECT_GT(evened.size(), maps.size());  // All others stay, for where the best fail.
    const GridForecast after = forecast_grid(level(), evened.front().map, kCells);
    EXPECT_LE(after.variation, before);
    EXPECT_GE(after.least_rows, 3.0);
}

class SuitedEight : public ::testing::Test {
protected:
    static constexpr double kCells = 1500.0;
    TriangleMesh triangles = make_sample("eight", 5000);
    Mesh mesh = to_mesh(triangles);
};

TEST_F(SuitedEight, MeetsInWholeColumnsWithoutLosingTheUsersProportions) {
    FoliationOptions options;
    options.function = SweepFunction::Harmonic;
    options.weights = {1.0, 0.4, 1.1};
    const Foliation asked = compute_foliation(mesh, options);
    options.junctions = {.cells = kCells, .even_columns = true};
    const Foliation used = compute_foliation(mesh, options);
    for (std::size_t a = 0; a < 3; ++a) {
        for (std::size_t b = 0; b < 3; ++b) {
            const double wished = (*options.weights)[a] / (*options.weights)[b];
            const double found = used.graph.edges[a].weight / used.graph.edges[b].weight;
            EXPECT_NEAR(found / wished, 1.0, 0.0501);
        }
    }
    const double before = counts_of(asked, find_arcs(asked), kCells).distortion;
    const double after = counts_of(used, find_arcs(used), kCells).distortion;
    EXPECT_LE(after, before);
}

TEST_F(SuitedEight, IsTheSameOnAnyNumberOfThreads) {
    FoliationOptions options;
    options.even_cells = true;
    options.junctions = {.cells = kCells, .even_columns = true};
    Context two;
    two.threads = 2;
    const Foliation one = compute_foliation(mesh, options);
    const Foliation other = compute_foliation(mesh, options, two);
    for (std::size_t e = 0; e < one.graph.edges.size(); ++e) {
        EXPECT_EQ(one.graph.edges[e].weight, other.graph.edges[e].weight);
        EXPECT_EQ(one.cylinders[e].width, other.cylinders[e].width);
    }
}

TEST_F(SuitedEight, CanBeStopped) {
    std::stop_source source;
    FoliationOptions options;
    options.even_cells = true;
    options.junctions = {.cells = kCells, .even_columns = true};
    Context context;
    context.stop = source.get_token();
    context.progress = [&](std::string_view, double fraction) {
        if (fraction >= 0.06) {
            source.request_stop();
        }
    };
    EXPECT_THROW(compute_foliation(mesh, options, context), Cancelled);
}

TEST_F(SuitedEight, HasEvenerCellsOnRequest) {
    GridOptions grid = grid_of(triangles, kCells);
    const double before = variation(build_quad_mesh(compute_foliation(mesh), grid));
    FoliationOptions options;
    options.even_cells = true;
    grid.even_cells = true;
    const Foliation even = compute_foliation(mesh, options);
    ASSERT_TRUE(even.evened.has_value());
    EXPECT_LE(even.evened->after, even.evened->before);
    EXPECT_LT(variation(build_quad_mesh(even, grid)), 0.98 * before);
}

// Columns slide along arcs, in order, the same from both sides.
TEST_F(SuitedEight, HasArcsAlongWhichColumnsSlide) {
    const Foliation foliation = compute_foliation(mesh);
    const ArcNetwork network = find_arcs(foliation);
    const JunctionCounts counts = counts_of(foliation, network, kCells);
    const ArcNetwork relaxed = relax_arcs(foliation, network, counts, {});
    double moved = 0.0;
    for (std::size_t a = 0; a < network.arcs.size(); ++a) {
        const std::vector<double>& now = relaxed.arcs[a].parameter;
        EXPECT_EQ(now.front(), 0.0);
        EXPECT_EQ(now.back(), 1.0);
        EXPECT_TRUE(std::is_sorted(now.begin(), now.end()));
        for (std::size_t k = 0; k < now.size(); ++k) {
            moved = std::max(moved,
                             std::abs(now[k] - network.arcs[a].parameter[k]) * counts.arc_cells[a]);
        }
    }
    EXPECT_GT(moved, 1e-3);
    EXPECT_LT(moved, 1.0);
    for (const int c : network.cylinders) {
        for (const CylinderEnd& end : relaxed.ends[at(c)]) {
            const std::vector<double> columns = column_positions(end, counts.arc_cells);
            EXPECT_TRUE(std::is_sorted(columns.begin(), columns.end()));
            EXPECT_EQ(columns.back(), counts.cols[at(c)]);
        }
    }
}

}  // namespace
}  // namespace leafcutter::geometry
