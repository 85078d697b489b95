#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drivers/sim/marlin_machine.h"
#include "drivers/sim/smoothie_machine.h"
#include "drivers/transport.h"
#include "line_bench.h"

namespace leafcutter::drivers {
namespace {

using testing::HasSubstr;
using Firmware = MarlinSession::Firmware;
using Kind = WireFault::Kind;
using Bench = MachineBench<MarlinMachine, MarlinMachineOptions, Firmware::Marlin>;

TEST(NumberedLine, CarriesTheExclusiveOrOfWhatStandsBeforeTheStar) {
    EXPECT_EQ(numbered_line(0, "M110 N0"), "N0 M110 N0*125\n");
    EXPECT_THROW(numbered_line(1, "G1 X1*5"), std::invalid_argument);
    EXPECT_THROW(numbered_line(1, "G1\nX1"), std::invalid_argument);
    EXPECT_THROW(numbered_line(1, std::string(95, 'X')), std::invalid_argument);
}

TEST(MarlinProtocol, ReadsAnswersInAnySplit) {
    const std::string said =
        "start\nok\nok N5 P15 B3\nError:checksum mismatch, Last Line: 6\n"
        "Resend: 7\nrs N8\necho:busy: processing\n"
        "X:1.50 Y:-2.00 Z:0.00 E:0.00 Count X:120 Y:-160 Z:0\n!!\n";
    using Event = MarlinEvent::Kind;
    const std::vector<Event> expected = {Event::Restart, Event::Ack,      Event::Ack,
                                         Event::Error,   Event::Resend,   Event::Resend,
                                         Event::Busy,    Event::Position, Event::Halted};
    for (std::size_t at = 0; at <= said.size(); ++at) {
        MarlinProtocol protocol;
        std::vector<MarlinEvent> events = protocol.receive(said.substr(0, at));
        for (MarlinEvent& event : protocol.receive(said.substr(at))) {
            events.push_back(std::move(event));
        }
        ASSERT_EQ(events.size(), expected.size());
        for (std::size_t i = 0; i < events.size(); ++i) {
            EXPECT_EQ(events[i].kind, expected[i]) << events[i].text;
        }
        EXPECT_EQ(events[4].number, 7U);
        EXPECT_EQ(events[5].number, 8U);
    }
}

TEST(MarlinSession, RunsAProgramToItsEnd) {
    Bench bench;
    expect_whole(bench, 20);
    EXPECT_EQ(bench.session().resends(), 0U);
    EXPECT_EQ(bench.session().progress().lines_acknowledged, 26U);
    EXPECT_EQ(bench.session().status().state, MachineState::Idle);
    EXPECT_EQ(bench.machine().bytes_dropped(), 0U);
}

TEST(MarlinSession, FillsTheBuffersOfAControllerThatCountsThem) {
    MarlinMachineOptions options;
    options.advanced_ok = true;
    Bench bench(options);
    expect_whole(bench, 40);
    EXPECT_EQ(bench.machine().bytes_dropped(), 0U);
}

TEST(MarlinSession, IsNotConfusedByTemperatures) {
    MarlinMachineOptions options;
    options.temperature_every_s = 0.5;
    Bench bench(options);
    expect_whole(bench, 40);
    EXPECT_THAT(bench.said, HasSubstr("T:21.56"));
}

TEST(MarlinSession, WorksWithoutBusyMessages) {
    MarlinMachineOptions options;
    options.keeps_alive = false;
    Bench bench(options);
    expect_whole(bench, 25);
}

// Wherever one line or one answer is disturbed: nothing is lost, nothing burnt twice, and it costs
// two seconds at most.
TEST(MarlinSession, HealsEveryFaultOfTheWireWithinTwoSeconds) {
    for (const bool advanced : {true, false}) {
        MarlinMachineOptions options;
        options.advanced_ok = advanced;
        Bench sound(options);
        expect_whole(sound, 25);
        for (const Kind kind : {Kind::FlipBit, Kind::DropLine, Kind::DropByte, Kind::DropOk,
                                Kind::GarbleOk, Kind::DoubleOk}) {
            for (std::size_t at = 4; at < 40; ++at) {
                options.ok_after_resend = at % 2 == 0;
                options.knows_m118 = at % 3 != 0;
                Bench bench(options, WireFault{kind, at});
                expect_whole(bench, 25);
                EXPECT_LT(bench.now_s(), sound.now_s() + 2.0)
                    << "fault " << static_cast<int>(kind) << " at " << at;
                expect_on_zigzag(bench.burnt());
                EXPECT_EQ(bench.machine().bytes_dropped(), 0U);
            }
        }
    }
}

TEST(MarlinSession, NoticesWithinTwoSecondsThatTheControllerIsSilent) {
    for (std::size_t at = 12; at < 50; ++at) {
        Bench bench({}, WireFault{Kind::Stall, at});
        ASSERT_TRUE(bench.attach());
        bench.session().start(zigzag(60));
        EXPECT_LT(silence_until_noticed(bench), 2.0) << at;
        EXPECT_EQ(bench.session().last_words(), "M112\n");
    }
}

// One that was built to say nothing while a line takes long looks the same at a long move.
TEST(MarlinSession, WaitsLongerForAControllerThatNeverSaysThatItIsBusy) {
    MarlinMachineOptions options;
    options.keeps_alive = false;
    Bench bench(options, WireFault{Kind::Stall, 20});
    ASSERT_TRUE(bench.attach());
    bench.session().start(zigzag(60));
    EXPECT_LT(silence_until_noticed(bench), 20.1);
}

TEST(MarlinSession, HoldsInTheDarkAndGoesOnAsIfNothingHadBeen) {
    Bench bench;
    ASSERT_TRUE(bench.attach());
    bench.session().start(zigzag(60));
    ASSERT_TRUE(bench.run_until([&] { return bench.burnt_mm() > 100.0; }));
    bench.session().hold();
    EXPECT_EQ(bench.session().status().state, MachineState::Hold);
    EXPECT_THAT(bench.session().status().message, HasSubstr("moves under way"));
    ASSERT_TRUE(bench.run_until([&] { return bench.session().status().message.empty(); }));
    EXPECT_FALSE(bench.machine().at_rest() && bench.machine().beam_power() > 0.0);
    const double burnt = bench.burnt_mm();
    EXPECT_LT(burnt, zigzag_mm(60) - 100.0);
    EXPECT_EQ(bench.machine().beam_power(), 0.0);
    bench.run_until([] { return false; }, 3.0);
    EXPECT_EQ(bench.burnt_mm(), burnt);
    EXPECT_EQ(bench.session().status().state, MachineState::Hold);
    bench.session().resume();
    ASSERT_TRUE(bench.finish_job());
    EXPECT_NEAR(bench.burnt_mm(), zigzag_mm(60), 0.05);
    expect_on_zigzag(bench.burnt());
}

TEST(MarlinSession, CancelsInTheDarkAndOnThePathAndTakesTheNextProgram) {
    for (const bool emergency_parser : {true, false}) {
        for (const bool advanced : {true, false}) {
            for (double at_mm = 20.0; at_mm < 1500.0; at_mm += 97.0) {
                MarlinMachineOptions options;
                options.emergency_parser = emergency_parser;
                options.advanced_ok = advanced;
                Bench bench(options);
                ASSERT_TRUE(bench.attach());
                bench.session().start(zigzag(60));
                ASSERT_TRUE(bench.run_until([&] { return bench.burnt_mm() > at_mm; }));
                bench.session().cancel();
                ASSERT_TRUE(bench.finish_job());
                EXPECT_EQ(bench.session().progress().outcome, JobOutcome::Aborted);
                EXPECT_EQ(bench.machine().beam_power(), 0.0);
                EXPECT_TRUE(bench.machine().at_rest());
                expect_on_zigzag(bench.burnt());
                EXPECT_LT(bench.burnt_mm(), at_mm + (emergency_parser ? 5.0 : 22.0) * kSide);
                bench.session().start("G21\nG90\nG0 X5 Y5\n");
                ASSERT_TRUE(bench.finish_job());
                EXPECT_NEAR(bench.machine().position_mm()[0], 5.0, 1e-9);
            }
        }
    }
}

TEST(MarlinSession, StopsAtOnceAndMustBeReset) {
    Bench bench;
    ASSERT_TRUE(bench.attach());
    bench.session().start(zigzag(60));
    ASSERT_TRUE(bench.run_until([&] { return bench.burnt_mm() > 100.0; }));
    bench.session().stop();
    bench.step();
    EXPECT_TRUE(bench.machine().killed());
    EXPECT_EQ(bench.machine().beam_power(), 0.0);
    EXPECT_EQ(bench.session().progress().outcome, JobOutcome::Aborted);
    EXPECT_THROW(bench.session().start(zigzag(1)), Refused);
    bench.machine().power_cycle();
    ASSERT_TRUE(bench.attach());
    bench.session().start(zigzag(1));
    EXPECT_TRUE(bench.finish_job());
    EXPECT_EQ(bench.session().progress().outcome, JobOutcome::Done);
}

// Why a program is refused; empty if it isn't.
std::string refusal(LineBench& bench, const std::string& program) {
    EXPECT_TRUE(bench.attach());
    try {
        bench.session().start(program);
    } catch (const ProgramRefused& refused) {
        return refused.what();
    }
    EXPECT_TRUE(bench.finish_job());
    return {};
}

// Of Marlin's laser modes only M4 I goes out when the planner runs empty.
TEST(MarlinSession, RefusesABeamThatBurnsWhileTheHeadStands) {
    for (const char* beam : {"M3 S100", "M3 I1 S100", "M3 I1", "M4 S100"}) {
        Bench bench;
        EXPECT_THAT(refusal(bench, fmt::format("G21\n{}\nG1 X10 F600\nM5\n", beam)),
                    AllOf(HasSubstr("line 2"), HasSubstr("M4 I")))
            << beam;
        EXPECT_EQ(bench.session().progress().outcome, JobOutcome::Done);
    }
    Bench bench;
    EXPECT_EQ(refusal(bench, "G21\nM4 I1 S0\nG1 X10 F600 S9\nM5\n"), "");
    EXPECT_THAT(refusal(bench, "M4 I1 S9\nG1 X10 F600\n"), HasSubstr("must end with M5"));
}

TEST(MarlinSession, HoldsAProgramAgainstFullPowerAndTheBed) {
    MarlinMachineOptions options;
    options.bed_mm = {235.0, 220.0};
    Bench bench(options);
    EXPECT_THAT(refusal(bench, "M4 I1 S0\nG1 X9 F600 S256\nM5\n"), HasSubstr("s_max=255"));
    EXPECT_THAT(refusal(bench, "G0 X236\n"), HasSubstr("235.0"));
    EXPECT_THAT(refusal(bench, "G0 X5 Y-1\n"), HasSubstr("only from Y0.0 to Y220.0"));
    EXPECT_THAT(refusal(bench, "G1 X5\n"), HasSubstr("feed"));
    EXPECT_THAT(refusal(bench, "G20\nG0 X5\n"), HasSubstr("inches"));
    EXPECT_THAT(refusal(bench, "M106 S255\n"), HasSubstr("M106"));
    EXPECT_EQ(refusal(bench, "G0 X235 Y220\nG4 P1\nM400\n"), "");
    EXPECT_EQ(bench.session().progress().outcome, JobOutcome::Done)
        << bench.session().progress().reason;
    bench.session().console("G92 X-10");
    ASSERT_TRUE(
        bench.run_until([&] { return bench.session().status().state == MachineState::Idle; }));
    EXPECT_EQ(refusal(bench, "G0 X-5\n"), "");  // Nobody knows where X0 is now.
    EXPECT_THAT(refusal(bench, "G0 X0\nG0 X236\n"), HasSubstr("236.0 mm long"));
}

TEST(MarlinSession, TakesTheBedAndFullPowerItIsGiven) {
    MarlinOptions options;
    options.s_max = 100.0;
    options.power_cap_percent = 50.0;
    options.bed_mm = {300.0, 200.0};
    MarlinSession session(Firmware::Marlin, Session::Time{}, options);
    const auto say = [&](const char* text) { session.receive(text, Session::Time{}); };
    say("start\n");
    say("FIRMWARE_NAME:Marlin 2.0.9 SOURCE_CODE_URL:x\nok\nok\nX:0 Y:0 Z:0\n");
    ASSERT_TRUE(session.attached());
    EXPECT_THROW(session.start("G0 X301\n"), ProgramRefused);
    EXPECT_THROW(session.start("M4 I1\nG1 X1 F9 S51\nM5\n"), ProgramRefused);
    EXPECT_NO_THROW(session.start("M4 I1\nG1 X1 F9 S50\nM5\n"));
}

// A controller may ask for lines again that it has answered (another ok came twice).
TEST(MarlinSession, CountsALineOnceThatIsAskedForAgain) {
    MarlinSession session(Firmware::Marlin, Session::Time{});
    Session::Time now{};
    const auto say = [&](const char* text) {
        now += std::chrono::milliseconds(200);
        session.receive(text, now);
        session.tick(now);
    };
    say("start\n");
    say("FIRMWARE_NAME:Marlin 2.0.9 SOURCE_CODE_URL:x\nok\nok\nX:0 Y:0 Z:0\n");
    session.start("G0 X1\nG0 X2\nG0 X3\n");
    const auto progress = [&] { return session.progress(); };
    while (progress().lines_acknowledged < 2) {
        say("ok\n");
    }
    for (int i = 0; i < 3; ++i) {
        say("Resend: 4\n");
        say("ok\n");
        say("ok\n");
        ASSERT_LE(progress().lines_acknowledged, progress().lines_sent);
    }
}

TEST(MarlinSession, FailsTheJobOfAControllerThatKnowsNoLaser) {
    MarlinMachineOptions options;
    options.knows_lasers = false;
    Bench bench(options);
    ASSERT_TRUE(bench.attach());
    bench.session().start(zigzag(10));
    ASSERT_TRUE(bench.finish_job());
    EXPECT_EQ(bench.session().progress().outcome, JobOutcome::Failed);
    EXPECT_THAT(bench.session().progress().reason, HasSubstr("line 5 (M4I1S0): echo:Unknown"));
    EXPECT_TRUE(
        bench.run_until([&] { return bench.session().status().state == MachineState::Idle; }));
}

TEST(MarlinSession, FailsTheJobOfAControllerThatRestarts) {
    Bench bench({}, WireFault{Kind::Reset, 20});
    ASSERT_TRUE(bench.attach());
    bench.session().start(zigzag(60));
    ASSERT_TRUE(bench.finish_job());
    EXPECT_EQ(bench.session().progress().outcome, JobOutcome::Failed);
    EXPECT_THAT(bench.session().progress().reason, HasSubstr("restarted"));
    EXPECT_EQ(bench.machine().beam_power(), 0.0);
    EXPECT_TRUE(bench.attach());
}

TEST(MarlinSession, JogsHomesAndComesToRest) {
    Bench bench;
    ASSERT_TRUE(bench.attach());
    const auto idle = [&] { return bench.session().status().state == MachineState::Idle; };
    bench.session().jog({12.0, -3.0, 3000.0});
    EXPECT_EQ(bench.session().status().state, MachineState::Jog);
    ASSERT_TRUE(bench.run_until(idle));
    EXPECT_NEAR(bench.machine().position_mm()[0], 12.0, 1e-9);
    EXPECT_TRUE(bench.session().may_close());
    bench.session().home();
    EXPECT_EQ(bench.session().status().state, MachineState::Home);
    ASSERT_TRUE(bench.run_until(idle));
    EXPECT_EQ(bench.machine().position_mm()[0], 0.0);
}

TEST(MarlinSession, EndsAJogAtOnce) {
    Bench bench;
    ASSERT_TRUE(bench.attach());
    bench.session().jog({300.0, 0.0, 3000.0});
    ASSERT_TRUE(bench.run_until([&] { return bench.machine().position_mm()[0] > 20.0; }));
    bench.session().jog_cancel();
    ASSERT_TRUE(
        bench.run_until([&] { return bench.session().status().state == MachineState::Idle; }));
    EXPECT_LT(bench.machine().position_mm()[0], 40.0);
}

TEST(MarlinSession, FindsOutThatASmoothiewareAnswers) {
    LineBench bench(Firmware::Marlin, std::make_unique<SmoothieMachine>());
    expect_whole(bench, 10, "");
    EXPECT_THAT(bench.session().status().firmware, HasSubstr("Smoothie"));
    EXPECT_EQ(bench.session().last_words(), "\x18");
}

TEST(MarlinSession, SaysThatAGrblAnswers) {
    MarlinSession session(Firmware::Marlin, Session::Time{});
    session.receive("\r\nGrbl 1.1h ['$' for help]\r\n", Session::Time{});
    EXPECT_THROW(session.tick(Session::Time{}), LinkLost);
}

}  // namespace
}  // namespace leafcutter::drivers
