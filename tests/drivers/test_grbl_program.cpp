#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drivers/grbl/program.h"

namespace leafcutter::drivers {
namespace {

using testing::HasSubstr;

MachineFacts laser() {
    MachineFacts facts;
    facts.laser_mode = true;
    facts.s_max = 1000.0;
    facts.travel_mm = {600.0, 400.0};
    return facts;
}

std::string refusal(std::string_view text, const MachineFacts& machine = laser()) {
    try {
        preflight(read_program(text), machine);
    } catch (const Refused& error) {
        return error.what();
    }
    return {};
}

TEST(Program, StripsCommentsAndBlanksAndKeepsTheFilesLineNumbers) {
    const Program program = read_program("; what! is this?\n\nG21 (mm)\r\n%\ng1 x1.5 f100 ; go\n");
    ASSERT_EQ(program.lines.size(), 2U);
    EXPECT_EQ(program.lines[0].text, "G21");
    EXPECT_EQ(program.lines[0].number, 3U);
    EXPECT_EQ(program.lines[1].text, "G1X1.5F100");
    EXPECT_EQ(program.lines[1].number, 5U);
}

TEST(Program, LetsNoRealTimeByteThrough) {
    EXPECT_THAT(refusal("G21\nG1 X1 ! F100\n"), HasSubstr("line 2"));
    EXPECT_THAT(refusal("G21\nG0 X1?\n"), HasSubstr("line 2"));
    EXPECT_THAT(refusal("~\n"), HasSubstr("line 1"));
    EXPECT_THAT(refusal("G0 X1 \x84\n"), HasSubstr("line 1"));
}

TEST(Program, RefusesSystemCommandsLongLinesAndNonsense) {
    EXPECT_THAT(refusal("$32=0\n"), HasSubstr("console"));
    EXPECT_THAT(refusal("G1 X" + std::string(80, '1')), HasSubstr("79"));
    EXPECT_THAT(refusal("hello\n"), HasSubstr("line 1"));
    EXPECT_THAT(refusal("; nothing\n"), HasSubstr("empty"));
}

TEST(Program, MarksEepromLinesAndDwell) {
    const Program program = read_program("G10 L20 P1 X0\nG54\nG4 P1.5\nG1 X1 F10\nG28.1\n");
    EXPECT_TRUE(program.lines[0].alone);
    EXPECT_TRUE(program.lines[1].alone);
    EXPECT_EQ(program.lines[2].dwell_s, 1.5);
    EXPECT_FALSE(program.lines[3].alone);
    EXPECT_TRUE(program.lines[4].alone);
}

TEST(Preflight, AcceptsALaserProgram) {
    EXPECT_EQ(
        refusal(
            "G21\nG90\nM4 S0\nG0 X10 Y10\nG1 X20 F1000 S500\nG2 X30 Y10 I5 J0\nM5 S0\nG0 X0 Y0\n"),
        "");
}

TEST(Preflight, RefusesWhatTheMachineIsNotSetUpFor) {
    MachineFacts facts = laser();
    facts.laser_mode = false;
    EXPECT_THAT(refusal("G0 X1\n", facts), HasSubstr("$32=1"));
    facts = laser();
    facts.reports_inches = true;
    EXPECT_THAT(refusal("G0 X1\n", facts), HasSubstr("$13=0"));
}

TEST(Preflight, NamesTheLineThatIsAtFault) {
    EXPECT_THAT(refusal("G21\nG20\n"), HasSubstr("line 2"));
    EXPECT_THAT(refusal("G21\nG1 X1 F100 S1001\n"), HasSubstr("$30"));
    EXPECT_THAT(refusal("G21\nG1 X1\n"), HasSubstr("feed"));
    EXPECT_THAT(refusal("G21\nG38.2 X1\n"), HasSubstr("G38.2"));
    EXPECT_THAT(refusal("M6\n"), HasSubstr("M6"));
    EXPECT_THAT(refusal("G0 A1\n"), HasSubstr("word A"));
}

TEST(Preflight, RefusesCodesBeyondAnInt) {
    EXPECT_THAT(refusal("G25555555555555555555550 G91\n"), HasSubstr("not allowed"));
    EXPECT_THAT(refusal("M5555555555555555555550\n"), HasSubstr("not allowed"));
}

TEST(Preflight, TakesM4AloneAndNoMoreThanTheCappedPower) {
    EXPECT_THAT(refusal("G21\nM3 S100\nG1 X1 F100\nM5\n"), HasSubstr("line 2 (M3S100): M3"));
    MachineFacts facts = laser();
    facts.power_cap_percent = 60.0;
    EXPECT_EQ(refusal("M4 S600\nG1 X1 F100\nM5\n", facts), "");
    EXPECT_THAT(refusal("M4 S601\nG1 X1 F100\nM5\n", facts), HasSubstr("power_cap"));
}

TEST(Preflight, KnowsHowEachFamilyLightsItsBeam) {
    MachineFacts marlin = laser();
    marlin.laser_mode = false;  // It has no such setting.
    marlin.beam = BeamCommand::InlineM4;
    EXPECT_EQ(refusal("M4 I1\nG1 X1 F100 S9\nM400\nM5\n", marlin), "");
    EXPECT_THAT(refusal("M4\nG1 X1 F100 S9\nM5\n", marlin), HasSubstr("without I"));
    EXPECT_THAT(refusal("M3 I1\nG1 X1 F100 S9\nM5\n", marlin), HasSubstr("write M4 I"));
    MachineFacts smoothie = marlin;
    smoothie.beam = BeamCommand::None;
    smoothie.s_max = 1.0;
    EXPECT_EQ(refusal("G1 X1 F100 S0.5\n", smoothie), "");
    EXPECT_EQ(refusal("M3\nG4 S2\nG1 X1 F100 S1\n", smoothie), "");
    EXPECT_THAT(refusal("G1 X1 F100 S1.1\n", smoothie), HasSubstr("s_max=1"));
    EXPECT_THAT(refusal("M400\n"), HasSubstr("M400"));
}

TEST(Preflight, RefusesAProgramThatLeavesTheBeamOn) {
    EXPECT_THAT(refusal("M4 S500\nG1 X1 F100\n"), HasSubstr("M5"));
    EXPECT_EQ(refusal("M4 S500\nG1 X1 F100\nM30\n"), "");
}

TEST(Preflight, HoldsTheBoundsAgainstTheTravel) {
    EXPECT_THAT(refusal("G0 X0\nG0 X700\n"), HasSubstr("600"));
    EXPECT_EQ(refusal("G0 X-100\nG0 X500\n"), "");  // Without homing only the length is known.

    MachineFacts homed = laser();
    homed.origin_in_travel_mm = {10.0, 10.0};
    EXPECT_EQ(refusal("G0 X-10 Y-10\nG0 X590 Y390\n", homed), "");
    EXPECT_THAT(refusal("G0 X-11 Y0\n", homed), HasSubstr("origin"));
    // The arc bulges to Y -15 though its ends lie at 0.
    EXPECT_THAT(refusal("G0 X0 Y0\nG3 X30 Y0 I15 J0 F100\n", homed), HasSubstr("origin"));
    EXPECT_EQ(refusal("G0 X0 Y0\nG2 X30 Y0 I15 J0 F100\n", homed), "");
}

}  // namespace
}  // namespace leafcutter::drivers
