#include <array>
#include <cmath>
#include <random>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drivers/transport.h"
#include "tests/drivers/stepped_machine.h"

namespace leafcutter::drivers {
namespace {

using testing::HasSubstr;

// A long line to the right and back, then many short ones.
std::string zigzag(int lines) {
    std::string text = "G21\nG90\nM4 S0\nG0 X10 Y10\nG1 F3000\n";
    for (int i = 0; i < lines; ++i) {
        text += fmt::format("G1 X{} Y{} S500\n", i % 2 == 0 ? 100 : 10, 10 + i);
    }
    return text + "M5 S0\nG0 X0 Y0\n";
}

double burnt_mm(GrblMachine& machine) {
    double sum = 0.0;
    for (const BurntPiece& piece : machine.beam_log().pieces()) {
        sum += std::hypot(piece.x1_mm - piece.x0_mm, piece.y1_mm - piece.y0_mm);
    }
    return sum;
}

double setting(const GrblSession& session, int number) {
    for (const MachineSetting& each : session.settings()) {
        if (each.key == fmt::format("${}", number)) {
            return each.value;
        }
    }
    return std::nan("");
}

double zigzag_mm(int lines) {
    return 90.0 + (lines - 1) * std::hypot(90.0, 1.0);
}

TEST(GrblSession, AttachesAndLearnsTheSettings) {
    SteppedMachine bench;
    ASSERT_TRUE(bench.attach());
    EXPECT_EQ(bench.session().status().firmware, "Grbl 1.1h");
    EXPECT_EQ(bench.session().status().state, MachineState::Idle);
    EXPECT_EQ(bench.session().progress().outcome, JobOutcome::Done);
}

TEST(GrblSession, BringsARunningMachineToAStandBeforeItAttaches) {
    SteppedMachine bench;
    bench.machine().feed("M3S500\nG1X300F1000\n");
    bench.machine().advance(1.0);
    ASSERT_TRUE(bench.attach());
    EXPECT_EQ(bench.machine().state(),
              GrblMachine::State::Idle);  // No alarm: the position is kept.
    EXPECT_EQ(bench.machine().beam_power(), 0.0);
}

TEST(GrblSession, RunsAProgramToItsEnd) {
    SteppedMachine bench;
    ASSERT_TRUE(bench.attach());
    bench.session().start(zigzag(20));
    ASSERT_TRUE(bench.finish_job());
    const JobProgress progress = bench.session().progress();
    EXPECT_EQ(progress.outcome, JobOutcome::Done);
    EXPECT_EQ(progress.lines_total, 27U);
    EXPECT_EQ(progress.lines_sent, 27U);
    EXPECT_EQ(progress.lines_acknowledged, 27U);
    EXPECT_EQ(bench.machine().state(), GrblMachine::State::Idle);
    EXPECT_NEAR(burnt_mm(bench.machine()), zigzag_mm(20), 0.05);
    EXPECT_NEAR(bench.session().status().work_position_mm[0], 0.0, 1e-9);
}

TEST(GrblSession, IsDoneOnlyWhenTheMachineStands) {
    SteppedMachine bench;
    ASSERT_TRUE(bench.attach());
    bench.session().start("G21\nG1 X100 F600\n");
    ASSERT_TRUE(
        bench.run_until([&] { return bench.session().progress().lines_acknowledged == 2; }, 5.0));
    EXPECT_EQ(bench.session().progress().outcome, JobOutcome::Running);
    ASSERT_TRUE(bench.finish_job());
    EXPECT_NEAR(bench.machine().position_mm()[0], 100.0, 1e-9);
}

TEST(GrblSession, NeverOverflowsTheReceiveBufferWhateverTheDelays) {
    for (unsigned seed = 1; seed <= 8; ++seed) {
        std::mt19937 random(seed);
        GrblMachineOptions options;
        options.line_time_s = 0.02;
        SteppedMachine bench(options);
        bench.delay = [&random] { return static_cast<int>(random() % 12); };
        ASSERT_TRUE(bench.attach());
        std::string text = "G21\nG90\nM4 S10\nF3000\n";
        double x = 0.0;
        for (int i = 0; i < 150; ++i) {
            const std::size_t length = 1 + random() % 79;
            if (length < 5) {
                text += "M9\n";
                continue;
            }
            x = static_cast<double>(random() % 100);
            std::string line = fmt::format("G1X{:02.0f}.", x);
            line.resize(std::max(length, line.size()), '0');
            text += line + "\n";
        }
        bench.session().start(text + "M5\n");
        ASSERT_TRUE(bench.finish_job()) << seed;
        EXPECT_EQ(bench.session().progress().outcome, JobOutcome::Done)
            << bench.session().progress().reason;
        EXPECT_EQ(bench.machine().bytes_dropped(), 0U) << seed;
        EXPECT_LE(bench.most_bytes_in_flight(), 127U) << seed;
        EXPECT_NEAR(bench.machine().position_mm()[0], x, 1e-9) << seed;
    }
}

TEST(GrblSession, PollsTheStatusAtFiveHertzWhateverTheStreamDoes) {
    SteppedMachine bench;
    ASSERT_TRUE(bench.attach());
    bench.session().start(zigzag(50));
    int reports = 0;
    bench.session().take_lines();
    const double begin = bench.now_s();
    while (bench.now_s() < begin + 10.0) {
        bench.step();
        for (const std::string& line : bench.session().take_lines()) {
            reports += line[0] == '<' ? 1 : 0;
        }
    }
    EXPECT_GE(reports, 48);
    EXPECT_LE(reports, 51);
}

TEST(GrblSession, FailsAtAnErrorAndNamesTheLine) {
    SteppedMachine bench;
    ASSERT_TRUE(bench.attach());
    // An arc whose end isn't on its circle: only the controller sees that.
    bench.session().start("G21\nG90\nM4 S100\nG1 X50 F1000\nG2 X90 Y9 I5 J0\nG1 X100\nM5\n");
    ASSERT_TRUE(bench.finish_job());
    EXPECT_EQ(bench.session().progress().outcome, JobOutcome::Failed);
    EXPECT_THAT(bench.session().progress().reason, HasSubstr("line 5"));
    EXPECT_THAT(bench.session().progress().reason, HasSubstr("error:33"));
    ASSERT_TRUE(bench.run_until([&] { return bench.session().ready(); }, 5.0));
    EXPECT_EQ(bench.machine().state(), GrblMachine::State::Idle);
    EXPECT_LT(bench.machine().position_mm()[0], 50.0);  // What was queued behind did not run.
}

TEST(GrblSession, CancelKeepsThePositionAndTurnsTheBeamOff) {
    SteppedMachine bench;
    ASSERT_TRUE(bench.attach());
    bench.session().start(zigzag(50));
    ASSERT_TRUE(bench.run_until([&] { return burnt_mm(bench.machine()) > 200.0; }));
    bench.session().cancel();
    ASSERT_TRUE(bench.finish_job(3.0));
    EXPECT_EQ(bench.session().progress().outcome, JobOutcome::Aborted);
    ASSERT_TRUE(
        bench.run_until([&] { return bench.session().status().state == MachineState::Idle; }, 2.0));
    EXPECT_EQ(bench.machine().state(), GrblMachine::State::Idle);
    EXPECT_EQ(bench.machine().beam_power(), 0.0);
    const Axes stopped_at = bench.machine().position_mm();
    bench.run_until([] { return false; }, 2.0);
    EXPECT_EQ(bench.machine().position_mm(), stopped_at);
    bench.session().start("G21\nG0 X0 Y0\n");
    ASSERT_TRUE(bench.finish_job());
    EXPECT_EQ(bench.machine().position_mm(), Axes{});
}

TEST(GrblSession, StopCutsTheBeamWithinATenthOfASecond) {
    SteppedMachine bench;
    ASSERT_TRUE(bench.attach());
    bench.session().start(zigzag(50));
    ASSERT_TRUE(bench.run_until([&] { return bench.machine().beam_power() > 400.0; }));
    bench.session().stop();
    const double asked_at = bench.now_s();
    EXPECT_EQ(bench.session().progress().outcome, JobOutcome::Aborted);
    ASSERT_TRUE(bench.run_until([&] { return bench.machine().beam_power() == 0.0; }, 1.0));
    EXPECT_LE(bench.now_s() - asked_at, 0.1);
    ASSERT_TRUE(bench.run_until([&] { return bench.session().ready(); }, 3.0));
    ASSERT_TRUE(bench.run_until(
        [&] { return bench.session().status().state == MachineState::Alarm; }, 1.0));
    EXPECT_THROW(bench.session().start(zigzag(2)), Refused);
    bench.session().unlock();
    ASSERT_TRUE(
        bench.run_until([&] { return bench.session().status().state == MachineState::Idle; }, 2.0));
}

TEST(GrblSession, HoldsAndResumesAndBurnsAllOfIt) {
    SteppedMachine bench;
    ASSERT_TRUE(bench.attach());
    bench.session().start(zigzag(10));
    ASSERT_TRUE(bench.run_until([&] { return burnt_mm(bench.machine()) > 200.0; }));
    bench.session().hold();
    bench.session().resume();  // Too early for the controller: must not be lost.
    ASSERT_TRUE(
        bench.run_until([&] { return bench.session().status().state == MachineState::Hold; }, 2.0));
    ASSERT_TRUE(bench.finish_job());
    EXPECT_EQ(bench.session().progress().outcome, JobOutcome::Done);
    EXPECT_NEAR(burnt_mm(bench.machine()), zigzag_mm(10), 0.05);
}

TEST(GrblSession, BringsOverridesWhereTheyAreWantedStepByStep) {
    SteppedMachine bench;
    ASSERT_TRUE(bench.attach());
    bench.session().start(zigzag(40));
    ASSERT_TRUE(bench.run_until([&] { return burnt_mm(bench.machine()) > 100.0; }));
    for (const std::array<int, 3>& wanted :
         {std::array<int, 3>{137, 50, 63}, std::array<int, 3>{10, 25, 200},
          std::array<int, 3>{100, 100, 100}}) {
        bench.session().set_overrides(wanted);
        EXPECT_TRUE(bench.run_until(
            [&] { return bench.session().status().override_percent == wanted; }, 6.0));
    }
    bench.session().set_overrides({151, 100, 80});
    ASSERT_TRUE(bench.finish_job());
    EXPECT_EQ(bench.session().progress().outcome, JobOutcome::Done);
}

// Reports that were on their way already show the step before.
TEST(GrblSession, BringsOverridesWhereTheyAreWantedOverASlowLink) {
    for (const int turns : {10, 50, 100, 160}) {  // Of 5 ms
        SteppedMachine bench;
        bench.delay = [turns] { return turns; };
        ASSERT_TRUE(bench.attach());
        bench.session().start(zigzag(60));
        ASSERT_TRUE(bench.run_until([&] { return burnt_mm(bench.machine()) > 100.0; }));
        const std::array<int, 3> wanted{137, 50, 63};
        bench.session().set_overrides(wanted);
        EXPECT_TRUE(bench.run_until(
            [&] { return bench.session().status().override_percent == wanted; }, 30.0))
            << turns << ": " << bench.session().status().override_percent[0];
        bench.session().cancel();
    }
}

TEST(GrblSession, StaysHeldUntilResumed) {
    SteppedMachine bench;
    ASSERT_TRUE(bench.attach());
    bench.session().start(zigzag(10));
    ASSERT_TRUE(bench.run_until([&] { return burnt_mm(bench.machine()) > 100.0; }));
    bench.session().hold();
    bench.run_until([] { return false; }, 20.0);
    EXPECT_EQ(bench.session().status().state, MachineState::Hold);
    EXPECT_EQ(bench.session().progress().outcome, JobOutcome::Running);
    EXPECT_EQ(bench.machine().beam_power(), 0.0);
}

struct FaultCase {
    std::string fault;
    std::string reason;
};

class GrblSessionFault : public testing::TestWithParam<FaultCase> {};

TEST_P(GrblSessionFault, EndsTheJobWithTheBeamOffSoonAfterTheMachineStands) {
    SteppedMachine bench({}, parse_faults(GetParam().fault));
    ASSERT_TRUE(bench.attach());
    bench.session().start(zigzag(30));
    double stood_since = bench.now_s();
    const bool ended = bench.run_until(
        [&] {
            stood_since = bench.machine().at_rest() ? stood_since : bench.now_s();
            return bench.session().progress().outcome != JobOutcome::Running;
        },
        300.0);
    ASSERT_TRUE(ended);
    EXPECT_EQ(bench.session().progress().outcome, JobOutcome::Failed);
    EXPECT_THAT(bench.session().progress().reason, HasSubstr(GetParam().reason));
    EXPECT_LE(bench.now_s() - stood_since, 2.0);
    ASSERT_TRUE(bench.run_until([&] { return bench.session().ready(); }, 5.0));
    EXPECT_EQ(bench.machine().beam_power(), 0.0);
    const double burnt = burnt_mm(bench.machine());
    bench.run_until([] { return false; }, 5.0);
    EXPECT_EQ(burnt_mm(bench.machine()), burnt);  // Nothing goes on by itself.
}

INSTANTIATE_TEST_SUITE_P(Faults,
                         GrblSessionFault,
                         testing::Values(FaultCase{"drop-ok:4", "unanswered"},
                                         FaultCase{"drop-ok:20", "unanswered"},
                                         FaultCase{"drop-ok:40", "unanswered"},
                                         FaultCase{"alarm:12", "hard limit"},
                                         FaultCase{"reset:12", "restarted"}),
                         [](const auto& fault) {
                             std::string name = fault.param.fault;
                             std::replace_if(
                                 name.begin(), name.end(),
                                 [](char c) { return c == '-' || c == ':'; }, '_');
                             return name;
                         });

// What becomes of the `count`-th "ok" of the job on its way to the sender.
std::function<void(std::string&)> noise_at(int count, const std::string& instead) {
    return [left = count, instead](std::string& answer) mutable {
        for (std::size_t at = 0; left > 0 && (at = answer.find("ok\r\n", at)) != answer.npos;
             at += 4) {
            if (--left == 0) {
                answer.replace(at, 4, instead);
                return;
            }
        }
    };
}

class GrblSessionNoise : public testing::TestWithParam<bool> {};

// With and without Bf in the reports ($10).
TEST_P(GrblSessionNoise, HealsAnOkWithAFlippedBitAndBurnsEverythingOnce) {
    for (const int at : {1, 4, 5, 12, 20, 35}) {
        for (const char* garbled : {"\x7fk\r\n", "oc\r\n", "k\r\n", "o\r\n"}) {
            SteppedMachine bench;
            bench.machine().settings().set(10, GetParam() ? 3 : 1);
            ASSERT_TRUE(bench.attach());
            bench.noise = noise_at(at, garbled);
            bench.session().start(zigzag(30));
            ASSERT_TRUE(bench.finish_job());
            EXPECT_EQ(bench.session().progress().outcome, JobOutcome::Done)
                << at << garbled << bench.session().progress().reason;
            EXPECT_EQ(bench.session().progress().lines_acknowledged, 37U);
            EXPECT_EQ(bench.session().answers_healed(), 1U) << at << garbled;
            EXPECT_NEAR(burnt_mm(bench.machine()), zigzag_mm(30), 0.05);
            EXPECT_EQ(bench.machine().bytes_dropped(), 0U);
        }
    }
}

TEST_P(GrblSessionNoise, NeverOverfillsTheBufferAfterADoubledOk) {
    for (const int at : {1, 2, 6, 12, 30}) {
        GrblMachineOptions options;
        options.line_time_s = 0.002;
        SteppedMachine bench(options);
        bench.machine().settings().set(10, GetParam() ? 3 : 1);
        ASSERT_TRUE(bench.attach());
        bench.noise = noise_at(at, "ok\r\nok\r\n");
        bench.session().start(zigzag(30));
        ASSERT_TRUE(bench.finish_job());
        EXPECT_EQ(bench.session().progress().outcome, JobOutcome::Done)
            << bench.session().progress().reason;
        EXPECT_EQ(bench.machine().bytes_dropped(), 0U) << at;
        EXPECT_NEAR(burnt_mm(bench.machine()), zigzag_mm(30), 0.05);
        EXPECT_NEAR(bench.machine().position_mm()[0], 0.0, 1e-9);
    }
}

TEST_P(GrblSessionNoise, StopsAtOnceAtWhatMayHaveBeenAnError) {
    SteppedMachine bench;
    bench.machine().settings().set(10, GetParam() ? 3 : 1);
    ASSERT_TRUE(bench.attach());
    bench.noise = noise_at(12, "errkr:2\r\n");
    bench.session().start(zigzag(30));
    ASSERT_TRUE(bench.finish_job());
    EXPECT_EQ(bench.session().progress().outcome, JobOutcome::Failed);
    EXPECT_THAT(bench.session().progress().reason, HasSubstr("garbled"));
    ASSERT_TRUE(bench.run_until([&] { return bench.session().ready(); }, 5.0));
    EXPECT_EQ(bench.machine().state(), GrblMachine::State::Idle);  // The position is kept.
    EXPECT_EQ(bench.machine().beam_power(), 0.0);
}

INSTANTIATE_TEST_SUITE_P(Reports, GrblSessionNoise, testing::Bool());

// Answers that come in lumps, reports among them, must not be taken for lost or doubled ones.
TEST(GrblSession, TakesLumpsOfAnswersForNoFault) {
    GrblMachineOptions options;
    options.line_time_s = 0.004;
    SteppedMachine bench(options);
    bench.machine().settings().set(10, 3);
    ASSERT_TRUE(bench.attach());
    std::string kept;
    int turn = 0;
    bench.noise = [&](std::string& answer) {
        kept += answer;
        answer.clear();
        if (++turn % 7 == 0) {
            answer.swap(kept);
        }
    };
    std::string text = "G21\nG90\nM4 S0\nG1 F6000\n";
    for (int i = 0; i < 600; ++i) {
        text += fmt::format("G1X{:.1f}Y{}S200\n", 10.0 + 0.5 * (i % 100), i / 100);
    }
    bench.session().start(text + "M5 S0\nG0 X0 Y0\n");
    ASSERT_TRUE(bench.finish_job());
    EXPECT_EQ(bench.session().progress().outcome, JobOutcome::Done)
        << bench.session().progress().reason;
    EXPECT_EQ(bench.session().answers_healed(), 0U);
}

TEST(GrblSession, NoticesALostOkWhileTheMachineStillRuns) {
    SteppedMachine bench;
    bench.machine().settings().set(10, 3);
    ASSERT_TRUE(bench.attach());
    bool lost = false;
    double lost_at = 0.0;
    bench.noise = [&](std::string& answer) {
        if (!lost && bench.session().progress().lines_acknowledged > 20 && answer == "ok\r\n") {
            answer.clear();
            lost = true;
            lost_at = bench.now_s();
        }
    };
    bench.session().start(zigzag(60));
    ASSERT_TRUE(bench.finish_job());
    EXPECT_EQ(bench.session().progress().outcome, JobOutcome::Failed);
    EXPECT_THAT(bench.session().progress().reason, HasSubstr("unanswered"));
    EXPECT_LT(bench.now_s() - lost_at, 2.0);
    EXPECT_LT(burnt_mm(bench.machine()), zigzag_mm(60) - 90.0);
}

TEST(GrblSession, GivesUpAControllerThatFallsSilent) {
    SteppedMachine bench({}, parse_faults("stall:12"));
    ASSERT_TRUE(bench.attach());
    bench.session().start(zigzag(30));
    const double begin = bench.now_s();
    EXPECT_THROW(bench.finish_job(30.0), LinkLost);
    EXPECT_LT(bench.now_s() - begin, 20.0);
    bench.session().lose_link("silent");
    EXPECT_EQ(bench.session().progress().outcome, JobOutcome::LinkLost);
    EXPECT_EQ(bench.session().status().state, MachineState::Disconnected);
}

TEST(GrblSession, TakesALongDwellForNoLostAnswer) {
    SteppedMachine bench;
    ASSERT_TRUE(bench.attach());
    bench.session().start("G21\nG4 P8\nG0 X1\n");
    ASSERT_TRUE(bench.finish_job());
    EXPECT_EQ(bench.session().progress().outcome, JobOutcome::Done);
}

TEST(GrblSession, ResetsABeamThatStandsLit) {
    SteppedMachine bench;
    ASSERT_TRUE(bench.attach());
    bench.machine().feed("G1F100M3S500\n");  // By somebody else on the same machine.
    ASSERT_GT(bench.machine().beam_power(), 0.0);
    ASSERT_TRUE(bench.run_until([&] { return bench.machine().beam_power() == 0.0; }, 2.0));
    EXPECT_THAT(bench.session().status().message, HasSubstr("beam"));
}

TEST(GrblSession, SendsEepromLinesAlone) {
    SteppedMachine bench;
    ASSERT_TRUE(bench.attach());
    bench.session().start("G21\nG0 X10\nG0 X20\nG10 L20 P1 X0 Y0\nG0 X5\nG0 X6\n");
    bool seen = false;
    ASSERT_TRUE(bench.run_until([&] {
        const std::size_t sent = bench.session().progress().lines_sent;
        const std::size_t answered = bench.session().progress().lines_acknowledged;
        if (sent == 4 && answered == 3) {
            seen = true;
            EXPECT_EQ(bench.session().bytes_in_flight(), std::string("G10L20P1X0Y0\n").size());
        }
        EXPECT_FALSE(sent > 4 && answered < 4);
        return bench.session().progress().outcome != JobOutcome::Running;
    }));
    EXPECT_EQ(bench.session().progress().outcome, JobOutcome::Done);
    EXPECT_NEAR(bench.machine().position_mm()[0], 26.0, 1e-9);
    (void)seen;
}

TEST(GrblSession, ReadsSettingsAndKeepsUpWithThoseEditedByHand) {
    SteppedMachine bench;
    ASSERT_TRUE(bench.attach());
    EXPECT_EQ(setting(bench.session(), 30), 1000.0);
    bench.session().console("$30=500");
    ASSERT_TRUE(bench.run_until([&] { return bench.session().may_close(); }, 3.0));
    EXPECT_EQ(setting(bench.session(), 30), 500.0);
    EXPECT_EQ(bench.machine().settings().get(30), 500.0);
    EXPECT_THROW(bench.session().start("G21\nM4 S600\nG1 X5 F500\nM5\n"), Refused);
}

TEST(GrblSession, EditsSettingsThatTheControllerHasWithinWhatIsSafe) {
    SteppedMachine bench;
    ASSERT_TRUE(bench.attach());
    const auto names = bench.session().settings();
    EXPECT_TRUE(std::any_of(names.begin(), names.end(), [](const MachineSetting& each) {
        return each.key == "$110" && each.name == "X maximum rate, mm/min" && each.value == 6000.0;
    }));
    bench.session().set_setting("$110", 4321.25);
    bench.session().set_setting("11", 0.02);
    ASSERT_TRUE(bench.run_until([&] { return setting(bench.session(), 11) == 0.02; }, 3.0));
    EXPECT_EQ(bench.machine().settings().get(110), 4321.25);
    EXPECT_EQ(setting(bench.session(), 110), 4321.25);
    using Edit = std::pair<const char*, double>;
    for (const auto& [key, value] :
         {Edit{"$0", 2}, Edit{"$32", 0.5}, Edit{"$100", 0}, Edit{"$110", -1}, Edit{"$999", 1},
          Edit{"$", 1}, Edit{"$1=", 1}, Edit{"$J", 1}, Edit{"$130", 1e9},
          Edit{"$12", std::nan("")}}) {
        EXPECT_THROW(bench.session().set_setting(key, value), Refused) << key;
    }
    // Only the controller knows that; it is said, and nothing is believed that it has refused.
    bench.session().set_setting("$20", 1);
    ASSERT_TRUE(bench.run_until([&] { return bench.session().may_close(); }, 3.0));
    EXPECT_EQ(setting(bench.session(), 20), 0.0);
    EXPECT_THAT(bench.session().status().message, HasSubstr("$20=1: error:10"));
    bench.session().start(zigzag(4));
    EXPECT_THROW(bench.session().set_setting("$110", 5000), Refused);
}

TEST(GrblSession, RaisesNoPowerAboveACap) {
    GrblOptions options;
    options.power_cap_percent = 60.0;
    SteppedMachine bench({}, {}, options);
    ASSERT_TRUE(bench.attach());
    EXPECT_THROW(bench.session().set_overrides({100, 100, 110}), Refused);
    EXPECT_NO_THROW(bench.session().set_overrides({110, 100, 90}));
}

// A key held down: a jog every 40 ms, and the head stands soon after it is let go.
TEST(GrblSession, JogsWhileAKeyIsHeldAndStopsWhenItIsLetGo) {
    SteppedMachine bench;
    ASSERT_TRUE(bench.attach());
    for (int i = 0; i < 50; ++i) {
        bench.session().jog({2.0, 0.0, 3000.0});
        for (int turn = 0; turn < 8; ++turn) {
            bench.step();
        }
    }
    const double let_go_s = bench.now_s();
    const double let_go_mm = bench.machine().position_mm()[0];
    EXPECT_GT(let_go_mm, 60.0);
    bench.session().jog_cancel();
    ASSERT_TRUE(
        bench.run_until([&] { return bench.session().status().state == MachineState::Idle; }, 2.0));
    EXPECT_LT(bench.now_s() - let_go_s, 0.6);
    EXPECT_LT(bench.machine().position_mm()[0] - let_go_mm, 10.0);
    bench.run_until([] { return false; }, 1.0);
    EXPECT_LT(bench.machine().position_mm()[0] - let_go_mm, 10.0);  // Nothing comes after.
}

// While it writes its EEPROM the controller hears nothing: no line may be under way then.
TEST(GrblSession, LosesNoByteToAControllerThatWritesItsEeprom) {
    GrblMachineOptions options;
    options.eeprom_time_s = 0.04;
    SteppedMachine bench(options);
    ASSERT_TRUE(bench.attach());
    bench.session().start(
        "G21\nG0 X10\nG10 L20 P1 X0 Y0\nG0 X5\nG10 L2 P2 X3\nG28.1\nG0 X6\nG0 X0\n");
    ASSERT_TRUE(bench.finish_job());
    EXPECT_EQ(bench.session().progress().outcome, JobOutcome::Done)
        << bench.session().progress().reason;
    EXPECT_NEAR(bench.machine().position_mm()[0], 10.0, 1e-9);
}

TEST(GrblSession, RefusesWhatTheMachinesStateForbids) {
    SteppedMachine bench;
    EXPECT_THROW(bench.session().start("G0 X1\n"), Refused);  // Not attached yet.
    bench.machine().settings().set(32, 0);
    ASSERT_TRUE(bench.attach());
    EXPECT_THROW(bench.session().start("G0 X1\n"), Refused);
    bench.session().console("$32=1");
    ASSERT_TRUE(bench.run_until([&] { return bench.session().may_close(); }, 3.0));
    bench.session().start("G1 X50 F1000\n");
    EXPECT_THROW(bench.session().start("G0 X1\n"), Refused);
    EXPECT_THROW(bench.session().jog({1.0, 0.0, 100.0}), Refused);
    EXPECT_THROW(bench.session().home(), Refused);
    EXPECT_THROW(bench.session().console("G0 X1"), Refused);
    ASSERT_TRUE(bench.finish_job());
    EXPECT_THROW(bench.session().console("G0 \x84"), Refused);
}

TEST(GrblSession, JogsWithTheBeamOff) {
    SteppedMachine bench;
    ASSERT_TRUE(bench.attach());
    bench.session().console("G1 F100 M4 S500");
    ASSERT_TRUE(bench.run_until([&] { return bench.session().may_close(); }, 3.0));
    bench.session().jog({10.0, 5.0, 1000.0});
    ASSERT_TRUE(bench.run_until([&] { return bench.machine().position_mm()[0] > 9.999; }, 5.0));
    EXPECT_EQ(burnt_mm(bench.machine()), 0.0);
}

}  // namespace
}  // namespace leafcutter::drivers
