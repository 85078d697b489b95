// The real libusb against a Lihuiyu board on an emulated USB. Runs under umockdev-wrapper; skips
// everything elsewhere.

#include <atomic>
#include <cmath>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drivers/device.h"
#include "drivers/lihuiyu/address.h"
#include "drivers/lihuiyu/packet.h"
#include "drivers/port_discovery.h"
#include "drivers/transport.h"
#include "drivers/usb_pipe.h"
#include "drivers/usb_watch.h"
#include "emulated_board.h"

namespace leafcutter::drivers {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr milliseconds kTime{200};
const UsbPlace kBoard = parse_lihuiyu_address("usb").usb;

class Usb : public testing::Test {
protected:
    void SetUp() override {
        board = std::make_unique<EmulatedBoard>();
        if (umockdev_in_mock_environment() == FALSE) {
            GTEST_SKIP() << "not under umockdev-wrapper";
        }
    }

    std::unique_ptr<EmulatedBoard> board;
};

std::string reason_of(const std::function<void()>& act) {
    try {
        act();
    } catch (const LinkLost& lost) {
        return lost.what();
    }
    return "nothing was thrown";
}

template <typename Done>
bool turn_until(Device& device, const Done& done) {
    for (int turn = 0; turn < 20000 && !done(); ++turn) {
        device.run_once(milliseconds(5));
    }
    return done();
}

void expect_square_burnt(Device& device, EmulatedBoard& board) {
    device.home();
    ASSERT_TRUE(turn_until(device, [&] { return device.status().state == MachineState::Idle; }));
    device.start(
        "G21\nG90\nM4 S0\nG0 X20 Y20 S0\nG1 X40 Y20 S500 F1200\nG1 X40 Y40\nG1 X20 Y40\n"
        "G1 X20 Y20\nM5 S0\nG0 X0 Y0\n");
    ASSERT_TRUE(
        turn_until(device, [&] { return device.progress().outcome != JobOutcome::Running; }));
    EXPECT_EQ(device.progress().outcome, JobOutcome::Done) << device.progress().reason;
    double length = 0.0;
    for (const BurntPiece& piece : board.burnt()) {
        length += std::hypot(piece.x1_mm - piece.x0_mm, piece.y1_mm - piece.y0_mm);
    }
    EXPECT_NEAR(length, 80.0, 4 * 0.0254);
    EXPECT_THAT(board.violations(), IsEmpty());
}

TEST_F(Usb, BurnsAJobThroughTheRealLibusb) {
    board->plug(4);
    const auto device = open_device("lihuiyu:usb?bus=1&address=4");
    expect_square_burnt(*device, *board);
    EXPECT_EQ(board->controls, (std::vector<std::uint16_t>{0xB1, 0x0102}));
}

TEST_F(Usb, IsFoundByDiscovery) {
    board->plug(4);
    const std::vector<FoundPort> ports = find_ports();
    const auto found = std::find_if(ports.begin(), ports.end(), [](const FoundPort& port) {
        return port.usb_id == "1a86:5512";
    });
    ASSERT_NE(found, ports.end());
    EXPECT_NO_THROW(open_device(found->uri)) << found->uri;
}

TEST_F(Usb, TakesTheInterfaceFromAKernelDriverAndGivesItBack) {
    board->kernel_driver = "ch341";
    board->plug(4);
    {
        const auto pipe = open_usb_pipe(kBoard);
        EXPECT_EQ(board->detached, 1);
        EXPECT_EQ(board->given_back, 0);
    }
    EXPECT_EQ(board->given_back, 1);
}

TEST_F(Usb, SaysThatAnotherProgramHasIt) {
    board->busy = true;
    board->plug(4);
    EXPECT_THAT(reason_of([] { open_usb_pipe(kBoard); }), HasSubstr("another program has it open"));
}

TEST_F(Usb, FindsABoardByItsSocketAndSaysWhereItIs) {
    board->plug(9);
    EXPECT_THAT(reason_of([] { open_device("lihuiyu:usb?bus=1&address=4"); }),
                HasSubstr("but at port=1-2"));
    EXPECT_NO_THROW(open_device("lihuiyu:usb?port=1-2"));
    EXPECT_THAT(reason_of([] { open_device("lihuiyu:usb?port=1-3"); }), HasSubstr("1-2"));
}

TEST_F(Usb, EndsATransferAtItsTime) {
    board->takes_bytes = false;
    board->plug(4);
    const auto pipe = open_usb_pipe(kBoard);
    EXPECT_EQ(pipe->bulk_write("\xA0", milliseconds(20)), 0U);
    EXPECT_THAT(pipe->bulk_read(32, milliseconds(20)), IsEmpty());
    board->takes_bytes = true;
    EXPECT_EQ(pipe->bulk_write("\xA0", kTime), 1U);
    EXPECT_EQ(pipe->bulk_read(32, kTime).size(), kStatusBytes);
}

TEST_F(Usb, GoesOnAfterAStall) {
    board->stalls_once = true;
    board->plug(4);
    const auto pipe = open_usb_pipe(kBoard);
    EXPECT_EQ(pipe->bulk_write("\xA0", kTime), 0U);
    EXPECT_EQ(board->halts_cleared, 1);
    EXPECT_EQ(pipe->bulk_write("\xA0", kTime), 1U);
}

TEST_F(Usb, NoticesUnpluggingWhileItRests) {
    board->plug(4);
    const auto pipe = open_usb_pipe(kBoard);
    std::jthread puller([this] { board->unplug(); });
    const auto begun = std::chrono::steady_clock::now();
    EXPECT_THAT(reason_of([&] { pipe->rest(milliseconds(60000)); }), HasSubstr("unplugged"));
    EXPECT_LT(std::chrono::steady_clock::now() - begun, milliseconds(30000));
    EXPECT_THAT(reason_of([&] { pipe->bulk_write("\xA0", kTime); }), HasSubstr("unplugged"));
}

TEST_F(Usb, NoticesUnpluggingInTheMiddleOfATransfer) {
    board->plug(4);
    const auto pipe = open_usb_pipe(kBoard);
    std::jthread puller([this] { board->unplug(); });
    EXPECT_THAT(reason_of([&] {
                    for (;;) {
                        pipe->bulk_read(32, milliseconds(60000));
                    }
                }),
                HasSubstr("unplugged"));
}

TEST_F(Usb, EndsTheJobOfABoardThatIsUnpluggedAndTakesItUpAgainWhenItIsBack) {
    board->plug(4);
    auto device = open_device("lihuiyu:usb?port=1-2");
    device->home();
    ASSERT_TRUE(turn_until(*device, [&] { return device->status().state == MachineState::Idle; }));
    std::string program = "G21\nG90\nM4 S0\nG0 X20 Y20 S0\n";
    for (int i = 0; i < 400; ++i) {
        program += i % 2 == 0 ? "G1 X120 Y20 S500 F600\n" : "G1 X20 Y20\n";
    }
    device->start(program + "M5 S0\n");
    ASSERT_TRUE(turn_until(*device, [&] { return device->progress().lines_acknowledged > 5; }));
    board->unplug();
    EXPECT_THAT(reason_of([&] { turn_until(*device, [] { return false; }); }),
                HasSubstr("unplugged"));
    EXPECT_EQ(device->progress().outcome, JobOutcome::LinkLost);
    EXPECT_EQ(device->status().state, MachineState::Disconnected);
    device.reset();
    board->plug(5);
    device = open_device("lihuiyu:usb?port=1-2");
    EXPECT_THROW(device->start("G21\nG90\nM4\nG1 X5 S5 F600\n"), NotHomed);
}

TEST_F(Usb, TellsOfABoardThatIsPluggedIn) {
    std::atomic<int> arrivals{0};
    const auto watch = watch_usb(kLihuiyuVendor, kLihuiyuProduct, [&] {
        ++arrivals;
        arrivals.notify_all();
    });
    ASSERT_NE(watch, nullptr);
    board->plug(4);
    arrivals.wait(0);
    EXPECT_EQ(arrivals.load(), 1);
    EXPECT_NO_THROW(open_usb_pipe(kBoard));
    board->unplug();
    board->plug(5);
    arrivals.wait(1);
    EXPECT_EQ(arrivals.load(), 2);
}

}  // namespace
}  // namespace leafcutter::drivers
