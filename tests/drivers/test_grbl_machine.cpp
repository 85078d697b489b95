#include <cmath>
#include <deque>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drivers/sim/grbl_machine.h"

namespace leafcutter::drivers {
namespace {

using testing::EndsWith;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

// A machine past its banner.
struct Machine : GrblMachine {
    explicit Machine(const GrblMachineOptions& options = {}) : GrblMachine(options) { feed(""); }
    std::string say(const std::string& line) { return feed(fmt::format("{}\n", line)); }
    void settle() {
        while (!at_rest()) {
            advance(0.05);
        }
    }
};

TEST(GrblMachine, GreetsAndAnswersEveryLineOnce) {
    GrblMachine machine;
    EXPECT_EQ(machine.feed(""), "\r\nGrbl 1.1h ['$' for help]\r\n");
    EXPECT_EQ(machine.feed("G21\n"), "ok\r\n");
    EXPECT_EQ(machine.feed("\n"), "ok\r\n");
    EXPECT_EQ(machine.feed("G90\r\n"), "ok\r\nok\r\n");  // \r and \n each end a line.
    EXPECT_EQ(machine.feed("(comment) ; more\n"), "ok\r\n");
}

TEST(GrblMachine, TakesRealTimeBytesOutOfTheStreamAnywhere) {
    Machine machine;
    EXPECT_THAT(machine.feed("G2?1\n"), StartsWith("<Idle|"));
    EXPECT_THAT(machine.say("$G"), HasSubstr("G21"));
    machine.feed("( a ! in a comment");
    EXPECT_EQ(machine.state(), GrblMachine::State::Hold);
}

TEST(GrblMachine, ReportsErrorsByGrblsNumbers) {
    Machine machine;
    const std::vector<std::pair<std::string, int>> cases{{"X", 2},
                                                         {"1", 1},
                                                         {"$GG", 3},
                                                         {"S-1", 4},
                                                         {"$H", 5},
                                                         {"$20=1", 10},
                                                         {"G38.2X1", 20},
                                                         {"G0G1X1", 24},
                                                         {"G20G21", 21},
                                                         {"G1X1", 22},
                                                         {"M3.5", 23},
                                                         {"G0G92X1", 24},
                                                         {"G0X1X2", 25},
                                                         {"G92", 26},
                                                         {"G4", 28},
                                                         {"G59.1X1", 23},
                                                         {"G53G2X1I1F1", 30},
                                                         {"G80X1", 31},
                                                         {"G2Z1F1", 32},
                                                         {"G2X9I1J0F1", 33},
                                                         {"G2X9R1F1", 34},
                                                         {"G2X1F1", 35},
                                                         {"G0X1I1", 36},
                                                         {"G43.1X1", 37},
                                                         {"T300", 38},
                                                         {"G10L2P9X1", 29},
                                                         {"N99999999", 27},
                                                         {"$J=X1", 22},
                                                         {"$J=X1S1F1", 36},
                                                         {std::string(90, 'X'), 11}};
    for (const auto& [line, code] : cases) {
        EXPECT_EQ(machine.say(line), fmt::format("error:{}\r\n", code)) << line;
    }
    EXPECT_EQ(machine.say(std::string("G0X1.") + std::string(74, '0')),
              "ok\r\n");  // 79 characters.
}

// Numbers that no table has a place for.
TEST(GrblMachine, TakesStartupLinesOfAnyNumber) {
    Machine machine;
    for (const char* line : {"$N-5=G21", "$N2=G21", "$N99999999999999999999=G21"}) {
        machine.say(line);
        machine.settle();
        EXPECT_THAT(machine.say("$N"), AllOf(HasSubstr("$N0=\r\n"), HasSubstr("$N1=\r\n"))) << line;
    }
}

TEST(GrblMachine, DropsWhatOverflowsItsReceiveBuffer) {
    Machine machine;
    machine.say("G1F60X1");
    for (int i = 0; i < 14; ++i) {
        machine.say(fmt::format("X{}", i % 2));
    }
    machine.say("X5");  // The planner is full: this line waits, the next stay in the buffer.
    std::string fill;
    while (fill.size() + 5 <= 128) {
        fill += "G0Y1\n";
    }
    machine.feed(fill);
    EXPECT_EQ(machine.bytes_dropped(), 0U);
    machine.feed("G0Y2\n");
    EXPECT_EQ(machine.bytes_dropped(), 2U);
}

TEST(GrblMachine, ScalesThePowerOfM4WithTheSpeedAndNotOfM3) {
    for (const auto& [mode, scaled] : {std::pair<std::string, bool>{"M3", false}, {"M4", true}}) {
        Machine machine;
        machine.say(mode + "S0");
        machine.say("G1X100F3000S600");
        machine.advance(0.05);  // 500 mm/s² for 0.05 s: 25 of 50 mm/s.
        EXPECT_NEAR(machine.beam_power(), scaled ? 300.0 : 600.0, 1e-6) << mode;
        machine.advance(0.5);
        EXPECT_NEAR(machine.beam_power(), 600.0, 1e-6) << mode;
        machine.settle();
        EXPECT_EQ(machine.beam_power(), scaled ? 0.0 : 600.0)
            << mode;  // M3 stays lit: no watchdog.
    }
}

TEST(GrblMachine, KeepsEveryRapidMoveDark) {
    Machine machine;
    machine.say("M4S500");
    machine.say("G0X50");
    machine.say("G1X60F1000");
    machine.say("G0X10");
    machine.settle();
    ASSERT_EQ(machine.beam_log().pieces().size(), 1U);
    EXPECT_NEAR(machine.beam_log().pieces()[0].x0_mm, 50.0, 1e-9);
    EXPECT_NEAR(machine.beam_log().pieces()[0].x1_mm, 60.0, 1e-9);
}

TEST(GrblMachine, LogsABeamThatStandsLit) {
    Machine machine;
    machine.say("G1F100M3S300");
    machine.advance(2.0);
    ASSERT_EQ(machine.beam_log().pieces().size(), 1U);
    const BurntPiece& piece = machine.beam_log().pieces()[0];
    EXPECT_NEAR(piece.t1_s - piece.t0_s, 2.0, 1e-9);
    EXPECT_EQ(piece.s, 300.0);
}

TEST(GrblMachine, MovesByATrapezoidOfTheSetAcceleration) {
    Machine machine;
    machine.say("G1X100F3000");  // 50 mm/s after 0.1 s and 2.5 mm.
    machine.advance(0.1);
    EXPECT_NEAR(machine.position_mm()[0], 2.5, 1e-6);
    machine.advance(1.9);
    EXPECT_NEAR(machine.position_mm()[0], 97.5, 1e-6);
    machine.advance(0.1);
    EXPECT_NEAR(machine.position_mm()[0], 100.0, 1e-6);
    machine.advance(0.01);
    EXPECT_EQ(machine.state(), GrblMachine::State::Idle);
}

TEST(GrblMachine, SlowsDownAtCornersAndNotOnStraightLines) {
    const auto slowest = [](const std::string& second) {
        Machine machine;
        machine.say("G1X50F3000");
        machine.say(second);
        double least = 1e9;
        machine.advance(0.2);
        for (int i = 0; i < 1500; ++i) {
            const auto before = machine.position_mm();
            machine.advance(0.001);
            const auto after = machine.position_mm();
            least = std::min(least, std::hypot(after[0] - before[0], after[1] - before[1]) / 0.001);
        }
        return least;
    };
    EXPECT_GT(slowest("X100"), 49.9);
    // Grbl's junction deviation: v² = a d s/(1-s), s = sin(45°), a = 500·√2 along the diagonal.
    const double s = std::sqrt(0.5);
    EXPECT_NEAR(slowest("Y50"), std::sqrt(500.0 * std::sqrt(2.0) * 0.01 * s / (1.0 - s)), 0.5);
}

TEST(GrblMachine, HoldsKeepsThePlaceAndGoesOn) {
    Machine machine;
    machine.say("M4S500");
    machine.say("G1X100F3000");
    machine.advance(1.0);
    machine.feed("!");
    EXPECT_THAT(machine.feed("?"), StartsWith("<Hold:1|"));
    machine.feed("~");  // Ignored while slowing down.
    EXPECT_EQ(machine.state(), GrblMachine::State::Hold);
    machine.advance(0.2);
    EXPECT_THAT(machine.feed("?"), StartsWith("<Hold:0|"));
    EXPECT_EQ(machine.beam_power(), 0.0);
    const double held_at = machine.position_mm()[0];
    machine.advance(5.0);
    EXPECT_EQ(machine.position_mm()[0], held_at);
    machine.feed("~");
    machine.settle();
    EXPECT_NEAR(machine.position_mm()[0], 100.0, 1e-9);
    double burnt = 0.0;
    for (const BurntPiece& piece : machine.beam_log().pieces()) {
        burnt += piece.x1_mm - piece.x0_mm;
    }
    EXPECT_NEAR(burnt, 100.0, 1e-6);
}

TEST(GrblMachine, LosesItsPositionOnlyWhenResetWhileMoving) {
    Machine machine;
    machine.say("G1X100F3000");
    machine.advance(1.0);
    EXPECT_THAT(machine.feed("\x18"), StartsWith("ALARM:3\r\n"));
    EXPECT_EQ(machine.state(), GrblMachine::State::Alarm);
    EXPECT_EQ(machine.say("G21"), "");  // Lost: the reset takes half a second.
    EXPECT_THAT(machine.advance(0.6), HasSubstr("unlock]"));
    EXPECT_EQ(machine.say("G0X1"), "error:9\r\n");
    EXPECT_THAT(machine.say("$X"), EndsWith("ok\r\n"));

    machine.say("G1X10F3000");
    machine.advance(0.1);
    machine.feed("!");
    machine.advance(1.0);
    EXPECT_THAT(machine.feed("\x18"), Not(HasSubstr("ALARM")));
    EXPECT_EQ(machine.state(), GrblMachine::State::Idle);
}

TEST(GrblMachine, ResetsToTheModesOfPowerUpAndForgetsG92) {
    Machine machine;
    machine.say("G91G20M4S5F100");
    machine.say("G92X5");
    machine.feed("\x18");
    EXPECT_THAT(machine.say("$G"), HasSubstr("[GC:G0 G54 G17 G21 G90 G94 M5 M9 T0 F0 S0]"));
    EXPECT_THAT(machine.say("$#"), HasSubstr("[G92:0.000,0.000,0.000]"));
}

TEST(GrblMachine, TripsTheSoftLimitAndThenServesOnlyAReset) {
    Machine machine;
    machine.settings().set(22, 1);
    machine.settings().set(20, 1);
    machine.say("$H");
    machine.advance(3.0);
    EXPECT_THAT(machine.feed("?"), HasSubstr("MPos:-1.000,-1.000"));
    std::string answer = machine.say("G0X5");
    answer += machine.advance(1.0);
    EXPECT_THAT(answer, HasSubstr("ALARM:2"));
    EXPECT_EQ(machine.feed("?"), "");
    EXPECT_EQ(machine.say("$X"), "");
    machine.feed("\x18");
    EXPECT_THAT(machine.feed("?"), StartsWith("<Alarm|MPos:-1.000,-1.000"));
    EXPECT_EQ(machine.say("$J=X5F100"), "error:8\r\n");
    machine.say("$X");
    EXPECT_EQ(machine.say("$J=G90X5F100"), "error:15\r\n");
}

TEST(GrblMachine, JogsAndCancelsAJog) {
    Machine machine;
    EXPECT_EQ(machine.say("$J=G91X100F3000"), "ok\r\n");
    EXPECT_EQ(machine.state(), GrblMachine::State::Jog);
    EXPECT_EQ(machine.say("G0X1"), "error:9\r\n");
    machine.advance(0.5);
    machine.feed("\x85");
    machine.advance(0.5);
    EXPECT_EQ(machine.state(), GrblMachine::State::Idle);
    const double stopped_at = machine.position_mm()[0];
    EXPECT_GT(stopped_at, 10.0);
    EXPECT_LT(stopped_at, 50.0);
    machine.say("G91");
    machine.say("G0X1");
    machine.settle();
    EXPECT_NEAR(machine.position_mm()[0], stopped_at + 1.0, 0.005);
}

TEST(GrblMachine, EndsAJogThatGoesNowhere) {
    Machine machine;
    machine.say("$J=G91X0F100");
    machine.settle();
    EXPECT_EQ(machine.state(), GrblMachine::State::Idle);
}

TEST(GrblMachine, ReportsBuffersOffsetsAndOverridesAsAsked) {
    Machine machine;
    EXPECT_THAT(machine.feed("?"), HasSubstr("|WCO:0.000,0.000,0.000>"));
    EXPECT_THAT(machine.feed("?"), Not(HasSubstr("WCO")));
    machine.say("G92X-5");
    EXPECT_THAT(machine.feed("?"), HasSubstr("|WCO:5.000,0.000,0.000>"));
    machine.say("$10=2");
    const std::string report = machine.feed("?");
    EXPECT_THAT(report, HasSubstr("WPos:-5.000"));
    EXPECT_THAT(report, HasSubstr("|Bf:15,128|"));
    machine.feed("\x91\x91\x9a");
    EXPECT_THAT(machine.feed("?"), HasSubstr("|Ov:120,100,110>"));
}

TEST(GrblMachine, BurnsInWorkCoordinatesOfEveryKindOfOffset) {
    Machine machine;
    machine.say("G0X10Y10");
    machine.say("G10L20P1X0Y0");
    machine.say("G92X1Y1");
    machine.say("M4S100");
    machine.say("G1X5Y5F1000");
    machine.settle();
    ASSERT_EQ(machine.beam_log().pieces().size(), 1U);
    EXPECT_NEAR(machine.beam_log().pieces()[0].x0_mm, 1.0, 1e-9);
    EXPECT_NEAR(machine.beam_log().pieces()[0].x1_mm, 5.0, 1e-9);
    EXPECT_NEAR(machine.position_mm()[0], 14.0, 1e-9);
}

TEST(GrblMachine, DrawsArcsOnTheirCircle) {
    for (const char* arc :
         {"G2X20Y10I5J0", "G3X20Y10I5J0", "G2X10Y10I5J0", "G2X20Y10R5", "G3X20Y10R-6"}) {
        Machine machine;
        machine.say("G0X10Y10");
        machine.say("M4S100F600");
        EXPECT_THAT(machine.say(arc), Not(HasSubstr("error"))) << arc;
        machine.settle();
        const double radius = std::string(arc).find("R-6") != std::string::npos ? 6.0 : 5.0;
        const double below = radius == 6.0 ? -std::sqrt(11.0) : 0.0;
        double worst = 0.0;
        for (const BurntPiece& piece : machine.beam_log().pieces()) {
            for (const double centre_y : {10.0}) {
                const double up = std::abs(
                    std::hypot(piece.x1_mm - 15.0, piece.y1_mm - centre_y - below) - radius);
                const double down = std::abs(
                    std::hypot(piece.x1_mm - 15.0, piece.y1_mm - centre_y + below) - radius);
                worst = std::max(worst, std::min(up, down));
            }
        }
        EXPECT_LT(worst, 0.006) << arc;  // Tolerance 0.002 and half a step of 0.004.
        EXPECT_GT(machine.beam_log().pieces().size(), 10U) << arc;
    }
}

TEST(GrblMachine, WaitsOutADwellBeforeItAnswers) {
    Machine machine;
    EXPECT_EQ(machine.say("G4P0.5"), "");
    EXPECT_EQ(machine.advance(0.4), "");
    EXPECT_EQ(machine.advance(0.2), "ok\r\n");
}

// Seconds from the first step to the last, with the receive buffer always full.
double job_time(GrblMachine& machine, const std::string& program) {
    std::deque<std::size_t> sent;
    std::size_t in_buffer = 0;
    double begin = -1.0;
    double end = 0.0;
    Axes before = machine.position_mm();
    const auto count = [&](const std::string& answers) {
        for (std::size_t at = 0; (at = answers.find("ok\r\n", at)) != std::string::npos; at += 4) {
            in_buffer -= sent.front();
            sent.pop_front();
        }
    };
    const auto turn = [&] {
        count(machine.advance(0.001));
        if (machine.position_mm() != before) {
            before = machine.position_mm();
            begin = begin < 0.0 ? machine.now_s() : begin;
            end = machine.now_s();
        }
    };
    std::istringstream lines(program);
    for (std::string line; std::getline(lines, line);) {
        sent.push_back(line.size() + 1);
        for (in_buffer += line.size() + 1; in_buffer > 127;) {
            turn();
        }
        count(machine.feed(line + "\n"));
    }
    while (!machine.at_rest() || !sent.empty()) {
        turn();
    }
    return end - begin;
}

// The times are those of the real Grbl 1.1h, its steps counted on a PC.
TEST(GrblMachine, TakesAsLongAsTheRealFirmwareForAJob) {
    std::string spiral = "G21G90\nM4S0\nG0X10Y10\nF3000\n";
    for (int i = 0; i < 5000; ++i) {
        const double angle = 0.05 * i;
        const double radius = 10.0 + 30.0 * i / 5000;
        spiral += fmt::format("G1X{:.3f}Y{:.3f}S500\n", 60.0 + radius * std::cos(angle),
                              60.0 + radius * std::sin(angle));
    }
    Machine first;
    EXPECT_NEAR(job_time(first, spiral + "M5S0\nG0X0Y0\n") / 127.8907, 1.0, 0.003);
    EXPECT_EQ(first.position_mm(), Axes{});

    std::string raster = "G21G90\nM4S0\nG0X0Y0\nG1F6000\n";
    for (int y = 0; y < 20; ++y) {
        for (int i = 0; i < 60; ++i) {
            const int x = y % 2 == 0 ? i : 59 - i;
            raster += fmt::format("G1X{}.0Y{:.1f}S{}\n", x, y * 0.5, (x * 37 + y * 11) % 1000);
        }
    }
    Machine second;
    EXPECT_NEAR(job_time(second, raster + "M5S0\nG0X0Y0\n") / 16.7429, 1.0, 0.005);

    std::string zigzag = "G21G90\nM4S0\nG0X10Y10\nG1F3000\n";
    for (int i = 0; i < 100; ++i) {
        zigzag += fmt::format("G1X{}Y{}S500\n", i % 2 == 0 ? 100 : 10, 10 + i);
    }
    Machine third;
    EXPECT_NEAR(job_time(third, zigzag + "M5S0\nG0X0Y0\n") / 191.7592, 1.0, 0.003);
}

TEST(GrblMachine, RunsRealProgramsWithoutAnError) {
    const std::filesystem::path samples =
        std::filesystem::path(LEAFCUTTER_SHARED_DIR) / "data" / "gcode";
    if (!std::filesystem::exists(samples)) {
        GTEST_SKIP() << "no samples beside the project";
    }
    int programs = 0;
    for (const auto& entry : std::filesystem::directory_iterator(samples)) {
        if (entry.path().extension() == ".md") {
            continue;
        }
        ++programs;
        Machine machine;
        std::ifstream file(entry.path());
        std::string line;
        std::size_t answers = 0;
        std::size_t lines = 0;
        while (std::getline(file, line)) {
            std::string answer = machine.say(line.substr(0, line.find('\r')));
            ++lines;
            for (int i = 0; i < 100000 && answer.empty(); ++i) {
                answer = machine.advance(0.1);
            }
            EXPECT_THAT(answer, Not(HasSubstr("error"))) << entry.path() << ": " << line;
            answers += answer.empty() ? 0 : 1;
        }
        EXPECT_EQ(answers, lines) << entry.path();
        EXPECT_EQ(machine.bytes_dropped(), 0U);
    }
    EXPECT_GT(programs, 3);
}

}  // namespace
}  // namespace leafcutter::drivers
