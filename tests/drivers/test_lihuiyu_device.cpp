// The whole Lihuiyu driver: over an emulated USB device, a pty and TCP, and what it does when one
// of them fails.

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <thread>
#include <unistd.h>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drivers/lihuiyu/address.h"
#include "drivers/lihuiyu/ch341_transport.h"
#include "drivers/lihuiyu/egv.h"
#include "drivers/lihuiyu/session.h"
#include "drivers/session_device.h"
#include "drivers/sim/lihuiyu_transport.h"
#include "drivers/sim/sim_host.h"
#include "drivers/transport.h"

namespace leafcutter::drivers {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;
using testing::IsEmpty;

std::string squares(int count) {
    std::string text = "G21\nG90\nM4 S0\n";
    for (int i = 0; i < count; ++i) {
        const double x = 10.0 + 5.0 * (i % 40);
        const double y = 10.0 + 5.0 * static_cast<double>(i / 40);
        text += fmt::format(
            "G0 X{0} Y{1} S0\nG1 X{2} Y{1} S500 F2400\nG1 X{2} Y{3}\nG1 X{0} Y{3}\nG1 "
            "X{0} Y{1}\n",
            x, y, x + 4.0, y + 4.0);
    }
    return text + "M5 S0\nG0 X0 Y0\n";
}

bool turn_until(Device& device, const std::function<bool()>& done) {
    for (int turn = 0; turn < 20000 && !done(); ++turn) {
        device.run_once(milliseconds(5));
    }
    return done();
}

bool home(Device& device) {
    device.home();
    return turn_until(device, [&] { return device.status().state == MachineState::Idle; });
}

JobOutcome run_to_end(Device& device) {
    turn_until(device, [&] { return device.progress().outcome != JobOutcome::Running; });
    return device.progress().outcome;
}

double length_of(const std::vector<BurntPiece>& pieces) {
    double sum = 0.0;
    for (const BurntPiece& piece : pieces) {
        sum += std::hypot(piece.x1_mm - piece.x0_mm, piece.y1_mm - piece.y0_mm);
    }
    return sum;
}

SimLihuiyuOptions fast(const std::string& more = {}) {
    return parse_simulated_lihuiyu("speed=0" + more);
}

std::unique_ptr<SimHost> hosted(std::unique_ptr<SimLink> link, const SimLihuiyuOptions& options) {
    return std::make_unique<SimHost>(
        std::move(link), std::make_unique<LihuiyuMachine>(options.machine), options.host);
}

TEST(LihuiyuDevice, BurnsAJobOnItsOwnSimulatedMachineAndKeepsTheBeamLog) {
    const auto path =
        std::filesystem::temp_directory_path() / fmt::format("leafcutter-lihuiyu-{}", getpid());
    {
        const auto device = open_device("sim:lihuiyu?speed=0&burn=" + path.string());
        ASSERT_TRUE(home(*device));
        device->start("M4\nG0 X10 Y20\nG1 X35.4 Y20 S300 F1200\nM5\n");
        EXPECT_EQ(run_to_end(*device), JobOutcome::Done) << device->progress().reason;
        EXPECT_NEAR(device->status().work_position_mm[0], 35.4, 0.02);
        EXPECT_NEAR(device->status().work_position_mm[1], 20.0, 0.02);
        EXPECT_EQ(device->progress().lines_acknowledged, device->progress().lines_total);
    }
    std::ifstream file(path);
    std::string all;
    for (std::string line; std::getline(file, line);) {
        all += line + "\n";
    }
    EXPECT_THAT(all, HasSubstr(R"("x0":10.0076,"y0":20.0080)"));
    EXPECT_THAT(all, HasSubstr(R"("x1":35.4076,"y1":20.0080,"s":1.0000)"));
    std::filesystem::remove(path);
}

TEST(LihuiyuDevice, BurnsAJobOverTcpAndOverAPty) {
    for (const bool tcp : {true, false}) {
        const auto host = hosted(tcp ? open_tcp_link(0) : open_pty_link(), fast());
        const auto device = open_device("lihuiyu:" + host->address());
        ASSERT_TRUE(home(*device));
        device->start(squares(12));
        EXPECT_EQ(run_to_end(*device), JobOutcome::Done) << device->progress().reason;
        EXPECT_NEAR(length_of(host->burnt()), 12 * 16.0, 12 * 4 * 0.0254);
        EXPECT_THAT(host->take_violations(), IsEmpty());
        EXPECT_EQ(host->beam_power(), 0.0);
    }
}

TEST(LihuiyuDevice, FindsAnUnpluggedBoardAtOnceAndStaysDisconnected) {
    for (const char* address : {"usb", "tcp", "pty"}) {
        std::unique_ptr<SimHost> host;
        std::string uri = "sim:lihuiyu?speed=0&fault=unplug:20";
        if (address != std::string("usb")) {
            host = hosted(address == std::string("tcp") ? open_tcp_link(0) : open_pty_link(),
                          fast("&fault=unplug:20"));
            uri = "lihuiyu:" + host->address();
        }
        const auto device = open_device(uri);
        ASSERT_TRUE(home(*device));
        device->start(squares(20));
        EXPECT_THROW(run_to_end(*device), LinkLost) << address;
        EXPECT_EQ(device->progress().outcome, JobOutcome::LinkLost);
        EXPECT_EQ(device->status().state, MachineState::Disconnected);
        EXPECT_NO_THROW(device->run_once(milliseconds(1)));
        EXPECT_THROW(device->start(squares(1)), Refused);
        // The board goes on with what it has, and no further.
        const auto dark = [&host] { return !host || host->beam_power() == 0.0; };
        EXPECT_TRUE(turn_until(*device, dark)) << address;
    }
}

TEST(LihuiyuDevice, IsStoppedFromAnotherThreadWhileItsOwnerWorks) {
    const auto host = hosted(open_pty_link(), parse_simulated_lihuiyu("speed=20"));
    const auto device = open_device("lihuiyu:" + host->address());
    ASSERT_TRUE(home(*device));
    device->start(squares(400));
    std::jthread stopper([&device] {
        while (device->progress().lines_acknowledged < 60) {
            std::this_thread::yield();
        }
        device->stop();
    });
    EXPECT_EQ(run_to_end(*device), JobOutcome::Aborted);
    stopper.join();
    ASSERT_TRUE(turn_until(*device, [&] { return device->status().state == MachineState::Alarm; }));
    turn_until(*device, [&] { return host->beam_power() == 0.0; });
    EXPECT_EQ(host->beam_power(), 0.0);
    EXPECT_LT(length_of(host->burnt()), 400 * 16.0);
    EXPECT_THROW(device->start(squares(1)), NotHomed);
}

TEST(LihuiyuDevice, TurnsTheBeamOffWhenClosedMidJob) {
    const auto host = hosted(open_pty_link(), parse_simulated_lihuiyu("speed=20"));
    {
        const auto device = open_device("lihuiyu:" + host->address());
        ASSERT_TRUE(home(*device));
        device->start(squares(400));
        ASSERT_TRUE(
            turn_until(*device, [&] { return device->progress().lines_acknowledged > 60; }));
    }
    EXPECT_EQ(host->beam_power(), 0.0);
    const double burnt = length_of(host->burnt());
    EXPECT_GT(burnt, 0.0);
    EXPECT_LT(burnt, 400 * 16.0);
    // Whoever opens it next must home it, and can go on from there.
    const auto device = open_device("lihuiyu:" + host->address());
    EXPECT_THROW(device->start(squares(1)), NotHomed);
    ASSERT_TRUE(home(*device));
    device->start(squares(1));
    EXPECT_EQ(run_to_end(*device), JobOutcome::Done) << device->progress().reason;
    EXPECT_THAT(host->take_violations(), IsEmpty());
}

TEST(LihuiyuDevice, TakesAnEgvFile) {
    const auto path =
        std::filesystem::temp_directory_path() / fmt::format("leafcutter-egv-{}", getpid());
    const auto host = hosted(open_tcp_link(0), fast());
    const auto device = open_device("lihuiyu:" + host->address());
    ASSERT_TRUE(home(*device));
    device->start(
        "Document type : LHYMICRO-GL file\nFile version: 1.0.01\nCopyright: Unknown\n"
        "Creator-Software: another\n\n%0%0%0%0%\nIBzzzvRzzzvS1P\n"
        "ICV1752231021000191NLBS1EDz139Rz139Tz139Lz139FNSE-\n");
    EXPECT_EQ(run_to_end(*device), JobOutcome::Done) << device->progress().reason;
    const std::vector<BurntPiece> burnt = host->burnt();
    ASSERT_FALSE(burnt.empty());
    EXPECT_NEAR(length_of(burnt), 4 * 394 * 0.0254, 1e-6);
    EXPECT_NEAR(burnt.front().x0_mm, 787 * 0.0254, 1e-6);
    EXPECT_NEAR(burnt.front().y0_mm, 210.0 - 787 * 0.0254, 1e-6);
}

TEST(LihuiyuDevice, TakesTheEgvFileOfAProgramForTheProgram) {
    const EncoderOptions options;
    const std::string egv = convert_to_egv(squares(3), options);
    const std::vector<CutMove> direct = read_program_moves(squares(3), options);
    double lit = 0.0;
    CutMove before;
    for (const CutMove& move : read_program_moves(egv, options)) {
        lit += move.beam ? std::hypot(move.x_mm - before.x_mm, move.y_mm - before.y_mm) : 0.0;
        before = move;
    }
    EXPECT_NEAR(lit, 3 * 16.0, 12 * 0.0254);
    EXPECT_NEAR(before.x_mm, direct.back().x_mm, 0.0254);
    EXPECT_NEAR(before.y_mm, direct.back().y_mm, 0.0254);
    EXPECT_THROW(convert_to_egv("M4\nG1 X1000 Y0 S5 F600\n", options), ProgramRefused);
}

// A USB device that takes transfers as it is told to.
class ScriptedUsb final : public UsbPipe {
public:
    struct Log {
        std::vector<std::string> transfers;
        std::vector<std::uint16_t> controls;
        std::vector<std::size_t> taken;  // Of the next writes; then all of each.
    };
    explicit ScriptedUsb(Log& log) : log_(log) {}

    void control_out(std::uint8_t request, std::uint16_t value) override {
        log_.controls.push_back(request);
        log_.controls.push_back(value);
    }
    std::size_t bulk_write(std::string_view bytes, milliseconds /*timeout*/) override {
        std::size_t taken = bytes.size();
        if (!log_.taken.empty()) {
            taken = std::min(log_.taken.front(), taken);
            log_.taken.erase(log_.taken.begin());
        }
        if (taken > 0) {
            log_.transfers.emplace_back(bytes.substr(0, taken));
        }
        return taken;
    }
    std::string bulk_read(std::size_t /*most*/, milliseconds /*timeout*/) override {
        return std::string("\xFF\xCE\x6F\x08\x13\0", 6);
    }
    void rest(milliseconds /*time*/) override {}
    std::string description() const override { return "scripted"; }

private:
    Log& log_;
};

TEST(Ch341Transport, PutsTheChipIntoEppModeAndSplitsPackets) {
    ScriptedUsb::Log log;
    const auto transport = open_ch341(std::make_unique<ScriptedUsb>(log));
    EXPECT_EQ(log.controls, (std::vector<std::uint16_t>{0xB1, 0x0102}));
    const std::string packet = wire_bytes(make_payload("IPP"));
    transport->write_all(packet + kAskStatus);
    EXPECT_EQ(log.transfers,
              (std::vector<std::string>{packet.substr(0, 32), packet.substr(32), "\xA0"}));
    EXPECT_EQ(transport->read_some(milliseconds(1)).size(), kStatusBytes);
    EXPECT_THAT(transport->read_some(milliseconds(1)), IsEmpty());
}

TEST(Ch341Transport, SendsWhatWasNotTakenAgainAndNothingTwice) {
    ScriptedUsb::Log log;
    log.taken = {0, 0, 32, 0, 2};
    const auto transport = open_ch341(std::make_unique<ScriptedUsb>(log));
    const std::string packet = wire_bytes(make_payload("IPP"));
    transport->write_all(packet);
    EXPECT_EQ(log.transfers, (std::vector<std::string>{packet.substr(0, 32), packet.substr(32)}));
}

TEST(Ch341Transport, GivesUpATornPacket) {
    ScriptedUsb::Log log;
    log.taken = {17};
    const auto transport = open_ch341(std::make_unique<ScriptedUsb>(log));
    EXPECT_THROW(transport->write_all(wire_bytes(make_payload("IPP"))), LinkLost);
}

TEST(UsbPipe, SaysThatNoBoardIsThere) {
    try {
        open_usb_pipe(
            {.vendor = 0x1A86, .product = 0x5512, .bus = 254, .address = 254, .port = {}});
        FAIL() << "there is none at bus 254";
    } catch (const LinkLost& lost) {
        EXPECT_THAT(lost.what(), HasSubstr("usb 1a86:5512 bus 254 address 254"));
    }
}

TEST(LihuiyuAddress, ReadsPlaceBoardAndBed) {
    const LihuiyuAddress address =
        parse_lihuiyu_address("usb?bus=1&address=4&board=B2&width=400&height=300&x=5&dpi=1016");
    EXPECT_TRUE(address.link.empty());
    EXPECT_EQ(address.usb.bus, 1U);
    EXPECT_EQ(address.usb.address, 4U);
    EXPECT_EQ(address.usb.vendor, 0x1A86);
    EXPECT_EQ(address.encoder.speed.board, LihuiyuBoard::B2);
    EXPECT_EQ(to_steps(address.encoder.bed, 0.0, 0.0), (StepPlace{200, 12000}));
    EXPECT_EQ(parse_lihuiyu_address("tcp://host:1?down=50").link, "tcp://host:1");
    EXPECT_EQ(parse_lihuiyu_address("tcp://host:1?down=50&height=100").encoder.bed.origin_down_mm,
              50.0);
}

TEST(LihuiyuAddress, RefusesWhatItCannotRead) {
    for (const char* uri :
         {"lihuiyu:", "lihuiyu:serial", "lihuiyu:usb?bus=x", "lihuiyu:usb?colour=red",
          "lihuiyu:tcp://h:1?bus=1", "lihuiyu:usb?board=M9", "lihuiyu:usb?width=0",
          "lihuiyu:usb?x=-1", "sim:lihuiyu?fault=crc", "sim:lihuiyu?fault=crc:0",
          "sim:lihuiyu?speed=-1", "sim:lihuiyu?baud=9600", "sim:lihuiyux"}) {
        EXPECT_THROW(open_device(uri), std::invalid_argument) << uri;
    }
}

}  // namespace
}  // namespace leafcutter::drivers
