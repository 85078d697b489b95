// A session of the line protocols against a simulated controller: no threads, no waiting, every run
// the same. And the zigzag that it burns.

#pragma once

#include <chrono>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "drivers/marlin/session.h"
#include "drivers/sim/faulty_wire.h"
#include "drivers/transport.h"

namespace leafcutter::drivers {

// A session against a simulated controller, both stepped by a clock of the test.
class LineBench {
public:
    LineBench(MarlinSession::Firmware firmware, std::unique_ptr<SimMachine> machine)
        : machine_(std::move(machine)), session_(firmware, now_) {}

    MarlinSession& session() { return session_; }
    SimMachine& line_machine() { return *machine_; }
    double now_s() const { return machine_->now_s(); }

    void step(double seconds = 0.005) {
        now_ += std::chrono::duration_cast<Session::Time::duration>(
            std::chrono::duration<double>(seconds));
        std::string answer = machine_->feed(session_.take_output());
        answer += machine_->advance(seconds);
        said += answer;
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

    const std::vector<BurntPiece>& burnt() const {
        return std::as_const(*machine_).beam_log().pieces();
    }

    double burnt_mm() const {
        double sum = 0.0;
        for (const BurntPiece& piece : burnt()) {
            sum += std::hypot(piece.x1_mm - piece.x0_mm, piece.y1_mm - piece.y0_mm);
        }
        return sum;
    }

    std::string said;  // By the machine.

private:
    Session::Time now_{std::chrono::hours(1)};
    std::unique_ptr<SimMachine> machine_;
    MarlinSession session_;
};

// With the machine in sight; the wire's fault, if any, lies between.
template <typename Machine, typename Options, MarlinSession::Firmware kFirmware>
class MachineBench : public LineBench {
public:
    explicit MachineBench(const Options& options = {}, std::optional<WireFault> fault = {})
        : MachineBench(fault, std::make_unique<Machine>(options).release()) {}

    Machine& machine() { return *bare_; }

private:
    // Takes `machine` over.
    MachineBench(const std::optional<WireFault>& fault, Machine* machine)
        : LineBench(kFirmware, behind_wire(std::unique_ptr<SimMachine>(machine), fault)),
          bare_(machine) {}

    static std::unique_ptr<SimMachine> behind_wire(std::unique_ptr<SimMachine> machine,
                                                   const std::optional<WireFault>& fault) {
        if (fault) {
            machine = std::make_unique<FaultyWire>(std::move(machine), *fault);
        }
        return machine;
    }

    Machine* bare_;
};

inline constexpr double kSide = 60.0;

inline std::string zigzag(int lines, const std::string& beam = "M4 I1 S0\n") {
    std::string text = fmt::format("; a comment\nG21\nG90\nG0 X0 Y0 S0\n{}", beam);
    for (int i = 0; i < lines; ++i) {
        text += fmt::format("G1 X{} Y{} S0.5 F6000\n", i % 2 == 0 ? kSide : 0.0, i);
    }
    return text + "M5 S0\nG0 X0 Y0 S0\n";
}

inline double zigzag_mm(int lines) {
    return kSide + (lines - 1) * std::hypot(kSide, 1.0);
}

// Nothing is burnt but along the zigzag.
inline void expect_on_zigzag(const std::vector<BurntPiece>& burnt) {
    const auto off_line = [](double x, double y) {
        const double row = std::max(std::floor(y - 1e-6), -1.0);
        const double part = y - row;
        const bool right = static_cast<long>(row + 1) % 2 == 0;  // Towards the end of this line.
        return row < 0.0 ? std::abs(y) : std::abs(x - kSide * (right ? part : 1.0 - part));
    };
    for (const BurntPiece& piece : burnt) {
        EXPECT_LT(off_line(piece.x0_mm, piece.y0_mm), 1.0) << piece.x0_mm << " " << piece.y0_mm;
        EXPECT_LT(off_line(piece.x1_mm, piece.y1_mm), 1.0) << piece.x1_mm << " " << piece.y1_mm;
        EXPECT_LT(std::abs(piece.y1_mm - piece.y0_mm), 1.01);
    }
}

// Runs until the session gives the link up. Returns for how long the machine had said nothing then.
inline double silence_until_noticed(LineBench& bench) {
    std::size_t before = 0;
    double silent_since = 0.0;
    const auto note = [&] {
        silent_since = bench.said.size() > before ? bench.now_s() : silent_since;
        before = bench.said.size();
        return bench.session().progress().outcome != JobOutcome::Running;
    };
    EXPECT_THROW(bench.run_until(note), LinkLost);
    return bench.now_s() - silent_since;
}

inline void expect_whole(LineBench& bench, int lines, const std::string& beam = "M4 I1 S0\n") {
    ASSERT_TRUE(bench.attach());
    bench.session().start(zigzag(lines, beam));
    ASSERT_TRUE(bench.finish_job());
    EXPECT_EQ(bench.session().progress().outcome, JobOutcome::Done)
        << bench.session().progress().reason;
    EXPECT_NEAR(bench.burnt_mm(), zigzag_mm(lines), 0.05);
    EXPECT_EQ(bench.line_machine().beam_power(), 0.0);
}

}  // namespace leafcutter::drivers
