#include <cmath>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drivers/marlin/session.h"
#include "drivers/sim/marlin_machine.h"

namespace leafcutter::drivers {
namespace {

using testing::HasSubstr;

// A session against the simulated controller, both stepped by a clock of the test.
class Bench {
public:
    explicit Bench(const MarlinMachineOptions& options = {})
        : machine_(options), session_(MarlinSession::Firmware::Marlin, now_) {}

    MarlinSession& session() { return session_; }
    MarlinMachine& machine() { return machine_; }

    void step(double seconds = 0.005) {
        now_ += std::chrono::duration_cast<Session::Time::duration>(
            std::chrono::duration<double>(seconds));
        std::string answer = machine_.feed(session_.take_output());
        answer += machine_.advance(seconds);
        session_.receive(answer, now_);
        session_.tick(now_);
    }

    template <typename Done>
    bool run_until(const Done& done, double seconds = 300.0) {
        for (double t = 0.0; t < seconds; t += 0.005) {
            if (done()) {
                return true;
            }
            step();
        }
        return done();
    }

    bool attach() {
        return run_until([this] { return session_.attached(); }, 10.0);
    }

    bool finish_job() {
        return run_until([this] { return session_.progress().outcome != JobOutcome::Running; });
    }

    double burnt_mm() const {
        double sum = 0.0;
        for (const BurntPiece& piece : machine_.beam_log().pieces()) {
            sum += std::hypot(piece.x1_mm - piece.x0_mm, piece.y1_mm - piece.y0_mm);
        }
        return sum;
    }

private:
    Session::Time now_{std::chrono::hours(1)};
    MarlinMachine machine_;
    MarlinSession session_;
};

std::string zigzag(int lines) {
    std::string text = "; a comment\nG21\nG90\nG0 X0 Y0 S0\nM4 I1 S0\n";
    for (int i = 0; i < lines; ++i) {
        text += fmt::format("G1 X{} Y{} S500 F6000\n", i % 2 == 0 ? 60 : 0, i);
    }
    return text + "M5 S0\nG0 X0 Y0\n";
}

double zigzag_mm(int lines) {
    return 60.0 + (lines - 1) * std::hypot(60.0, 1.0);
}

void expect_whole(Bench& bench, int lines) {
    ASSERT_TRUE(bench.attach());
    bench.session().start(zigzag(lines));
    ASSERT_TRUE(bench.finish_job());
    EXPECT_EQ(bench.session().progress().outcome, JobOutcome::Done)
        << bench.session().progress().reason;
    EXPECT_NEAR(bench.burnt_mm(), zigzag_mm(lines), 0.05);
    EXPECT_EQ(bench.machine().overruns(), 0U);
    EXPECT_EQ(bench.machine().beam_power(), 0.0);
}

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
    using Kind = MarlinEvent::Kind;
    const std::vector<Kind> expected = {Kind::Restart, Kind::Ack,      Kind::Ack,
                                        Kind::Error,   Kind::Resend,   Kind::Resend,
                                        Kind::Busy,    Kind::Position, Kind::Halted};
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
}

TEST(MarlinSession, FillsTheBuffersOfAControllerThatCountsThem) {
    MarlinMachineOptions options;
    options.advanced_ok = true;
    Bench bench(options);
    expect_whole(bench, 40);
}

// One byte wrong on the link, wherever it happens: the line comes again and nothing is lost.
TEST(MarlinSession, SendsAgainWhatALinkSpoiled) {
    for (std::size_t line = 4; line < 40; ++line) {
        for (const bool ok_after_resend : {true, false}) {
            for (const bool advanced : {true, false}) {
                MarlinMachineOptions options;
                options.flip_bit = line;
                options.ok_after_resend = ok_after_resend;
                options.advanced_ok = advanced;
                Bench bench(options);
                expect_whole(bench, 25);
                EXPECT_GE(bench.session().resends(), 1U) << line;
            }
        }
    }
}

TEST(MarlinSession, HealsAnAnswerThatNeverCame) {
    for (std::size_t answer = 3; answer < 40; ++answer) {
        for (const bool advanced : {true, false}) {
            MarlinMachineOptions options;
            options.drop_ok = answer;
            options.advanced_ok = advanced;
            Bench bench(options);
            expect_whole(bench, 25);
        }
    }
}

TEST(MarlinSession, HealsALineThatWasNeverHeard) {
    for (std::size_t line = 4; line < 40; ++line) {
        MarlinMachineOptions options;
        options.drop_line = line;
        Bench bench(options);
        expect_whole(bench, 25);
    }
}

TEST(MarlinSession, HoldsAndGoesOn) {
    Bench bench;
    ASSERT_TRUE(bench.attach());
    bench.session().start(zigzag(60));
    ASSERT_TRUE(bench.run_until([&] { return bench.burnt_mm() > 100.0; }));
    bench.session().hold();
    EXPECT_EQ(bench.session().status().state, MachineState::Hold);
    ASSERT_TRUE(bench.run_until([&] { return bench.machine().at_rest(); }));
    const double burnt = bench.burnt_mm();
    EXPECT_LT(burnt, zigzag_mm(60) - 100.0);
    EXPECT_EQ(bench.machine().beam_power(), 0.0);
    bench.session().resume();
    ASSERT_TRUE(bench.finish_job());
    EXPECT_NEAR(bench.burnt_mm(), zigzag_mm(60), 0.05);
}

TEST(MarlinSession, CancelsWithTheBeamOffAndTakesTheNextProgram) {
    for (const bool emergency_parser : {true, false}) {
        MarlinMachineOptions options;
        options.emergency_parser = emergency_parser;
        Bench bench(options);
        ASSERT_TRUE(bench.attach());
        bench.session().start(zigzag(60));
        ASSERT_TRUE(bench.run_until([&] { return bench.burnt_mm() > 100.0; }));
        bench.session().cancel();
        ASSERT_TRUE(bench.finish_job());
        EXPECT_EQ(bench.session().progress().outcome, JobOutcome::Aborted);
        EXPECT_EQ(bench.machine().beam_power(), 0.0);
        EXPECT_TRUE(bench.machine().at_rest());
        bench.session().start("G21\nG90\nG0 X5 Y5\n");
        ASSERT_TRUE(bench.finish_job());
        EXPECT_NEAR(bench.machine().position_mm()[0], 5.0, 1e-9);
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
}

TEST(MarlinSession, RefusesABeamThatBurnsWhileTheHeadStands) {
    Bench bench;
    ASSERT_TRUE(bench.attach());
    try {
        bench.session().start("G21\nM3 S500\nG1 X10 F600\n");
        FAIL();
    } catch (const ProgramRefused& refused) {
        EXPECT_THAT(refused.what(), HasSubstr("line 2"));
    }
    EXPECT_EQ(bench.session().progress().outcome, JobOutcome::Done);
}

TEST(MarlinSession, FailsTheJobOfAControllerThatRestarts) {
    Bench bench;
    ASSERT_TRUE(bench.attach());
    bench.session().start(zigzag(60));
    bench.step();
    bench.session().receive("start\n", Session::Time{std::chrono::hours(2)});
    EXPECT_EQ(bench.session().progress().outcome, JobOutcome::Failed);
}

TEST(MarlinSession, JogsAndComesToRest) {
    Bench bench;
    ASSERT_TRUE(bench.attach());
    bench.session().jog({12.0, -3.0, 3000.0});
    ASSERT_TRUE(
        bench.run_until([&] { return bench.session().status().state == MachineState::Idle; }));
    EXPECT_NEAR(bench.machine().position_mm()[0], 12.0, 1e-9);
    EXPECT_TRUE(bench.session().may_close());
}

}  // namespace
}  // namespace leafcutter::drivers
