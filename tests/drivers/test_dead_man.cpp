// Whatever the moment at which the host dies: of every program we export, every beginning, down to
// the byte, leaves a controller that does what it was sent and then stands dark.

#include <functional>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "drivers/burn/remainder.h"
#include "drivers/sim/marlin_machine.h"
#include "drivers/sim/smoothie_machine.h"
#include "server/queue/frame_program.h"
#include "tests/drivers/burn_check.h"
#include "tests/drivers/stepped_machine.h"
#include "tests/support/woven_program.h"

namespace leafcutter::drivers {
namespace {

// What a machine is asked to be.
template <typename Machine>
concept Simulated = requires(Machine machine) {
    machine.feed("");
    machine.advance(0.1);
    machine.at_rest();
    machine.beam_power();
    machine.beam_log();
};

// The host is gone: the machine does what it has. Returns what is wrong with how it ends.
template <Simulated Machine>
std::string orphaned(Machine machine) {
    constexpr double kTurn = 0.05;
    constexpr double kLongest = 600.0;
    double seconds = 0.0;
    while (!machine.at_rest() && seconds < kLongest) {
        machine.advance(kTurn);
        seconds += kTurn;
    }
    machine.advance(1.0);
    if (machine.beam_power() != 0.0) {
        return fmt::format("the beam stays lit with {}", machine.beam_power());
    }
    if (!machine.at_rest()) {
        return "it never stands";
    }
    for (const BurntPiece& piece : std::as_const(machine).beam_log().pieces()) {
        if (length_of(piece) == 0.0 && piece.t1_s - piece.t0_s > 0.1) {
            return fmt::format("the beam stood lit for {:.1f} s", piece.t1_s - piece.t0_s);
        }
    }
    return {};
}

// Feeds what a session writes, and lets the host die behind every byte, or every so many.
template <Simulated Machine>
void expect_dark_at_every_beginning(const std::string& wire, std::size_t every_byte_of) {
    Machine machine;
    std::size_t at = 0;
    std::string said = machine.feed("");
    std::size_t lines_open = 0;
    for (const char byte : wire) {
        // A line at a time is enough of flow control: what waits in a buffer is no worse than what
        // is still on the wire.
        said += machine.feed(std::string(1, byte));
        lines_open += byte == '\n' ? 1 : 0;
        if (byte == '\n' || at < every_byte_of) {
            ASSERT_EQ(orphaned(machine), "") << "behind byte " << at;
        }
        ++at;
        while (byte == '\n' && lines_open > 3) {
            said += machine.advance(0.01);
            for (std::size_t ok = said.find("ok"); ok != std::string::npos; ok = said.find("ok")) {
                said.erase(0, ok + 2);
                lines_open -= lines_open > 0 ? 1 : 0;
            }
        }
    }
}

std::string lines_of(const std::string& program) {
    std::string wire;
    for (const ProgramLine& line : read_program(program).lines) {
        wire += line.text + '\n';
    }
    return wire;
}

constexpr std::size_t kAllBytes = std::size_t{1} << 40U;
constexpr std::size_t kSomeBytes = 100000;

std::vector<std::string> programs(fab::Dialect dialect) {
    const std::string job = test::woven_program(dialect);
    const BeamPath path(job);
    std::vector<std::string> all{job, server::frame_program(job)};
    for (const double part : {0.1, 0.53, 0.9}) {
        all.push_back(remainder_program(job, part * path.burn_mm()));
    }
    return all;
}

TEST(DeadMan, LeavesGrblDarkAfterEveryLineAndByte) {
    // The frame that the session puts around every program.
    const std::string before = "G17G21G40G90G94\nM5S0\n";
    for (const std::string& program : programs(fab::Dialect::Grbl)) {
        expect_dark_at_every_beginning<GrblMachine>(before + lines_of(program) + "G4P0.01\n",
                                                    program.size() < 1500 ? kAllBytes : kSomeBytes);
    }
}

template <Simulated Machine>
void expect_dark_without_its_host(fab::Dialect dialect) {
    for (const std::string& program : programs(dialect)) {
        const std::size_t bytes = program.size() < 1500 ? kAllBytes : kSomeBytes;
        const std::string wire = "G21\nG90\n" + lines_of(program) + "M400\n";
        expect_dark_at_every_beginning<Machine>(wire, bytes);
    }
}

TEST(DeadMan, LeavesMarlinDarkAfterEveryLineAndByte) {
    expect_dark_without_its_host<MarlinMachine>(fab::Dialect::Marlin);
}

TEST(DeadMan, LeavesSmoothiewareDarkAfterEveryLineAndByte) {
    expect_dark_without_its_host<SmoothieMachine>(fab::Dialect::Smoothie);
}

// What the check is worth: it finds the programs that we don't write.
TEST(DeadMan, FindsAProgramThatWouldLeaveABeamLit) {
    GrblMachine constant;
    constant.feed("G21\nG90\nM3S500\nG1X10F600\n");
    EXPECT_NE(orphaned(constant), "");
    GrblMachine without_laser_mode;
    without_laser_mode.feed("$32=0\n");
    without_laser_mode.advance(1.0);
    without_laser_mode.feed("G21\nG90\nM4S500\nG1X10F600\n");
    EXPECT_NE(orphaned(without_laser_mode), "");
}

}  // namespace
}  // namespace leafcutter::drivers
