// The whole driver through a real pty and over TCP, against the simulated machine in its own
// thread.

#include <cmath>
#include <filesystem>
#include <fstream>
#include <thread>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drivers/device.h"
#include "drivers/sim/faulty_machine.h"
#include "drivers/sim/sim_host.h"
#include "drivers/transport.h"

namespace leafcutter::drivers {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;

const SimHostOptions kFast{0.0, {}};

struct Point {
    double x = 0.0;
    double y = 0.0;
};

// A spiral of `turns` in straight pieces, and the program that burns it.
std::vector<Point> spiral(int pieces) {
    std::vector<Point> points;
    for (int i = 0; i <= pieces; ++i) {
        const double angle = 0.1 * i;
        const double radius = 5.0 + 80.0 * i / pieces;
        points.push_back({150.0 + radius * std::cos(angle), 120.0 + radius * std::sin(angle)});
    }
    return points;
}

std::string program_of(const std::vector<Point>& points) {
    std::string text =
        fmt::format("; spiral\nG21\nG90\nM4 S0\nG0 X{:.3f} Y{:.3f}\n", points[0].x, points[0].y);
    for (std::size_t i = 1; i < points.size(); ++i) {
        text += fmt::format("G1 X{:.3f} Y{:.3f} F3000 S700\n", points[i].x, points[i].y);
    }
    return text + "M5 S0\nG0 X0 Y0\n";
}

struct Bench {
    explicit Bench(std::vector<Fault> faults = {}) {
        host = std::make_unique<SimHost>(
            open_pty_link(),
            std::make_unique<FaultyMachine>(GrblMachineOptions(), std::move(faults)), kFast);
        device = open_device("grbl:" + host->address());
    }

    JobOutcome run_to_end() {
        while (device->progress().outcome == JobOutcome::Running) {
            device->run_once(milliseconds(20));
        }
        return device->progress().outcome;
    }

    std::unique_ptr<SimHost> host;
    std::unique_ptr<Device> device;
};

void expect_burnt_along(const std::vector<BurntPiece>& burnt, const std::vector<Point>& points) {
    ASSERT_EQ(burnt.size(), points.size() - 1);
    double worst = 0.0;
    for (std::size_t i = 0; i < burnt.size(); ++i) {
        worst =
            std::max(worst, std::hypot(burnt[i].x0_mm - points[i].x, burnt[i].y0_mm - points[i].y));
        worst = std::max(
            worst, std::hypot(burnt[i].x1_mm - points[i + 1].x, burnt[i].y1_mm - points[i + 1].y));
    }
    EXPECT_LT(worst, 0.01);
}

TEST(GrblDevice, BurnsExactlyTheProgramThroughAPty) {
    Bench bench;
    const std::vector<Point> points = spiral(400);
    bench.device->start(program_of(points));
    EXPECT_EQ(bench.run_to_end(), JobOutcome::Done) << bench.device->progress().reason;
    EXPECT_EQ(bench.device->progress().lines_acknowledged, 406U);
    expect_burnt_along(bench.host->burnt(), points);
}

TEST(GrblDevice, BurnsExactlyTheProgramOverTcp) {
    const SimHost host(open_tcp_link(0), std::make_unique<FaultyMachine>(GrblMachineOptions()),
                       kFast);
    const auto device = open_device("grbl:" + host.address());
    const std::vector<Point> points = spiral(100);
    device->start(program_of(points));
    while (device->progress().outcome == JobOutcome::Running) {
        device->run_once(milliseconds(20));
    }
    EXPECT_EQ(device->progress().outcome, JobOutcome::Done) << device->progress().reason;
    expect_burnt_along(host.burnt(), points);
}

TEST(GrblDevice, WritesTheBeamLogOfItsOwnSimulatedMachine) {
    const auto path =
        std::filesystem::temp_directory_path() / fmt::format("leafcutter-burn-{}.jsonl", getpid());
    {
        const auto device = open_device("sim:grbl?speed=0&burn=" + path.string());
        device->start("G21\nG90\nM4 S0\nG0 X1 Y2\nG1 X11 Y2 F1000 S300\nM5\n");
        while (device->progress().outcome == JobOutcome::Running) {
            device->run_once(milliseconds(20));
        }
        EXPECT_EQ(device->progress().outcome, JobOutcome::Done);
    }
    std::ifstream file(path);
    std::string line;
    ASSERT_TRUE(std::getline(file, line));
    EXPECT_THAT(
        line,
        HasSubstr(
            R"("x0":1.0000,"y0":2.0000,"x1":11.0000,"y1":2.0000,"s":300.0000,"feed":1000.0000)"));
    EXPECT_FALSE(std::getline(file, line));
    std::filesystem::remove(path);
}

TEST(GrblDevice, FindsAnUnpluggedMachineAtOnceAndStaysDisconnected) {
    Bench bench(parse_faults("unplug:50"));
    bench.device->start(program_of(spiral(400)));
    EXPECT_THROW(bench.run_to_end(), LinkLost);
    EXPECT_EQ(bench.device->progress().outcome, JobOutcome::LinkLost);
    EXPECT_FALSE(bench.device->progress().reason.empty());
    EXPECT_EQ(bench.device->status().state, MachineState::Disconnected);
    EXPECT_NO_THROW(bench.device->run_once(milliseconds(1)));
    EXPECT_THROW(bench.device->start("G0 X1\n"), Refused);
}

TEST(GrblDevice, IsStoppedFromAnotherThreadWhileItsOwnerWorks) {
    Bench bench;
    bench.device->start(program_of(spiral(5000)));
    std::jthread stopper([&bench] {
        while (bench.device->progress().lines_acknowledged < 100) {
            std::this_thread::yield();
        }
        bench.device->stop();
    });
    EXPECT_EQ(bench.run_to_end(), JobOutcome::Aborted);
    stopper.join();
    for (int turn = 0; turn < 1000 && bench.host->beam_power() > 0.0; ++turn) {
        bench.device->run_once(milliseconds(1));
    }
    EXPECT_EQ(bench.host->beam_power(), 0.0);
    EXPECT_LT(bench.host->burnt().size(), 5000U);
}

TEST(GrblDevice, TurnsTheBeamOffWhenClosedMidJob) {
    Bench bench;
    bench.device->start(program_of(spiral(5000)));
    while (bench.device->progress().lines_acknowledged < 100) {
        bench.device->run_once(milliseconds(5));
    }
    bench.device.reset();
    EXPECT_EQ(bench.host->beam_power(), 0.0);
    EXPECT_LT(bench.host->burnt().size(), 5000U);
    // Whoever opens it next finds it idle, not in an alarm: nothing was reset while moving.
    bench.device = open_device("grbl:" + bench.host->address());
    EXPECT_EQ(bench.device->status().state, MachineState::Idle);
}

TEST(GrblDevice, IsForOneProgramAtATime) {
    const Bench bench;
    EXPECT_THROW(open_device("grbl:" + bench.host->address()), LinkLost);
}

TEST(GrblDevice, PassesOnEveryLineItHears) {
    Bench bench;
    std::vector<std::string> heard;
    bench.device->on_line = [&heard](std::string_view line) { heard.emplace_back(line); };
    bench.device->console("$G");
    while (std::find(heard.begin(), heard.end(), "ok") == heard.end()) {
        bench.device->run_once(milliseconds(5));
    }
    EXPECT_THAT(heard, testing::Contains(HasSubstr("[GC:G0 G54")));
}

// The owner of both is half destroyed by then: the daemon's heap was once written to from here.
TEST(GrblDevice, TellsNobodyAnythingWhileItIsTakenDown) {
    struct Watch final : JobWatch {
        explicit Watch(int& asked) : asked_(asked) {}
        std::size_t lines_allowed(const JobProgress&, const DeviceStatus&) override {
            ++asked_;
            return 10;
        }
        int& asked_;
    };
    Bench bench;
    int heard = 0;
    int asked = 0;
    bench.device->on_line = [&heard](std::string_view) { ++heard; };
    bench.device->watch = std::make_shared<Watch>(asked);
    bench.device->start(program_of(spiral(200)));
    while (heard == 0) {
        bench.device->run_once(milliseconds(5));
    }
    heard = 0;
    asked = 0;
    bench.device.reset();
    EXPECT_EQ(heard, 0);
    EXPECT_EQ(asked, 0);
}

TEST(OpenDevice, RefusesUrisItCannotRead) {
    for (const char* uri :
         {"", "grbl:", "usb:1", "sim:ruida", "grbl:tcp://host", "grbl:/dev/null?speed=1",
          "grbl:/dev/x?baud=fast", "sim:grbl?poll_ms=20", "sim:grbl?power_cap=0",
          "sim:grbl?power_cap=9x", "sim:marlin?s_max=0", "marlin:/dev/x?width=-1",
          "sim:grbl?colour=red", "sim:grbl?speed=-1", "sim:grblx"}) {
        EXPECT_THROW(open_device(uri), std::invalid_argument) << uri;
    }
}

TEST(OpenDevice, SaysWhatIsWrongWithAPort) {
    const auto reason = [](const std::string& uri) -> std::string {
        try {
            open_device(uri);
        } catch (const LinkLost& lost) {
            return lost.what();
        }
        return {};
    };
    EXPECT_THAT(reason("grbl:/dev/no-such-port"), HasSubstr("leafcutter devices"));
    EXPECT_THAT(reason("grbl:/dev/null"), HasSubstr("no serial port"));
    EXPECT_THAT(reason("grbl:tcp://127.0.0.1:1"), HasSubstr("tcp://127.0.0.1:1"));
}

}  // namespace
}  // namespace leafcutter::drivers
