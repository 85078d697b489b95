// How well the driver uses a serial line of 115,200 baud, in simulated time.

#include <array>
#include <deque>
#include <malloc.h>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "drivers/grbl/session.h"
#include "drivers/sim/grbl_machine.h"

namespace leafcutter::drivers {
namespace {

constexpr double kBytesPerSecond = 11520.0;

// One direction of the wire: bytes take their time and arrive in order.
class Wire {
public:
    void put(const std::string& bytes) {
        waiting_.insert(waiting_.end(), bytes.begin(), bytes.end());
    }

    std::string carry(double seconds) {
        credit_ = waiting_.empty() ? 0.0 : credit_ + seconds * kBytesPerSecond;
        std::string arrived;
        for (; credit_ >= 1.0 && !waiting_.empty(); credit_ -= 1.0) {
            arrived += waiting_.front();
            waiting_.pop_front();
        }
        carried_ += arrived.size();
        return arrived;
    }

    std::size_t carried() const { return carried_; }

private:
    std::deque<char> waiting_;
    double credit_ = 0.0;
    std::size_t carried_ = 0;
};

struct WiredBench {
    using Time = GrblSession::Time;

    void step() {
        constexpr double kStep = 0.0005;
        now += std::chrono::microseconds(500);
        out.put(session.take_output());
        std::string answer = machine.feed(out.carry(kStep));
        answer += machine.advance(kStep);
        back.put(answer);
        session.receive(back.carry(kStep), now);
        session.tick(now);
        session.take_lines();
    }

    bool runs() const { return session.progress().outcome == JobOutcome::Running; }

    Time now{std::chrono::hours(1)};
    GrblMachine machine;
    GrblSession session{now};
    Wire out;
    Wire back;
};

TEST(GrblThroughput, UsesTheWholeLinkWhenTheLinkIsTheLimit) {
    WiredBench bench;
    while (!bench.session.attached()) {
        bench.step();
    }
    // Pieces far shorter than the machine runs in the time their lines take to arrive.
    std::string program = "G21\nG90\nM4 S0\nG1 F6000\n";
    for (int i = 0; i < 4000; ++i) {
        program += fmt::format("G1X{:.3f}Y10.000S{}\n", 10.0 + 0.02 * i, 100 + i % 900);
    }
    bench.session.start(program + "M5 S0\n");
    while (bench.session.progress().lines_acknowledged < 200) {
        bench.step();
    }
    const double begin_s = bench.machine.now_s();
    const std::size_t before = bench.out.carried();
    while (bench.session.progress().lines_acknowledged < 3800) {
        bench.step();
    }
    const double seconds = bench.machine.now_s() - begin_s;
    const double used =
        static_cast<double>(bench.out.carried() - before) / (seconds * kBytesPerSecond);
    EXPECT_GE(used, 0.97);
    EXPECT_EQ(bench.machine.bytes_dropped(), 0U);
    while (bench.runs()) {
        bench.step();
    }
    EXPECT_EQ(bench.session.progress().outcome, JobOutcome::Done);
}

TEST(GrblThroughput, NeverStarvesThePlannerWhereTheLinkIsFastEnough) {
    WiredBench bench;
    bench.machine.settings().set(10, 3);
    while (!bench.session.attached()) {
        bench.step();
    }
    // A straight line in pieces of 1 mm at 50 mm/s: 20 ms each, their lines take 2 ms.
    std::string program = "G21\nG90\nM4 S0\nG1 F3000\n";
    for (int i = 1; i <= 400; ++i) {
        program += fmt::format("G1X{}.000Y0.000S500\n", i);
    }
    bench.session.start(program + "M5 S0\n");
    double slowest = 1e9;
    while (bench.runs()) {
        bench.step();
        const double x = bench.machine.position_mm()[0];
        if (x > 20.0 && x < 380.0) {
            const std::string report = bench.machine.feed("?");
            const std::size_t at = report.find("|FS:");
            slowest = std::min(slowest, std::stod(report.substr(at + 4)));
        }
    }
    EXPECT_NEAR(slowest, 3000.0, 1.0);
}

// Bytes in use by everything in this process; 0 where a sanitizer keeps them.
std::size_t bytes_in_use() {
    return mallinfo2().uordblks;
}

// What a job keeps it has at its beginning: nothing grows with the lines that were sent, neither in
// the session nor in a simulated machine whose log is taken away.
TEST(GrblSession, NeedsNoMoreMemoryTheLongerAJobLasts) {
    constexpr int kLines = 200000;
    std::string program = "G21\nG90\nM4 S0\nG0 X10 Y10\n";
    for (int i = 0; i < kLines; ++i) {
        program += fmt::format("G1 X{:.2f} Y{:.2f} F6000 S500\n", 10.0 + 0.5 * (i % 150),
                               10.0 + 0.5 * ((i / 150) % 600));
    }
    program += "M5 S0\n";
    Session::Time now{std::chrono::hours(1)};
    GrblMachine machine;
    GrblSession session(now);
    const auto step = [&] {
        constexpr double kTurn = 0.02;
        now += std::chrono::milliseconds(20);
        std::string said = machine.feed(session.take_output());
        said += machine.advance(kTurn);
        session.receive(said, now);
        session.tick(now);
        session.take_lines();
        machine.beam_log().forget();
    };
    for (int i = 0; i < 1000 && !session.attached(); ++i) {
        step();
    }
    session.start(program);
    std::array<std::size_t, 11> used{};  // When so many tenths are done.
    while (session.progress().outcome == JobOutcome::Running) {
        step();
        const JobProgress& progress = session.progress();
        std::size_t& tenth = used.at(10 * progress.lines_acknowledged / progress.lines_total);
        tenth = std::max(tenth, bytes_in_use());
    }
    EXPECT_EQ(session.progress().outcome, JobOutcome::Done) << session.progress().reason;
    EXPECT_EQ(session.progress().lines_acknowledged, session.progress().lines_total);
    for (std::size_t tenth = 2; tenth < used.size(); ++tenth) {
        EXPECT_LE(used.at(tenth), used.at(1)) << tenth;
    }
    fmt::print("in use: {} kB after a tenth, {} kB at the end\n", used[1] / 1024, used[10] / 1024);
}

}  // namespace
}  // namespace leafcutter::drivers
