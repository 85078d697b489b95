#include <numbers>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fab/weave/thickness_report.h"
#include "fab/weave/weave.h"
#include "geometry/quads/threads.h"
#include "tests/support/quad_grids.h"

namespace leafcutter::fab {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

struct Judged {
    std::vector<Strip> strips;
    ThicknessReport report;
    std::vector<std::string> warnings;
};

std::vector<Strip> strips_of(const geometry::QuadMesh& mesh) {
    std::vector<Strip> strips;
    for (const Family family : {Family::Weft, Family::Warp}) {
        int number = 0;
        for (const geometry::Thread& thread :
             geometry::trace_threads(mesh, family, geometry::ThreadEnds::AtCriticalLeaves)) {
            Strip& strip = strips.emplace_back();
            strip.id = fmt::format("{}{}", family == Family::Weft ? 'W' : 'P', ++number);
            strip.family = family;
            strip.closed = thread.closed;
            strip.quads = thread.quads;
        }
    }
    return strips;
}

Judged judge(const geometry::QuadMesh& mesh, const ThicknessRules& rules) {
    Judged judged;
    judged.strips = strips_of(mesh);
    const Crossings crossings = crossings_of(judged.strips, weave_cells(mesh, {}));
    judged.report = judge_thickness(mesh, judged.strips, crossings, rules);
    judged.warnings = thickness_warnings(judged.report, judged.strips, {});
    return judged;
}

ThicknessRules rules(double thickness_mm, double min_radius_mm, double clearance_mm = 0.2) {
    const SheetFeel feel{thickness_mm, min_radius_mm};
    return {{feel, feel}, {true, true}, clearance_mm};
}

TEST(ThicknessReport, FindsTheBendOfATube) {
    const geometry::QuadMesh tube = test::cylinder_grid({6, 60}, 20.0, 20.0);
    const Judged judged = judge(tube, rules(0.2, 1.0));
    for (std::size_t i = 0; i < judged.strips.size(); ++i) {
        if (judged.strips[i].family == Family::Weft) {
            EXPECT_NEAR(judged.report.strips[i].surface_radius_mm, 20.0, 0.1);
            EXPECT_EQ(judged.report.strips[i].changes, 60);
        } else {
            EXPECT_EQ(judged.report.strips[i].surface_radius_mm, 0.0);
            EXPECT_EQ(judged.report.strips[i].changes, 5);
        }
        EXPECT_GE(judged.report.strips[i].radius_mm, 1.0 - 1e-9);
    }
    EXPECT_THAT(judged.warnings, IsEmpty());
}

TEST(ThicknessReport, NamesStripsThatCannotBeBent) {
    const geometry::QuadMesh tube = test::cylinder_grid({3, 60}, 20.0, 300.0);
    const Judged judged = judge(tube, rules(0.2, 30.0));
    EXPECT_THAT(judged.warnings,
                ::testing::Contains(AllOf(StartsWith("W1, W2, W3: "),
                                          HasSubstr("bent more tightly"), HasSubstr("30 mm"))));
    for (const std::string& warning : judged.warnings) {
        EXPECT_THAT(warning, ::testing::Not(StartsWith("P")));
    }
}

TEST(ThicknessReport, NamesStripsWhoseCellsAreTooShort) {
    // From over to under takes about 8.9 mm; cells of the warp are 5 mm long, those of the weft 20.
    const geometry::QuadMesh sheet = test::quad_grid(
        {10, 4}, geometry::ChartShape::Rectangle,
        [](double g, double f) { return Eigen::Vector3d(80.0 * g, 50.0 * f, 0.0); });
    const Judged judged = judge(sheet, rules(0.2, 100.0));
    EXPECT_NEAR(judged.report.families[1].flat_gap_mm, 8.94, 0.01);
    EXPECT_THAT(judged.warnings, ElementsAre(HasSubstr("bent more tightly"),
                                             AllOf(StartsWith("P1, P2, P3, P4: "),
                                                   HasSubstr("cells shorter than the 8.94 mm"))));
}

TEST(ThicknessReport, SaysWhichClearanceWouldDo) {
    const geometry::QuadMesh sheet = test::flat_grid({8, 8}, 10.0);
    const Judged thick = judge(sheet, rules(1.5, 0.0, 0.2));
    ASSERT_EQ(thick.warnings.size(), 2U);
    EXPECT_THAT(thick.warnings[0], HasSubstr("fit.clearance_mm must be at least 0.83"));
    ThicknessRules wider = rules(1.5, 0.0, 0.83);
    wider.joined = {false, false};
    EXPECT_THAT(judge(sheet, wider).warnings, IsEmpty());
    wider.joined = {true, false};
    EXPECT_THAT(judge(sheet, wider).warnings,
                ElementsAre(AllOf(HasSubstr("joints of weft pieces are 3 mm thick"))));
}

TEST(ThicknessReport, CountsWhatCrimpCosts) {
    const Judged judged = judge(test::flat_grid({8, 8}, 10.0), rules(0.2, 2.0));
    const double each = crimp_path({0.2, 0.2, 0.4, 2.0}, 10.0).extra_mm();
    EXPECT_EQ(judged.report.families[0].changes, 8 * 7);
    EXPECT_NEAR(judged.report.families[0].crimp_mm, 8 * 7 * each, 1e-9);
}

TEST(Threading, SeesAStripTooWideForItsHole) {
    // A wedge: weft strips are 2 mm wide at one end and 10 mm at the other.
    const geometry::QuadMesh wedge = test::quad_grid(
        {4, 10}, geometry::ChartShape::Rectangle,
        [](double g, double f) { return Eigen::Vector3d(100.0 * g, (8.0 + 32.0 * g) * f, 0.0); });
    const std::vector<Strip> strips = strips_of(wedge);
    Assembly assembly;
    AssemblyMove& move = assembly.moves.emplace_back();
    move.kind = MoveKind::Thread;
    move.cells = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9};
    move.held = {2};
    EXPECT_THAT(threading_warnings(wedge, strips, assembly, 0.2),
                ElementsAre(StartsWith("W1: has to be threaded through a hole of 4.2 mm")));
    // From the other end the narrow part comes behind.
    move.cells = {9, 8, 7, 6, 5, 4, 3, 2, 1, 0};
    EXPECT_THAT(threading_warnings(wedge, strips, assembly, 0.2), IsEmpty());
    move.kind = MoveKind::Lay;
    move.cells = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9};
    EXPECT_THAT(threading_warnings(wedge, strips, assembly, 0.2), IsEmpty());
}

}  // namespace
}  // namespace leafcutter::fab
