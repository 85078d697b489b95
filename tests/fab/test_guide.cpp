// What the guide says: every strip in one step, every crossing in words, nothing left out.

#include <map>
#include <set>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "../support/grid_job.h"
#include "../support/quad_grids.h"
#include "fab/guide/content.h"
#include "fab/guide/steps.h"
#include "fab/guide/view.h"
#include "fab/guide/wording.h"

namespace leafcutter::fab::guide {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::vector<std::string> words_of(const Document& document) {
    std::vector<std::string> words;
    for (const Block& block : document.blocks) {
        if (const auto* paragraph = std::get_if<Paragraph>(&block)) {
            words.push_back(paragraph->text);
        } else if (const auto* list = std::get_if<List>(&block)) {
            words.insert(words.end(), list->items.begin(), list->items.end());
        } else if (const auto* table = std::get_if<Table>(&block)) {
            for (const auto& row : table->rows) {
                for (const Cell& cell : row) {
                    words.push_back(cell.text);
                }
            }
        }
    }
    return words;
}

std::string all_words(const Document& document) {
    return fmt::format("{}", fmt::join(words_of(document), "\n"));
}

std::vector<Step> steps_of(const Document& document) {
    std::vector<Step> steps;
    for (const Block& block : document.blocks) {
        if (const auto* step = std::get_if<Step>(&block)) {
            steps.push_back(*step);
        }
    }
    return steps;
}

JobResult tube_job(int rows = 6, int cols = 8) {
    return test::grid_job(test::cylinder_grid({rows, cols}, 20.0, 60.0));
}

TEST(IdRanges, PutsRunsTogether) {
    EXPECT_EQ(id_ranges({"W1", "W2", "W3", "W5"}), "W1\xe2\x80\x93W3, W5");
    EXPECT_EQ(id_ranges({"P9", "P8", "P7"}), "P9\xe2\x80\x93P7");
    EXPECT_EQ(id_ranges({"P1", "P2"}), "P1, P2");
    EXPECT_EQ(id_ranges({"P1", "W2", "W3", "x"}), "P1, W2, W3, x");
    EXPECT_EQ(id_ranges({}), "");
}

std::vector<NamedCrossing> way(const std::string& sides) {
    std::vector<NamedCrossing> crossings;
    for (std::size_t i = 0; i < sides.size(); ++i) {
        crossings.push_back({fmt::format("P{}", i + 1), sides[i] == 'o'});
    }
    return crossings;
}

TEST(CrossingText, TellsWhatRepeatsOnce) {
    EXPECT_EQ(crossing_text(way("ouououou")), "over P1, under P2, and so on by turns to P8");
    EXPECT_EQ(crossing_text(way("oooo")), "over P1\xe2\x80\x93P4");
    EXPECT_EQ(crossing_text(way("oouuoouuoouu")),
              "over P1, P2, under P3, P4, and so on like this to P12");
    EXPECT_EQ(crossing_text(way("ou")), "over P1; then under P2");
}

TEST(CrossingText, BeginsAnewWhereThePatternBreaks) {
    EXPECT_EQ(crossing_text(way("ouououuououo")),
              "over P1, under P2, and so on by turns to P6; then under P7, over P8, and so on by "
              "turns to P12");
}

// Reads a text back: over and under of every strip, in order.
std::string read_back(const std::string& text, const std::string& sides) {
    std::string told;
    std::string side;
    std::string period;
    std::size_t i = 0;
    const auto number = [&] {
        std::size_t used = 0;
        const int value = std::stoi(text.substr(i), &used);
        i += used;
        return static_cast<std::size_t>(value);
    };
    while (i < text.size() && told.size() <= sides.size()) {
        if (text.compare(i, 6, "; then") == 0) {
            period.clear();
            i += 6;
        } else if (text.compare(i, 4, "over") == 0) {
            side = "o";
            i += 4;
        } else if (text.compare(i, 5, "under") == 0) {
            side = "u";
            i += 5;
        } else if (text.compare(i, 9, "and so on") == 0) {
            i = text.find(" to P", i) + 5;
            const std::size_t last = number();
            for (std::size_t k = 0; told.size() < last; ++k) {
                told += period[k % period.size()];
            }
        } else if (text[i] == 'P') {
            ++i;
            const std::size_t first = number();
            EXPECT_EQ(first, told.size() + 1) << text;
            std::size_t last = first;
            if (text.compare(i, 4, "\xe2\x80\x93P") == 0) {
                i += 4;
                last = number();
            }
            for (std::size_t k = first; k <= last; ++k) {
                told += side;
                period += side;
            }
        } else {
            ++i;
        }
    }
    return told;
}

TEST(CrossingText, LosesNoCrossing) {
    std::mt19937 random(4);
    for (int round = 0; round < 300; ++round) {
        std::string sides;
        const std::size_t period = 1 + random() % 7;
        const std::size_t count = 1 + random() % 40;
        for (std::size_t i = 0; i < count; ++i) {
            const bool again = i >= period && random() % 12 != 0;
            sides += again ? sides[i - period] : (random() % 2 == 0 ? 'o' : 'u');
        }
        EXPECT_EQ(read_back(crossing_text(way(sides)), sides), sides);
    }
}

void expect_each_move_once(const JobResult& job, std::size_t most) {
    const JobIndex index(job);
    std::vector<int> times(job.assembly.moves.size(), 0);
    std::map<int, int> laid;
    for (const PlannedStep& step : plan_steps(index, most)) {
        for (const int move : step.moves) {
            ++times[static_cast<std::size_t>(move)];
        }
        for (const int strip : step.strips) {
            ++laid[strip];
        }
    }
    EXPECT_THAT(times, ::testing::Each(1));
    ASSERT_EQ(laid.size(), job.strips.size());
    for (const auto& [strip, count] : laid) {
        EXPECT_EQ(count, 1) << job.strips[static_cast<std::size_t>(strip)].id;
    }
}

TEST(PlanSteps, HasEveryStripInOneStep) {
    expect_each_move_once(tube_job(), 120);
    expect_each_move_once(test::grid_job(test::flat_grid({5, 7}, 10.0)), 120);
    expect_each_move_once(test::grid_job(test::torus_grid({8, 6}, 40.0, 15.0)), 120);
}

TEST(PlanSteps, GathersStripsWhereThereAreMany) {
    const JobResult job = tube_job(90, 6);
    const JobIndex index(job);
    EXPECT_EQ(plan_steps(index, 120).size(), 91U);
    EXPECT_LE(plan_steps(index, 40).size(), 40U);
    expect_each_move_once(job, 40);
}

TEST(PlanSteps, PutsJointsOnTheTableFirst) {
    JobResult job = test::grid_job(test::flat_grid({4, 4}, 10.0));
    AssemblyMove joint;
    joint.kind = MoveKind::Join;
    joint.strip = job.assembly.moves.back().strip;
    joint.piece = joint.onto = job.pieces.front().id;
    job.assembly.moves.insert(job.assembly.moves.end() - 1, joint);
    const std::vector<PlannedStep> steps = plan_steps(JobIndex(job), 120);
    EXPECT_EQ(steps.front().kind, StepKind::TableJoints);
    EXPECT_EQ(steps.front().moves,
              std::vector<int>{static_cast<int>(job.assembly.moves.size()) - 2});
}

TEST(Guide, NamesEveryStripInOneStepTitle) {
    const JobResult job = tube_job();
    std::set<std::string> missing;
    for (const Strip& strip : job.strips) {
        missing.insert(strip.id);
    }
    const std::vector<Step> steps = steps_of(make_guide(job));
    ASSERT_EQ(steps.size(), 7U);  // All columns at once, then row by row.
    EXPECT_THAT(steps[0].title, HasSubstr("Lay P1\xe2\x80\x93P8 side by side"));
    for (std::size_t row = 1; row <= 6; ++row) {
        EXPECT_THAT(steps[row].title,
                    HasSubstr(fmt::format("Weave in W{}, row {} of 6", row, row)));
        EXPECT_THAT(steps[row].texts.back(),
                    HasSubstr("Close the ring: glue its tab under its own start"));
        EXPECT_EQ(steps[row].figure.drawings.size(), 2U);
    }
}

TEST(Guide, TellsTheWayOfAStripAsItIsWoven) {
    const JobResult job = tube_job();
    const std::vector<Step> steps = steps_of(make_guide(job));
    const bool first_over = job.weave.warp_on_top[0] == 0;
    EXPECT_THAT(steps[1].texts.front(),
                HasSubstr(first_over ? "over P1, under P2, and so on by turns to P8"
                                     : "under P1, over P2, and so on by turns to P8"));
}

TEST(Guide, ListsEveryPieceOfEverySheet) {
    const JobResult job = tube_job();
    const std::vector<std::string> words = words_of(make_guide(job));
    for (const Piece& piece : job.pieces) {
        EXPECT_THAT(words, ::testing::Contains(piece.id));
    }
}

TEST(Guide, CutsShortWhatIsTooMuch) {
    JobResult job = tube_job(20, 30);
    for (int i = 0; i < 500; ++i) {
        job.warnings.push_back(fmt::format("warning {}", i));
        job.weave.seams.push_back({i, i + 30});
    }
    const std::string words = all_words(make_guide(job));
    EXPECT_THAT(words, HasSubstr("warning 59"));
    EXPECT_THAT(words, ::testing::Not(HasSubstr("warning 60")));
    EXPECT_THAT(words, HasSubstr("And 440 more: report.json lists all."));
    EXPECT_THAT(words, HasSubstr("And 260 more: weave.json lists all."));
}

TEST(Guide, StandsWithoutAnOrderOfAssembly) {
    JobResult job = tube_job();
    job.assembly = {};
    const Document document = make_guide(job);
    EXPECT_TRUE(steps_of(document).empty());
    EXPECT_THAT(words_of(document), ::testing::Contains("P8.1"));
}

TEST(Guide, NamesCylindersThatAreLeftOut) {
    JobResult job = tube_job();
    job.quads.grids.emplace_back();  // Without rows.
    EXPECT_THAT(all_words(make_guide(job)), HasSubstr("joined directly: cylinder 2."));
}

TEST(Guide, SharesPicturesBetweenSteps) {
    const Document document = make_guide(tube_job(40, 20));
    EXPECT_LT(document.shared.size(), 40U);
    for (const Step& step : steps_of(document)) {
        for (const Shape& shape : step.figure.drawings.front().shapes) {
            if (const auto* use = std::get_if<Use>(&shape)) {
                EXPECT_LT(use->shared, document.shared.size());
            }
        }
    }
}

double area_of(const std::vector<Points>& rings) {
    double doubled = 0.0;
    for (const Points& ring : rings) {
        for (std::size_t i = 0; i < ring.size(); ++i) {
            const Point& p = ring[i];
            const Point& q = ring[(i + 1) % ring.size()];
            doubled += p.x() * q.y() - p.y() * q.x();
        }
    }
    return std::abs(doubled) / 2.0;
}

// A tube seen from the side: a rectangle, whatever hides what.
TEST(Views, CoversTheOutlineOnceAndOnlyOnce) {
    const geometry::QuadMesh mesh = test::cylinder_grid({10, 24}, 20.0, 60.0);
    Views views(mesh);
    for (std::size_t side = 0; side < views.count(); ++side) {
        const View& view = views.at(side);
        double area = 0.0;
        for (const SeenQuad& quad : view.quads) {
            area += area_of(quad.areas);
        }
        EXPECT_NEAR(area, area_of(view.outline), 0.02 * area) << side;
    }
}

TEST(Views, HidesWhatLiesBehind) {
    // Two sheets, one 5 mm behind the other.
    geometry::QuadMesh mesh = test::flat_grid({4, 4}, 10.0);
    const int count = static_cast<int>(mesh.vertices.size());
    for (int i = 0; i < count; ++i) {
        mesh.vertices.push_back(mesh.vertices[static_cast<std::size_t>(i)] -
                                Eigen::Vector3d(0.0, 0.0, 5.0));
    }
    for (int i = 0; i < 16; ++i) {
        const auto [a, b, c, d] = mesh.quads[static_cast<std::size_t>(i)];
        mesh.quads.push_back({a + count, b + count, c + count, d + count});
    }
    Views views(mesh);
    double all = 0.0;
    for (std::size_t side = 0; side < views.count(); ++side) {
        const Camera& camera = views.camera(side);
        if (camera.to_viewer.z() < 0.5) {
            continue;
        }
        const View& view = views.at(side);
        for (int quad = 0; quad < 16; ++quad) {
            const int seen = view.seen_of[static_cast<std::size_t>(quad)];
            ASSERT_GE(seen, 0);
            EXPECT_TRUE(view.quads[static_cast<std::size_t>(seen)].whole);
            all += 1.0;
        }
        EXPECT_EQ(view.seen_of[16 + 5], -1);  // In the midst of the sheet behind.
    }
    EXPECT_GT(all, 0.0);
}

}  // namespace
}  // namespace leafcutter::fab::guide
