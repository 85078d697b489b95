#include <filesystem>
#include <fstream>
#include <iterator>
#include <numeric>
#include <random>
#include <span>

#include <gtest/gtest.h>

#include "fab/weave/assembly.h"
#include "fab/weave/openings.h"
#include "geometry/foliation.h"
#include "geometry/io/read_mesh.h"
#include "geometry/repair.h"
#include "geometry/samples.h"
#include "geometry/surface_measures.h"
#include "geometry/topology.h"
#include "tests/geometry/surfaces.h"
#include "tests/support/cut_strips.h"
#include "tests/support/quad_grids.h"

namespace leafcutter::fab {
namespace {

using test::Cutting;

struct Job {
    test::CutStrips cut;
    Crossings crossings;
    Assembly assembly;

    std::optional<AssemblyFault> fault() const {
        return check_assembly(cut.strips, cut.pieces, crossings, assembly);
    }
    const Strip& strip(const AssemblyMove& move) const {
        return cut.strips[static_cast<std::size_t>(move.strip)];
    }
    std::vector<std::string> laid() const {
        std::vector<std::string> ids;
        for (const AssemblyMove& move : assembly.moves) {
            if (move.kind == MoveKind::Lay || move.kind == MoveKind::Thread) {
                ids.push_back(strip(move).id);
            }
        }
        return ids;
    }
};

Job plan(const geometry::QuadMesh& mesh, const Weave& weave, test::CutStrips cut) {
    Job job;
    job.cut = std::move(cut);
    job.crossings = crossings_of(job.cut.strips, weave);
    job.assembly = plan_assembly(mesh, job.cut.strips, job.cut.pieces, job.crossings);
    const auto fault = job.fault();
    EXPECT_FALSE(fault) << "move " << fault->move << ": " << fault->what;
    return job;
}

Job plan(const geometry::QuadMesh& mesh, const Weave& weave, const Cutting& cutting) {
    return plan(mesh, weave, test::cut_strips(mesh, cutting));
}

Job plan(const geometry::QuadMesh& mesh,
         WeavePattern pattern = WeavePattern::Plain,
         const Cutting& cutting = {}) {
    WeaveParams params;
    params.pattern = pattern;
    return plan(mesh, weave_cells(mesh, params), cutting);
}

geometry::QuadMesh grid_of(const geometry::Mesh& mesh,
                           double area,
                           double cells,
                           geometry::FoliationMode mode = geometry::FoliationMode::Auto,
                           geometry::Junctions junctions = geometry::Junctions::Conforming) {
    geometry::FoliationOptions options;
    options.mode = mode;
    geometry::GridOptions grid;
    grid.strip_width_mm = std::sqrt(area / cells);
    grid.junctions = junctions;
    return geometry::build_quad_mesh(geometry::compute_foliation(mesh, options), grid);
}

geometry::QuadMesh sample_grid(std::string_view name,
                               double cells,
                               geometry::FoliationMode mode = geometry::FoliationMode::Auto,
                               geometry::Junctions junctions = geometry::Junctions::Conforming) {
    const geometry::TriangleMesh triangles = geometry::make_sample(name, 2500);
    return grid_of(testing::to_mesh(triangles), geometry::surface_area(triangles), cells, mode,
                   junctions);
}

constexpr std::array kPatterns{WeavePattern::Plain,      WeavePattern::Twill2x2,
                               WeavePattern::DoubleWarp, WeavePattern::DoubleWeft,
                               WeavePattern::Satin5,     WeavePattern::Basket2x2};

int golden(int strip, int count) {
    return static_cast<int>(0.618034 * strip * count) % count;
}

TEST(PlanAssembly, LaysTheWarpOfASheetThenRowAfterRow) {
    const Job job = plan(test::flat_grid({3, 4}, 10.0));
    EXPECT_EQ(job.laid(), (std::vector<std::string>{"P1", "P2", "P3", "P4", "W1", "W2", "W3"}));
    EXPECT_EQ(job.assembly.laid, 7);
    EXPECT_EQ(job.assembly.threaded, 0);
    EXPECT_EQ(job.assembly.moves.size(), 7U);
    EXPECT_EQ(job.assembly.moves.back().cells, (std::vector<int>{0, 1, 2, 3}));
}

TEST(PlanAssembly, ClosesEachRingBeforeTheNextOne) {
    const Job job = plan(test::cylinder_grid({5, 8}, 20.0, 50.0), WeavePattern::Plain,
                         {.opening = [](int strip) { return 3 * strip; }});
    ASSERT_EQ(job.assembly.moves.size(), 8U + 2U * 5U);
    for (std::size_t row = 0; row < 5; ++row) {
        const AssemblyMove& lay = job.assembly.moves[8 + 2 * row];
        const AssemblyMove& close = job.assembly.moves[9 + 2 * row];
        EXPECT_EQ(lay.kind, MoveKind::Lay);
        EXPECT_EQ(job.strip(lay).id, fmt::format("W{}", row + 1));
        EXPECT_EQ(lay.cells.front(), static_cast<int>(3 * row % 8));
        EXPECT_EQ(close.kind, MoveKind::Close);
        EXPECT_EQ(close.strip, lay.strip);
        EXPECT_EQ(close.tucked, 0);
    }
}

TEST(PlanAssembly, NeedsNoThreadWhereEndsOfATorusLieInOneLine) {
    for (const WeavePattern pattern : kPatterns) {
        const Job job = plan(test::torus_grid({20, 20}, 50.0, 15.0), pattern);
        EXPECT_EQ(job.assembly.threaded, 0);
        EXPECT_EQ(job.assembly.place_joints, 40);
    }
}

TEST(PlanAssembly, ThreadsWhereEndsOfATorusLieApart) {
    const Job job = plan(test::torus_grid({12, 12}, 50.0, 15.0), WeavePattern::Plain,
                         {.opening = [](int strip) { return golden(strip, 12); }});
    EXPECT_GT(job.assembly.threaded, 0);
    EXPECT_GT(job.assembly.longest_thread, 1);
}

TEST(PlanAssembly, OpensAClosedStripAtTheJointThatSavesThreading) {
    // Columns in three pieces, every other one begun elsewhere, but all with one joint in a line.
    const Cutting cutting{.most_cells = 4, .opening = [](int strip) { return 4 * (strip % 2); }};
    const Job job = plan(test::torus_grid({12, 12}, 50.0, 15.0), WeavePattern::Plain, cutting);
    EXPECT_EQ(job.assembly.threaded, 0);
    EXPECT_EQ(job.assembly.table_joints, 2 * 24);
    EXPECT_EQ(job.assembly.place_joints, 24);
}

TEST(PlanAssembly, JoinsPiecesOfAnOpenStripOnTheTable) {
    const Job job = plan(test::flat_grid({6, 9}, 10.0), WeavePattern::Twill2x2, {.most_cells = 4});
    EXPECT_EQ(job.assembly.table_joints, 6 * 2 + 9 * 1);
    EXPECT_EQ(job.assembly.place_joints, 0);
}

TEST(PlanAssembly, LaysOneLayerOnTheOtherWithoutFolding) {
    const Job job = plan(test::cylinder_grid({5, 8}, 20.0, 50.0), WeavePattern::DoubleWarp);
    EXPECT_EQ(job.assembly.regions.front().base, Family::Weft);
    // A ring that nothing goes under is closed at once.
    EXPECT_EQ(job.assembly.moves[0].kind, MoveKind::Lay);
    EXPECT_EQ(job.assembly.moves[1].kind, MoveKind::Close);
    for (const AssemblyMove& move : job.assembly.moves) {
        for (const int cell : move.cells) {
            EXPECT_TRUE(
                job.crossings[static_cast<std::size_t>(move.strip)][static_cast<std::size_t>(cell)]
                    .on_top);
        }
    }
    EXPECT_EQ(
        plan(test::flat_grid({5, 8}, 10.0), WeavePattern::DoubleWeft).assembly.regions.front().base,
        Family::Warp);
}

TEST(PlanAssembly, MakesEveryMovePossibleOnSamples) {
    using geometry::FoliationMode;
    struct Case {
        const char* name;
        FoliationMode mode = FoliationMode::Auto;
    };
    for (const Case& shape : {Case{"vase"}, Case{"face"}, Case{"torus"}, Case{"eight"},
                              Case{"hand"}, Case{"sphere", FoliationMode::SpherePillowcase},
                              Case{"sphere", FoliationMode::Annulus}}) {
        const auto mesh = sample_grid(shape.name, 500.0, shape.mode);
        for (const WeavePattern pattern : kPatterns) {
            for (const bool through : {false, true}) {
                SCOPED_TRACE(shape.name);
                const Job job = plan(mesh, pattern,
                                     {.most_cells = 11,
                                      .opening = [](int strip) { return 7 * strip; },
                                      .through = through});
                EXPECT_EQ(job.assembly.laid + job.assembly.threaded,
                          std::count_if(job.assembly.moves.begin(), job.assembly.moves.end(),
                                        [](const AssemblyMove& m) { return !m.pieces.empty(); }));
            }
        }
    }
}

TEST(PlanAssembly, NeedsNoThreadCylinderByCylinder) {
    for (const auto junctions :
         {geometry::Junctions::Conforming, geometry::Junctions::Independent}) {
        for (const char* name : {"eight", "hand"}) {
            const auto mesh = sample_grid(name, 800.0, geometry::FoliationMode::Auto, junctions);
            for (const WeavePattern pattern : kPatterns) {
                const Job job = plan(mesh, pattern);
                EXPECT_EQ(job.assembly.threaded, 0);
                EXPECT_EQ(job.assembly.regions.size(), mesh.grids.size());
            }
        }
    }
}

const geometry::QuadMesh& eight() {
    static const geometry::QuadMesh mesh = sample_grid("eight", 500.0);
    return mesh;
}

TEST(PlanAssembly, JoinsRegionsLast) {
    const auto& mesh = eight();
    const Job job = plan(mesh);
    std::size_t strips_joined = 0;
    int region = 0;
    for (const AssemblyMove& move : job.assembly.moves) {
        const bool between =
            move.kind == MoveKind::Join && !job.strip(move).next.empty() && move.in_place;
        strips_joined += between ? 1 : 0;
        EXPECT_TRUE(between || strips_joined == 0);
        EXPECT_TRUE(between || move.region == region || move.region == region + 1);
        region = between ? region : move.region;
    }
    EXPECT_EQ(strips_joined, static_cast<std::size_t>(std::count_if(
                                 job.cut.strips.begin(), job.cut.strips.end(),
                                 [](const Strip& strip) { return !strip.next.empty(); })));
    EXPECT_GT(strips_joined, 0U);
}

TEST(PlanAssembly, GrowsOnlyWhereSomethingLies) {
    const Job job = plan(eight(), WeavePattern::Plain, {.through = true});
    std::vector<char> lies(job.cut.strips.size(), 0);
    int begun = -1;
    for (const AssemblyMove& move : job.assembly.moves) {
        if (move.cells.empty()) {
            continue;
        }
        const auto& crossings = job.crossings[static_cast<std::size_t>(move.strip)];
        const bool touches = std::any_of(crossings.begin(), crossings.end(), [&](auto& c) {
            return lies[static_cast<std::size_t>(c.strip)] != 0;
        });
        EXPECT_TRUE(touches || move.region != begun);
        begun = move.region;
        for (const Crossing& crossing : crossings) {
            lies[static_cast<std::size_t>(crossing.strip)] = 1;
        }
    }
}

TEST(PlanAssembly, MakesEveryMovePossibleOnSharedMeshes) {
    const auto folder = std::filesystem::path(LEAFCUTTER_SHARED_DIR) / "data/meshes";
    if (!std::filesystem::exists(folder / "eight-7k.off")) {
        GTEST_SKIP() << "no shared meshes";
    }
    for (const char* name : {"eight-7k.off", "hand-6-boundaries.obj", "cat-7-boundaries.obj",
                             "face-gu.off", "bunny.off", "fertility.off", "torus.off"}) {
        SCOPED_TRACE(name);
        std::ifstream file(folder / name, std::ios::binary);
        const std::string bytes((std::istreambuf_iterator<char>(file)), {});
        const geometry::Mesh mesh =
            geometry::repair(geometry::read_mesh(std::as_bytes(std::span(bytes)), name)).mesh;
        const double area = geometry::surface_area(geometry::to_triangle_mesh(mesh));
        const geometry::QuadMesh quads = grid_of(mesh, area, 2000.0);
        const Job job = plan(quads, WeavePattern::Plain, {.most_cells = 60});
        EXPECT_EQ(job.assembly.threaded, 0);
        plan(quads, WeavePattern::Twill2x2,
             {.most_cells = 60, .opening = [](int strip) { return 7 * strip; }, .through = true});
    }
}

TEST(PlanAssembly, FindsAWayForAnyMatrixAndAnyJoints) {
    std::mt19937 random(5);
    for (int round = 0; round < 60; ++round) {
        const test::GridSize size{3 + static_cast<int>(random() % 6),
                                  3 + static_cast<int>(random() % 6)};
        geometry::QuadMesh mesh = round % 2 == 0 ? test::torus_grid(size, 50.0, 15.0)
                                                 : test::cylinder_grid(size, 20.0, 50.0);
        Weave weave;
        for (std::size_t i = 0; i < mesh.quads.size(); ++i) {
            weave.warp_on_top.push_back(static_cast<std::uint8_t>(random() % 2));
        }
        plan(mesh, weave,
             {.most_cells = 1 + static_cast<int>(random() % 8),
              .opening = [&](int) { return static_cast<int>(random() % 100); },
              .tab_mm = 1.5});
    }
}

TEST(PlanAssembly, GluesEveryRimOnceAfterAllElse) {
    const auto mesh = test::flat_grid({3, 4}, 10.0);
    test::CutStrips cut = test::cut_strips(mesh);
    for (Strip& strip : cut.strips) {
        strip.glued_end.has_tab = strip.family == Family::Warp;
        strip.glued_start.has_tab = strip.id == "P2";
    }
    Job job = plan(mesh, weave_cells(mesh, {}), std::move(cut));
    ASSERT_EQ(job.assembly.moves.size(), 7U + 5U);
    EXPECT_EQ(job.assembly.place_joints, 5);
    EXPECT_EQ(job.assembly.moves[7].piece, "P2.1");
    EXPECT_TRUE(job.assembly.moves[7].at_start);
    job.assembly.moves.pop_back();
    EXPECT_TRUE(job.fault());
}

TEST(OpeningCosts, AreWhatThreadingThereCosts) {
    const auto mesh = test::torus_grid({12, 10}, 50.0, 15.0);
    const Weave weave = weave_cells(mesh, {});
    const auto strips = test::whole_strips(mesh, false);
    const auto costs = opening_costs(mesh, strips, crossings_of(strips, weave));
    for (std::size_t i = 0; i < strips.size(); ++i) {
        ASSERT_EQ(costs[i].size(), strips[i].family == Family::Warp ? 12U : 0U);
    }
    const auto where = [&](bool dearest) {
        return Cutting{.opening = [&, dearest](int strip) {
            const auto& own = costs[static_cast<std::size_t>(strip)];
            const auto chosen = dearest ? std::max_element(own.begin(), own.end())
                                        : std::min_element(own.begin(), own.end());
            return own.empty() ? strip : static_cast<int>(chosen - own.begin());
        }};
    };
    EXPECT_EQ(plan(mesh, weave, where(false)).assembly.threaded, 0);
    // More than one opening costs nothing, so that joints needn't all lie in one line.
    EXPECT_GE(std::count(costs.back().begin(), costs.back().end(), 0.0), 2);
    EXPECT_GT(*std::max_element(costs.back().begin(), costs.back().end()), 2.0);
}

TEST(OpeningCosts, ConcernOnlyRegionsThatCloseBothWays) {
    for (const auto& mesh :
         {test::flat_grid({4, 5}, 10.0), test::cylinder_grid({4, 5}, 20.0, 50.0)}) {
        const auto strips = test::whole_strips(mesh, false);
        for (const auto& costs :
             opening_costs(mesh, strips, crossings_of(strips, weave_cells(mesh, {})))) {
            EXPECT_TRUE(costs.empty());
        }
    }
}

TEST(OpeningCosts, LeaveNothingToThreadOnAPillowcase) {
    const auto mesh = sample_grid("sphere", 500.0, geometry::FoliationMode::SpherePillowcase);
    for (const WeavePattern pattern : kPatterns) {
        WeaveParams params;
        params.pattern = pattern;
        const Weave weave = weave_cells(mesh, params);
        const auto strips = test::whole_strips(mesh, false);
        const auto costs = opening_costs(mesh, strips, crossings_of(strips, weave));
        const Cutting cutting{.opening = [&](int strip) {
            const auto& own = costs[static_cast<std::size_t>(strip)];
            return own.empty()
                       ? 0
                       : static_cast<int>(std::min_element(own.begin(), own.end()) - own.begin());
        }};
        EXPECT_EQ(plan(mesh, weave, cutting).assembly.threaded, 0);
    }
}

class CheckAssembly : public ::testing::Test {
protected:
    void SetUp() override {
        job_ = plan(test::torus_grid({6, 8}, 50.0, 15.0), WeavePattern::Plain,
                    {.most_cells = 5, .opening = [](int strip) { return golden(strip, 6); }});
    }

    std::vector<AssemblyMove>& moves() { return job_.assembly.moves; }

    std::size_t first(MoveKind kind, std::size_t from = 0) {
        while (moves()[from].kind != kind ||
               (kind == MoveKind::Lay && moves()[from].cells.empty())) {
            ++from;
        }
        return from;
    }

    Job job_;
};

TEST_F(CheckAssembly, FindsAMoveTooFew) {
    for (std::size_t i = 0; i < moves().size(); ++i) {
        Job damaged = job_;
        damaged.assembly.moves.erase(damaged.assembly.moves.begin() +
                                     static_cast<std::ptrdiff_t>(i));
        EXPECT_TRUE(damaged.fault()) << i;
    }
}

TEST_F(CheckAssembly, FindsAMoveMadeTwice) {
    for (std::size_t i = 0; i < moves().size(); ++i) {
        Job damaged = job_;
        damaged.assembly.moves.insert(
            damaged.assembly.moves.begin() + static_cast<std::ptrdiff_t>(i), moves()[i]);
        const auto fault = damaged.fault();
        ASSERT_TRUE(fault) << i;
        EXPECT_EQ(fault->move, static_cast<int>(i) + 1);
    }
}

TEST_F(CheckAssembly, FindsWhatCannotBeFoldedBack) {
    const std::size_t thread = first(MoveKind::Thread);
    moves()[thread].kind = MoveKind::Lay;
    moves()[thread].held.clear();
    ASSERT_TRUE(job_.fault());
    EXPECT_EQ(job_.fault()->move, static_cast<int>(thread));
    EXPECT_NE(job_.fault()->what.find("cannot be folded back"), std::string::npos);
}

TEST_F(CheckAssembly, FindsARingLaidUnderWhatIsClosed) {
    // All columns closed before the last row comes.
    Job job = plan(test::torus_grid({6, 8}, 50.0, 15.0));
    auto& all = job.assembly.moves;
    const auto last_row = std::find_if(
        all.rbegin(), all.rend(), [](const AssemblyMove& move) { return !move.cells.empty(); });
    std::rotate(last_row.base() - 1, last_row.base() + 1, all.end());
    ASSERT_TRUE(job.fault());
    EXPECT_NE(job.fault()->what.find("cannot be folded back"), std::string::npos);
}

TEST_F(CheckAssembly, FindsATabThatCannotBeReached) {
    const auto tucked = std::find_if(moves().begin(), moves().end(),
                                     [](const AssemblyMove& move) { return move.tucked > 0; });
    ASSERT_NE(tucked, moves().end());
    tucked->tucked = 0;
    ASSERT_TRUE(job_.fault());
    EXPECT_NE(job_.fault()->what.find("cannot be reached"), std::string::npos);
}

TEST_F(CheckAssembly, FindsCrossingsLeftOut) {
    moves()[first(MoveKind::Lay)].cells.pop_back();
    EXPECT_TRUE(job_.fault());
}

TEST_F(CheckAssembly, FindsARingClosedOnTheTable) {
    const std::size_t close = first(MoveKind::Close);
    AssemblyMove move = moves()[close];
    move.in_place = false;
    std::size_t lay = 0;
    while (moves()[lay].strip != move.strip) {
        ++lay;
    }
    moves().erase(moves().begin() + static_cast<std::ptrdiff_t>(close));
    moves().insert(moves().begin() + static_cast<std::ptrdiff_t>(lay), move);
    EXPECT_TRUE(job_.fault());
}

}  // namespace
}  // namespace leafcutter::fab
