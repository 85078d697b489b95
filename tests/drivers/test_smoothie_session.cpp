#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drivers/sim/smoothie_machine.h"
#include "drivers/transport.h"
#include "line_bench.h"

namespace leafcutter::drivers {
namespace {

using testing::HasSubstr;
using Kind = WireFault::Kind;
using SmoothieBench =
    MachineBench<SmoothieMachine, SmoothieMachineOptions, MarlinSession::Firmware::Smoothie>;

TEST(SmoothieSession, RunsAProgramToItsEndInBothModes) {
    for (const bool grbl_mode : {false, true}) {
        SmoothieBench bench({grbl_mode, grbl_mode});
        expect_whole(bench, 20, "");
        EXPECT_EQ(bench.session().resends(), 0U);
        EXPECT_EQ(bench.session().status().state, MachineState::Idle);
        EXPECT_EQ(bench.burnt().front().s, 0.5);
    }
}

TEST(SmoothieSession, HealsEveryFaultOfTheWireWithinTwoSeconds) {
    SmoothieBench sound;
    expect_whole(sound, 25, "");
    for (const Kind kind : {Kind::FlipBit, Kind::DropLine, Kind::DropByte, Kind::DropOk,
                            Kind::GarbleOk, Kind::DoubleOk}) {
        for (std::size_t at = 4; at < 40; ++at) {
            SmoothieBench bench({}, WireFault{kind, at});
            expect_whole(bench, 25, "");
            EXPECT_LT(bench.now_s(), sound.now_s() + 2.0)
                << "fault " << static_cast<int>(kind) << " at " << at;
            expect_on_zigzag(bench.burnt());
        }
    }
}

TEST(SmoothieSession, HoldsAndGoesOnWhereverFeedHoldIsOff) {
    for (const bool feed_hold : {false, true}) {
        SmoothieBench bench({false, feed_hold});
        ASSERT_TRUE(bench.attach());
        bench.session().start(zigzag(60, ""));
        ASSERT_TRUE(bench.run_until([&] { return bench.burnt_mm() > 100.0; }));
        bench.session().hold();
        ASSERT_TRUE(bench.run_until([&] { return bench.session().status().message.empty(); }));
        EXPECT_EQ(bench.machine().beam_power(), 0.0);
        const double burnt = bench.burnt_mm();
        bench.run_until([] { return false; }, 3.0);
        EXPECT_EQ(bench.burnt_mm(), burnt);
        bench.session().resume();
        ASSERT_TRUE(bench.finish_job());
        EXPECT_NEAR(bench.burnt_mm(), zigzag_mm(60), 0.05);
    }
}

TEST(SmoothieSession, StopsDeadAndIsUnlockedByTheOperator) {
    SmoothieBench bench;
    ASSERT_TRUE(bench.attach());
    bench.session().start(zigzag(60, ""));
    ASSERT_TRUE(bench.run_until([&] { return bench.burnt_mm() > 100.0; }));
    bench.session().cancel();
    bench.step();
    bench.step();
    EXPECT_TRUE(bench.machine().halted());
    EXPECT_EQ(bench.machine().beam_power(), 0.0);
    EXPECT_EQ(bench.session().progress().outcome, JobOutcome::Aborted);
    EXPECT_EQ(bench.session().status().state, MachineState::Alarm);
    EXPECT_THROW(bench.session().start(zigzag(1, "")), Refused);
    bench.session().unlock();
    ASSERT_TRUE(bench.attach());
    EXPECT_FALSE(bench.machine().halted());
    bench.session().home();
    ASSERT_TRUE(
        bench.run_until([&] { return bench.session().status().state == MachineState::Idle; }));
    bench.session().start("G21\nG90\nG0 X5 Y5\n");
    ASSERT_TRUE(bench.finish_job());
    EXPECT_NEAR(bench.machine().position_mm()[0], 5.0, 1e-9);
}

TEST(SmoothieSession, HomesInBothModes) {
    for (const bool grbl_mode : {false, true}) {
        SmoothieBench bench({grbl_mode, false});
        ASSERT_TRUE(bench.attach());
        const auto idle = [&] { return bench.session().status().state == MachineState::Idle; };
        bench.session().jog({50.0, 20.0, 3000.0});
        ASSERT_TRUE(bench.run_until(idle));
        EXPECT_NEAR(bench.machine().position_mm()[0], 50.0, 1e-9);
        bench.session().home();
        ASSERT_TRUE(bench.run_until(idle));
        EXPECT_EQ(bench.machine().position_mm()[0], 0.0);
    }
}

TEST(SmoothieSession, FailsTheJobOfABoardThatHalts) {
    SmoothieBench bench;
    ASSERT_TRUE(bench.attach());
    bench.session().start(zigzag(60, ""));
    ASSERT_TRUE(bench.run_until([&] { return bench.burnt_mm() > 100.0; }));
    bench.machine().feed("G92.9 F0\nG1 F0 X1\n");  // Somebody else's, on its other port.
    ASSERT_TRUE(bench.finish_job());
    EXPECT_EQ(bench.session().progress().outcome, JobOutcome::Failed);
    EXPECT_THAT(bench.session().progress().reason, HasSubstr("Undefined feed rate"));
    EXPECT_EQ(bench.session().status().state, MachineState::Alarm);
}

TEST(SmoothieSession, NoticesWithinTwoSecondsThatTheBoardIsSilent) {
    SmoothieBench bench({}, WireFault{Kind::Stall, 20});
    ASSERT_TRUE(bench.attach());
    bench.session().start(zigzag(60, ""));
    EXPECT_LT(silence_until_noticed(bench), 2.1);
}

TEST(SmoothieSession, TellsWhereTheHeadIsWhileItMoves) {
    SmoothieBench bench;
    ASSERT_TRUE(bench.attach());
    bench.session().start("G21\nG90\nG1 X100 Y50 F3000 S0.2\n");
    ASSERT_TRUE(bench.run_until([&] { return bench.machine().position_mm()[0] > 40.0; }));
    EXPECT_NEAR(bench.session().status().machine_position_mm[0], bench.machine().position_mm()[0],
                50.0 * 0.25);
    EXPECT_GT(bench.session().status().machine_position_mm[0], 20.0);
}

// A beam by hand that nobody ends is not given.
TEST(SmoothieSession, FiresByHandForATimeOnly) {
    SmoothieBench bench;
    ASSERT_TRUE(bench.attach());
    EXPECT_THROW(bench.session().console("fire 10"), Refused);
    bench.session().console("fire 10 200");
    ASSERT_TRUE(bench.run_until([&] { return bench.machine().beam_power() > 0.0; }, 1.0));
    EXPECT_EQ(bench.machine().beam_power(), 0.1);
    ASSERT_TRUE(bench.run_until([&] { return bench.machine().beam_power() == 0.0; }, 1.0));
    bench.session().console("M221 S50");
    bench.session().start("G21\nG90\nG1 X10 F3000 S1\n");
    ASSERT_TRUE(bench.finish_job());
    EXPECT_EQ(bench.burnt().back().s, 0.5);
}

}  // namespace
}  // namespace leafcutter::drivers
