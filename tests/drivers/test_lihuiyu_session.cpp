// The Lihuiyu driver against a simulated board that is stricter than a real one.

#include <algorithm>
#include <cmath>
#include <deque>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drivers/transport.h"
#include "tests/drivers/lihuiyu_bench.h"

namespace leafcutter::drivers {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

struct Point {
    double x = 0.0;
    double y = 0.0;
};

std::vector<Point> spiral(int pieces) {
    std::vector<Point> points;
    for (int i = 0; i <= pieces; ++i) {
        const double angle = 0.2 * i;
        const double radius = 5.0 + 30.0 * i / pieces;
        points.push_back({150.0 + radius * std::cos(angle), 100.0 + radius * std::sin(angle)});
    }
    return points;
}

std::string program_of(const std::vector<Point>& points, double feed_mm_per_min = 3000.0) {
    std::string text =
        fmt::format("; spiral\nG21\nG90\nM4 S0\nG0 X{:.3f} Y{:.3f} S0\n", points[0].x, points[0].y);
    for (std::size_t i = 1; i < points.size(); ++i) {
        text += fmt::format("G1 X{:.3f} Y{:.3f} S700 F{:g}\n", points[i].x, points[i].y,
                            feed_mm_per_min);
    }
    return text + "M5 S0\nG0 X0 Y0\n";
}

std::string spiral_program() {
    return program_of(spiral(60));
}

std::string texts(const std::vector<Violation>& violations) {
    std::string all;
    for (const Violation& violation : violations) {
        all += fmt::format("{:.3f} s: {}\n", violation.t_s, violation.text);
    }
    return all;
}

double burnt_mm(const std::vector<BurntPiece>& pieces) {
    double sum = 0.0;
    for (const BurntPiece& piece : pieces) {
        sum += std::hypot(piece.x1_mm - piece.x0_mm, piece.y1_mm - piece.y0_mm);
    }
    return sum;
}

double distance_to(const Point& a, const Point& b, double x, double y) {
    const double dx = b.x - a.x;
    const double dy = b.y - a.y;
    const double squared = dx * dx + dy * dy;
    const double t = squared > 0.0 ? ((x - a.x) * dx + (y - a.y) * dy) / squared : 0.0;
    const double along = std::clamp(t, 0.0, 1.0);
    return std::hypot(a.x + along * dx - x, a.y + along * dy - y);
}

// Every burnt point lies on the line, in its order and without a gap.
void expect_burnt_along(const std::vector<BurntPiece>& pieces, const std::vector<Point>& points) {
    ASSERT_FALSE(pieces.empty());
    constexpr double kStepMm = 0.0254;
    std::size_t leg = 0;
    double worst = 0.0;
    double gap = std::hypot(pieces[0].x0_mm - points[0].x, pieces[0].y0_mm - points[0].y);
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        const BurntPiece& piece = pieces[i];
        if (i > 0) {
            gap = std::max(gap, std::hypot(piece.x0_mm - pieces[i - 1].x1_mm,
                                           piece.y0_mm - pieces[i - 1].y1_mm));
        }
        const auto off = [&](std::size_t at) {
            return distance_to(points[at], points[at + 1], piece.x1_mm, piece.y1_mm);
        };
        while (leg + 2 < points.size() && off(leg + 1) < off(leg)) {
            ++leg;
        }
        worst = std::max(worst, off(leg));
    }
    EXPECT_LT(gap, kStepMm);
    EXPECT_LT(worst, kStepMm);
    EXPECT_EQ(leg, points.size() - 2);
    EXPECT_LT(
        std::hypot(pieces.back().x1_mm - points.back().x, pieces.back().y1_mm - points.back().y),
        kStepMm);
}

TEST(LihuiyuSession, BurnsExactlyTheProgram) {
    LihuiyuBench bench;
    ASSERT_TRUE(bench.home());
    bench.session().start(spiral_program());
    EXPECT_EQ(bench.finish_job(), JobOutcome::Done) << bench.session().progress().reason;
    EXPECT_THAT(texts(bench.machine().violations()), IsEmpty());
    expect_burnt_along(bench.machine().beam_log().pieces(), spiral(60));
    EXPECT_EQ(bench.machine().programs_finished(), 1U);
    EXPECT_FALSE(bench.machine().beam_on());
    // It knows where the head stands: a second job lands on the first.
    bench.session().start(spiral_program());
    const std::size_t first = bench.machine().beam_log().pieces().size();
    EXPECT_EQ(bench.finish_job(), JobOutcome::Done);
    const auto& pieces = bench.machine().beam_log().pieces();
    expect_burnt_along({pieces.begin() + static_cast<std::ptrdiff_t>(first), pieces.end()},
                       spiral(60));
    EXPECT_THAT(texts(bench.machine().violations()), IsEmpty());
}

TEST(LihuiyuSession, KeepsTheProgrammedSpeed) {
    LihuiyuBench bench;
    ASSERT_TRUE(bench.home());
    bench.session().start("M4\nG0 X10 Y10\nG1 X110 Y10 S1 F1200\nG1 X110 Y110\n");
    EXPECT_EQ(bench.finish_job(), JobOutcome::Done);
    const auto& pieces = bench.machine().beam_log().pieces();
    ASSERT_FALSE(pieces.empty());
    EXPECT_NEAR(pieces.back().t1_s - pieces.front().t0_s, 10.0, 0.3);
}

TEST(LihuiyuSession, StartsNothingBeforeItWasHomed) {
    LihuiyuBench bench;
    ASSERT_TRUE(bench.attach());
    EXPECT_EQ(bench.session().status().state, MachineState::Alarm);
    EXPECT_THROW(bench.session().start(spiral_program()), NotHomed);
    EXPECT_THROW(bench.session().jog({1.0, 1.0, 1000.0}), NotHomed);
    bench.session().home();
    EXPECT_THROW(bench.session().start(spiral_program()), Refused);
    ASSERT_TRUE(bench.run_until([&] { return bench.session().homed(); }));
    EXPECT_NO_THROW(bench.session().start(spiral_program()));
    EXPECT_THROW(bench.session().start(spiral_program()), Refused);
}

TEST(LihuiyuSession, WaitsLongEnoughForHomingThatDoesNotSayBusy) {
    LihuiyuMachineOptions options;
    options.busy_while_homing = false;
    options.home_mm_per_s = 20.0;
    LihuiyuBench bench(options);
    ASSERT_TRUE(bench.home());
    bench.session().start(spiral_program());
    EXPECT_EQ(bench.finish_job(), JobOutcome::Done);
    EXPECT_THAT(texts(bench.machine().violations()), IsEmpty());
}

TEST(LihuiyuSession, SendsARejectedPacketAgain) {
    for (const std::size_t at : {3U, 5U, 20U, 40U}) {
        LihuiyuMachineOptions options;
        options.fault = LihuiyuFault{LihuiyuFault::Kind::Crc, at};
        LihuiyuBench bench(options);
        ASSERT_TRUE(bench.home());
        bench.session().start(spiral_program());
        EXPECT_EQ(bench.finish_job(), JobOutcome::Done) << at;
        EXPECT_THAT(texts(bench.machine().violations()), IsEmpty());
        expect_burnt_along(bench.machine().beam_log().pieces(), spiral(60));
        EXPECT_NEAR(burnt_mm(bench.machine().beam_log().pieces()), burnt_mm([] {
                        LihuiyuBench good;
                        good.home();
                        good.session().start(spiral_program());
                        good.finish_job();
                        return good.machine().beam_log().pieces();
                    }()),
                    0.1);
    }
}

TEST(LihuiyuSession, HealsBitsThatFlipOnTheWire) {
    LihuiyuBench bench;
    ASSERT_TRUE(bench.home());
    std::size_t packets = 0;
    bench.to_board = [&packets](std::string bytes) {
        const bool packet = bytes.size() >= kWirePacketBytes;
        if (packet && ++packets % 5 == 0) {
            bytes[2 + packets % kPayloadBytes] ^= 0x04;
        }
        return bytes;
    };
    bench.session().start(spiral_program());
    EXPECT_EQ(bench.finish_job(), JobOutcome::Done) << bench.session().progress().reason;
    EXPECT_THAT(texts(bench.machine().violations()), IsEmpty());
    expect_burnt_along(bench.machine().beam_log().pieces(), spiral(60));
}

TEST(LihuiyuSession, BurnsNothingTwiceWhenAnswersAreLost) {
    LihuiyuBench bench;
    ASSERT_TRUE(bench.home());
    std::size_t answers = 0;
    bench.to_host = [&answers](std::string bytes) {
        return !bytes.empty() && ++answers % 17 == 0 ? std::string() : bytes;
    };
    bench.session().start(spiral_program());
    EXPECT_EQ(bench.finish_job(), JobOutcome::Done) << bench.session().progress().reason;
    EXPECT_THAT(texts(bench.machine().violations()), IsEmpty());
    expect_burnt_along(bench.machine().beam_log().pieces(), spiral(60));
}

// A status asked for before a packet was sent says nothing about that packet.
TEST(LihuiyuSession, TakesNoOldAnswerForThatToItsPacket) {
    for (int idle_turns = 0; idle_turns < 300; idle_turns += 1) {
        LihuiyuMachineOptions options;
        options.fault = LihuiyuFault{LihuiyuFault::Kind::Crc, 3};  // The first of the job.
        LihuiyuBench bench(options);
        ASSERT_TRUE(bench.home());
        std::deque<std::string> on_the_way(4);
        bench.to_host = [&on_the_way](std::string bytes) {
            on_the_way.push_back(std::move(bytes));
            bytes = on_the_way.front();
            on_the_way.pop_front();
            return bytes;
        };
        for (int turn = 0; turn < idle_turns; ++turn) {
            bench.step();
        }
        bench.session().start("M4\nG0 X10 Y10\nG1 X12 Y10 S1 F1200\n");
        ASSERT_EQ(bench.finish_job(), JobOutcome::Done) << idle_turns;
        ASSERT_THAT(texts(bench.machine().violations()), IsEmpty()) << idle_turns;
        ASSERT_NEAR(burnt_mm(bench.machine().beam_log().pieces()), 2.0, 0.03) << idle_turns;
    }
}

// An answer is lost, and the next one comes with a flipped bit: "rejected" for a packet that
// wasn't.
TEST(LihuiyuSession, BurnsNothingTwiceForOneBadAnswerAfterALostOne) {
    LihuiyuBench bench;
    ASSERT_TRUE(bench.home());
    std::size_t answers = 0;
    bench.to_host = [&answers](std::string bytes) {
        if (bytes.size() != kStatusBytes || static_cast<unsigned char>(bytes[1]) != 206) {
            return bytes;
        }
        ++answers;
        if (answers % 20 == 10) {
            return std::string();
        }
        bytes[1] = answers % 20 == 11 ? '\xCF' : bytes[1];
        return bytes;
    };
    bench.session().start(spiral_program());
    EXPECT_EQ(bench.finish_job(), JobOutcome::Done) << bench.session().progress().reason;
    EXPECT_THAT(texts(bench.machine().violations()), IsEmpty());
    expect_burnt_along(bench.machine().beam_log().pieces(), spiral(60));
}

TEST(LihuiyuSession, IsDoneOnlyWhenTheMachineIsAlsoAfterAHoldInTheLastMove) {
    LihuiyuMachineOptions options;
    options.rapid_mm_per_s = 60.0;
    LihuiyuBench bench(options);
    ASSERT_TRUE(bench.home());
    bench.session().start("M4\nG0 X300 Y5\nG1 X299 Y5 S1 F1200\nG0 X0 Y200\n");
    ASSERT_TRUE(bench.run_until([&] {
        const JobProgress& progress = bench.session().progress();
        return progress.lines_acknowledged == progress.lines_total;
    }));
    bench.run_until([] { return false; }, 0.1);
    bench.session().hold();
    ASSERT_TRUE(bench.run_until([&] { return bench.machine().paused(); }, 1.0));
    bench.run_until([] { return false; }, 30.0);
    EXPECT_EQ(bench.session().progress().outcome, JobOutcome::Running);
    bench.session().resume();
    EXPECT_EQ(bench.finish_job(), JobOutcome::Done);
    EXPECT_EQ(bench.machine().programs_finished(), 1U);
    EXPECT_NEAR(bench.machine().position_mm().x_mm, 0.0, 0.02);
}

// The board is done before it has confirmed the last packet, and says so for 390 ms only.
TEST(LihuiyuSession, HearsThatTheBoardHasFinishedWhileTheLastPacketIsUnderWay) {
    LihuiyuBench bench;
    ASSERT_TRUE(bench.home());
    bool last = false;
    bench.to_board = [&](std::string bytes) {
        const JobProgress& progress = bench.session().progress();
        last = last || progress.lines_sent == progress.lines_total;
        return bytes;
    };
    // From the last packet on no answer comes but "finished", and that once it is.
    bench.to_host = [&](std::string bytes) {
        const bool waits = last && bench.machine().programs_finished() == 0;
        if (waits && !bytes.empty()) {
            bytes[1] = '\xEE';
        }
        return bytes;
    };
    bench.session().start("M4\nG1 X1 Y0 S1 F600\nG0 X300 Y200\n");
    ASSERT_TRUE(bench.run_until([&] { return bench.machine().programs_finished() == 1; }));
    const double finished_s = bench.machine().now_s();
    EXPECT_EQ(bench.finish_job(), JobOutcome::Done);
    EXPECT_LT(bench.machine().now_s() - finished_s, 1.0);
}

struct Fatal {
    LihuiyuFault::Kind kind;
    const char* reason;
};

class LihuiyuFatalFault : public testing::TestWithParam<Fatal> {};

// Whatever the fault, the job ends with a reason, in time, and the beam is off by then.
TEST_P(LihuiyuFatalFault, EndsTheJobInTheDark) {
    LihuiyuMachineOptions options;
    options.fault = LihuiyuFault{GetParam().kind, 20};
    LihuiyuBench bench(options);
    ASSERT_TRUE(bench.home());
    bench.session().start(program_of(spiral(60), 600.0));
    try {
        EXPECT_EQ(bench.finish_job(120.0), JobOutcome::Failed);
    } catch (const LinkLost& lost) {
        bench.session().lose_link(lost.what());
        EXPECT_EQ(bench.session().progress().outcome, JobOutcome::LinkLost);
    }
    EXPECT_THAT(bench.session().progress().reason, HasSubstr(GetParam().reason));
    EXPECT_FALSE(bench.session().homed());
    bench.machine().advance(10.0);
    EXPECT_FALSE(bench.machine().beam_on());
    for (const Violation& violation : bench.machine().violations()) {
        EXPECT_THAT(violation.text, testing::Not(HasSubstr("lit")));
    }
}

INSTANTIATE_TEST_SUITE_P(All,
                         LihuiyuFatalFault,
                         testing::Values(Fatal{LihuiyuFault::Kind::CrcAlways, "rejects packet"},
                                         Fatal{LihuiyuFault::Kind::Stall, "busy"},
                                         Fatal{LihuiyuFault::Kind::Busy, "busy"},
                                         Fatal{LihuiyuFault::Kind::Mute, "doesn't answer"},
                                         Fatal{LihuiyuFault::Kind::Unplug, "doesn't answer"},
                                         Fatal{LihuiyuFault::Kind::Power, "no power"}),
                         [](const auto& fault) { return "Fault" + std::to_string(fault.index); });

// Every fault at every packet of a job. One contour: what is burnt is one piece of it from its
// start, nothing twice, and all of it if the job says that it is done.
TEST(LihuiyuSession, EndsEveryFaultAtEveryPacketInTheDarkWithNothingBurntTwice) {
    const std::string program = program_of(spiral(12), 1200.0);
    LihuiyuBench good;
    ASSERT_TRUE(good.home());
    good.session().start(program);
    ASSERT_EQ(good.finish_job(), JobOutcome::Done);
    const double whole_mm = burnt_mm(good.machine().beam_log().pieces());
    const std::size_t packets = good.machine().packets();
    using Kind = LihuiyuFault::Kind;
    for (const Kind kind : {Kind::Crc, Kind::CrcAlways, Kind::Busy, Kind::Stall, Kind::Mute,
                            Kind::Power, Kind::Unplug}) {
        for (std::size_t at = 3; at <= packets; ++at) {
            LihuiyuMachineOptions options;
            options.fault = LihuiyuFault{kind, at};
            LihuiyuBench bench(options);
            ASSERT_TRUE(bench.home());
            bench.session().start(program);
            try {
                bench.finish_job(120.0);
            } catch (const LinkLost& lost) {
                bench.session().lose_link(lost.what());
            }
            bench.machine().advance(20.0);
            const auto what = fmt::format("fault {} at {}", static_cast<int>(kind), at);
            ASSERT_NE(bench.session().progress().outcome, JobOutcome::Running) << what;
            ASSERT_FALSE(bench.machine().beam_on()) << what;
            const auto& pieces = bench.machine().beam_log().pieces();
            for (std::size_t i = 1; i < pieces.size(); ++i) {
                ASSERT_LT(std::hypot(pieces[i].x0_mm - pieces[i - 1].x1_mm,
                                     pieces[i].y0_mm - pieces[i - 1].y1_mm),
                          1e-9)
                    << what;
            }
            ASSERT_LE(burnt_mm(pieces), whole_mm + 0.03) << what;
            if (bench.session().progress().outcome == JobOutcome::Done) {
                ASSERT_NEAR(burnt_mm(pieces), whole_mm, 0.03) << what;
                ASSERT_THAT(texts(bench.machine().violations()), IsEmpty()) << what;
            }
        }
    }
}

// A stop at any moment: dark with the next word to the board, and no word after it moves anything.
TEST(LihuiyuSession, IsDarkAtOnceWheneverItIsStopped) {
    const std::string program = program_of(spiral(12), 1200.0);
    for (int turns = 0; turns < 4000; turns += 37) {
        LihuiyuBench bench;
        ASSERT_TRUE(bench.home());
        bench.session().start(program);
        for (int turn = 0; turn < turns; ++turn) {
            bench.step();
        }
        bench.session().stop();
        bench.step();
        const std::size_t pieces = bench.machine().beam_log().pieces().size();
        ASSERT_FALSE(bench.run_until([&] { return bench.machine().beam_on(); }, 5.0)) << turns;
        ASSERT_EQ(bench.machine().beam_log().pieces().size(), pieces) << turns;
        ASSERT_TRUE(bench.machine().at_rest()) << turns;
        ASSERT_TRUE(bench.session().may_close()) << turns;
        ASSERT_THAT(texts(bench.machine().violations()), IsEmpty()) << turns;
    }
}

TEST(LihuiyuSession, WaitsForABoardThatIsBusyWithLongWork) {
    LihuiyuMachineOptions options;
    LihuiyuBench bench(options);
    ASSERT_TRUE(bench.home());
    // 1 mm/s: every packet takes half a second, travel across the bed several.
    bench.session().start(
        "M4\nG0 X300 Y5\nG1 X290 Y5 S1 F60\nG0 X5 Y200\nG1 X8 Y200 S1\nG0 X0 Y0\n");
    EXPECT_EQ(bench.finish_job(), JobOutcome::Done) << bench.session().progress().reason;
    EXPECT_NEAR(burnt_mm(bench.machine().beam_log().pieces()), 13.0, 0.1);
}

TEST(LihuiyuSession, HoldsInTheDarkAndGoesOnWhereItStopped) {
    LihuiyuBench bench;
    ASSERT_TRUE(bench.home());
    bench.session().start(program_of(spiral(60), 600.0));
    ASSERT_TRUE(
        bench.run_until([&] { return bench.session().progress().lines_acknowledged > 30; }));
    ASSERT_TRUE(bench.run_until([&] { return bench.machine().beam_on(); }));
    bench.session().hold();
    const double asked_s = bench.machine().now_s();
    ASSERT_TRUE(bench.run_until([&] { return bench.machine().paused(); }, 5.0));
    EXPECT_LT(bench.machine().now_s() - asked_s, 0.6);
    EXPECT_FALSE(bench.machine().beam_on());
    ASSERT_TRUE(
        bench.run_until([&] { return bench.session().status().state == MachineState::Hold; }, 1.0));
    const double held_s = bench.machine().now_s();
    EXPECT_FALSE(bench.run_until([&] { return bench.machine().beam_on(); }, 60.0));
    bench.session().resume();
    EXPECT_EQ(bench.finish_job(), JobOutcome::Done) << bench.session().progress().reason;
    EXPECT_THAT(texts(bench.machine().violations()), IsEmpty());
    expect_burnt_along(bench.machine().beam_log().pieces(), spiral(60));
    EXPECT_GT(bench.machine().now_s(), held_s + 60.0);
}

TEST(LihuiyuSession, HeldBeforeItBeganBurnsOnlyAfterResume) {
    LihuiyuBench bench;
    ASSERT_TRUE(bench.home());
    bench.session().start(spiral_program());
    bench.session().hold();
    EXPECT_FALSE(bench.run_until([&] { return bench.machine().beam_on(); }, 5.0));
    bench.session().resume();
    EXPECT_EQ(bench.finish_job(), JobOutcome::Done);
    EXPECT_THAT(texts(bench.machine().violations()), IsEmpty());
}

TEST(LihuiyuSession, StopIsDarkAtOnceAndForgetsThePlace) {
    LihuiyuBench bench;
    ASSERT_TRUE(bench.home());
    bench.session().start(program_of(spiral(60), 600.0));
    ASSERT_TRUE(
        bench.run_until([&] { return bench.session().progress().lines_acknowledged > 30; }));
    ASSERT_TRUE(bench.run_until([&] { return bench.machine().beam_on(); }));
    bench.session().stop();
    bench.step();
    EXPECT_FALSE(bench.machine().beam_on());
    EXPECT_TRUE(bench.machine().at_rest());
    EXPECT_EQ(bench.session().progress().outcome, JobOutcome::Aborted);
    EXPECT_THROW(bench.session().start(spiral_program()), NotHomed);
    ASSERT_TRUE(bench.run_until([&] { return bench.session().may_close(); }, 1.0));
    EXPECT_EQ(bench.session().status().state, MachineState::Alarm);
    EXPECT_THROW(bench.session().start(spiral_program()), NotHomed);
    const std::size_t burnt = bench.machine().beam_log().pieces().size();
    EXPECT_FALSE(bench.run_until([&] { return bench.machine().beam_on(); }, 20.0));
    bench.session().home();
    ASSERT_TRUE(bench.run_until([&] { return bench.session().homed(); }, 60.0));
    bench.session().start(spiral_program());
    EXPECT_EQ(bench.finish_job(), JobOutcome::Done);
    EXPECT_THAT(texts(bench.machine().violations()), IsEmpty());
    const auto& pieces = bench.machine().beam_log().pieces();
    expect_burnt_along({pieces.begin() + static_cast<std::ptrdiff_t>(burnt), pieces.end()},
                       spiral(60));
}

TEST(LihuiyuSession, IsStoppedWhileOnHoldWithoutLightingTheBeam) {
    LihuiyuBench bench;
    ASSERT_TRUE(bench.home());
    bench.session().start(program_of(spiral(60), 600.0));
    ASSERT_TRUE(
        bench.run_until([&] { return bench.session().progress().lines_acknowledged > 30; }));
    bench.session().hold();
    ASSERT_TRUE(bench.run_until([&] { return bench.machine().paused(); }, 5.0));
    bench.session().cancel();
    EXPECT_FALSE(bench.run_until([&] { return bench.machine().beam_on(); }, 20.0));
    EXPECT_EQ(bench.session().progress().outcome, JobOutcome::Aborted);
    EXPECT_FALSE(bench.machine().paused());
}

TEST(LihuiyuSession, JogsWithinTheBedAndCountsOn) {
    LihuiyuBench bench;
    ASSERT_TRUE(bench.home());
    EXPECT_THROW(bench.session().jog({-1.0, 0.0, 1000.0}), Refused);
    bench.session().jog({300.0, -200.0, 1000.0});
    ASSERT_TRUE(bench.run_until(
        [&] { return bench.session().status().state == MachineState::Idle; }, 30.0));
    EXPECT_NEAR(bench.machine().position_mm().x_mm, 300.0, 0.02);
    EXPECT_NEAR(bench.machine().position_mm().y_mm, 10.0, 0.02);
    bench.session().start(spiral_program());
    EXPECT_EQ(bench.finish_job(), JobOutcome::Done);
    expect_burnt_along(bench.machine().beam_log().pieces(), spiral(60));
    EXPECT_THAT(texts(bench.machine().violations()), IsEmpty());
}

TEST(LihuiyuSession, FreedRailsMustBeHomedAgain) {
    LihuiyuBench bench;
    ASSERT_TRUE(bench.home());
    bench.session().unlock();
    ASSERT_TRUE(bench.run_until([&] { return bench.session().may_close(); }, 1.0));
    EXPECT_THROW(bench.session().start(spiral_program()), NotHomed);
    EXPECT_THAT(texts(bench.machine().violations()), IsEmpty());
}

TEST(LihuiyuSession, RefusesProgramsThatDoNotFitBeforeAnythingMoves) {
    LihuiyuBench bench;
    ASSERT_TRUE(bench.home());
    const std::size_t packets = bench.machine().packets();
    const auto reason = [&bench](const std::string& program) -> std::string {
        try {
            bench.session().start(program);
        } catch (const ProgramRefused& refused) {
            return refused.what();
        }
        return {};
    };
    EXPECT_THAT(reason("M4\nG0 X1 Y1\nG1 X311 Y1 S1 F600\n"), HasSubstr("line 3: X311"));
    EXPECT_THAT(reason("M4\nG1 X5 Y1 S1 F60000\n"), HasSubstr("line 2: 1000 mm/s"));
    EXPECT_THAT(reason("M4\nG1 X5 Y1 S1\n"), HasSubstr("line 2: burns without a feed"));
    EXPECT_THAT(reason("G1 X5 Y1 S1 F600\n"), HasSubstr("line 1: burns (S above 0) without M3"));
    EXPECT_THAT(reason("M4\nG92 X0\n"), HasSubstr("line 2: G92"));
    EXPECT_THAT(reason("G1 X5 Z1\n"), HasSubstr("Z words"));
    EXPECT_THAT(reason("; nothing\n"), HasSubstr("moves nothing"));
    bench.run_until([] { return false; }, 1.0);
    EXPECT_EQ(bench.machine().packets(), packets);
}

// The host dies after any byte: the board does what it has, then stands in the dark.
TEST(LihuiyuDeadMan, LeavesTheBeamOffAfterEveryByte) {
    const EncoderOptions options;
    const EncodedJob job = encode_job(read_cut_moves(program_of(spiral(10), 1200.0) +
                                                     "M4\nG1 X40 Y0 S1 F600\nG1 X40 Y10 F3000\n"),
                                      {}, options);
    std::string wire;
    for (const JobPacket& packet : job.packets) {
        wire += wire_bytes(packet.payload);
    }
    LihuiyuMachineOptions roomy;
    roomy.packets_held = job.packets.size() + 10;
    LihuiyuMachine before(roomy);
    before.feed(wire_bytes(make_payload("IPP")));
    before.advance(20.0);
    for (std::size_t cut = 0; cut <= wire.size(); ++cut) {
        LihuiyuMachine machine = before;
        machine.feed(std::string_view(wire).substr(0, cut));
        machine.advance(200.0);
        ASSERT_FALSE(machine.beam_on()) << "after byte " << cut;
        ASSERT_TRUE(machine.violations().empty())
            << "after byte " << cut << ": " << texts(machine.violations());
        for (const BurntPiece& piece : machine.beam_log().pieces()) {
            ASSERT_GT(piece.feed_mm_per_min, 0.0) << "burns while standing, after byte " << cut;
        }
    }
}

// However many packets the board holds, what is still to burn when the host dies is bounded.
TEST(LihuiyuDeadMan, BurnsForNoLongerThanTheBoardHoldsPackets) {
    const std::string line = "M4\nG0 X0 Y5\nG1 X300 Y5 S1 F300\n";  // A minute, in few letters.
    for (const JobPacket& packet : encode_job(read_cut_moves(line), {0, 8071}, {}).packets) {
        EXPECT_LE(packet.seconds, 0.5 + 1e-9);
    }
    LihuiyuBench bench;
    ASSERT_TRUE(bench.home());
    bench.session().start(line);
    ASSERT_TRUE(
        bench.run_until([&] { return bench.session().progress().lines_acknowledged > 20; }));
    ASSERT_TRUE(bench.run_until([&] { return bench.machine().beam_on(); }));
    const double died_s = bench.machine().now_s();
    bench.machine().advance(60.0);
    EXPECT_LT(bench.machine().beam_log().pieces().back().t1_s - died_s, 0.5 * 6);
    EXPECT_FALSE(bench.machine().beam_on());
}

}  // namespace
}  // namespace leafcutter::drivers
