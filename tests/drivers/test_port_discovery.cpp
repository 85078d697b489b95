#include <cerrno>
#include <filesystem>
#include <fstream>
#include <unistd.h>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drivers/port_discovery.h"

namespace leafcutter::drivers {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

// A made-up /sys and /dev.
class PortDiscovery : public testing::Test {
protected:
    void SetUp() override {
        base_ = fs::temp_directory_path() / fmt::format("leafcutter-ports-{}", getpid());
        fs::remove_all(base_);
        fs::create_directories(base_ / "sys/class/tty");
        fs::create_directories(base_ / "sys/bus/usb/devices");
        fs::create_directories(base_ / "dev/serial/by-id");
        roots_ = {(base_ / "sys").string(), (base_ / "dev").string()};
    }
    void TearDown() override { fs::remove_all(base_); }

    void write(const fs::path& path, const std::string& text) const {
        fs::create_directories((base_ / path).parent_path());
        std::ofstream(base_ / path) << text << '\n';
    }

    void add_usb(const std::string& place,
                 const std::string& vendor,
                 const std::string& product) const {
        write("sys/devices/" + place + "/idVendor", vendor);
        write("sys/devices/" + place + "/idProduct", product);
        write("sys/devices/" + place + "/product", "USB2.0-Serial");
        write("sys/devices/" + place + "/busnum", "1");
        write("sys/devices/" + place + "/devnum", "4");
        fs::create_directory_symlink(base_ / "sys/devices" / place,
                                     base_ / "sys/bus/usb/devices" / place);
    }

    fs::path base_;
    DiscoveryRoots roots_;
};

TEST_F(PortDiscovery, DescribesAUsbSerialPort) {
    add_usb("1-2", "1a86", "7523");
    fs::create_directories(base_ / "sys/devices/1-2/1-2:1.0/ttyUSB0/tty/ttyUSB0");
    fs::create_directory_symlink(base_ / "sys/devices/1-2/1-2:1.0/ttyUSB0/tty/ttyUSB0",
                                 base_ / "sys/class/tty/ttyUSB0");
    fs::create_directory_symlink(base_ / "sys/devices/1-2/1-2:1.0/ttyUSB0",
                                 base_ / "sys/devices/1-2/1-2:1.0/ttyUSB0/tty/ttyUSB0/device");
    write("dev/ttyUSB0", "");
    fs::create_symlink("../../ttyUSB0", base_ / "dev/serial/by-id/usb-1a86_USB2.0");

    const auto ports = find_ports(roots_);
    ASSERT_EQ(ports.size(), 1U);
    EXPECT_EQ(ports[0].usb_id, "1a86:7523");
    EXPECT_EQ(ports[0].description, "USB2.0-Serial");
    EXPECT_EQ(ports[0].uri, "grbl:" + (base_ / "dev/ttyUSB0").string());
    EXPECT_THAT(ports[0].stable_path, HasSubstr("by-id/usb-1a86"));
    EXPECT_EQ(ports[0].trouble, "");
}

TEST_F(PortDiscovery, LeavesOutPortsWithoutAChip) {
    write("sys/class/tty/ttyS0/type", "0");
    fs::create_directories(base_ / "sys/class/tty/ttyS0/device");
    fs::create_directories(base_ / "sys/class/tty/tty1");
    write("sys/class/tty/ttyS1/type", "4");
    fs::create_directories(base_ / "sys/class/tty/ttyS1/device");
    write("dev/ttyS1", "");
    const auto ports = find_ports(roots_);
    ASSERT_EQ(ports.size(), 1U);
    EXPECT_EQ(ports[0].path, (base_ / "dev/ttyS1").string());
}

TEST_F(PortDiscovery, SuspectsBrlttyWhenAnAdapterHasNoPort) {
    add_usb("1-3", "1a86", "7523");
    const auto ports = find_ports(roots_);
    ASSERT_EQ(ports.size(), 1U);
    EXPECT_EQ(ports[0].uri, "");
    EXPECT_THAT(ports[0].trouble, HasSubstr("brltty"));
}

TEST_F(PortDiscovery, NamesTheProgramThatHoldsAPort) {
    write("sys/class/tty/ttyS1/type", "4");
    fs::create_directories(base_ / "sys/class/tty/ttyS1/device");
    write("dev/ttyS1", "");
    write("proc/4711/comm", "cncjs");
    fs::create_directories(base_ / "proc/4711/fd");
    fs::create_symlink(fs::canonical(base_ / "dev/ttyS1"), base_ / "proc/4711/fd/7");
    write("proc/self/comm", "not a number");
    roots_.proc = (base_ / "proc").string();
    const auto ports = find_ports(roots_);
    ASSERT_EQ(ports.size(), 1U);
    EXPECT_THAT(ports[0].trouble, HasSubstr("cncjs (process 4711)"));
}

TEST_F(PortDiscovery, KnowsALihuiyuBoardByItsId) {
    add_usb("1-4", "1a86", "5512");
    const auto ports = find_ports(roots_);
    ASSERT_EQ(ports.size(), 1U);
    EXPECT_EQ(ports[0].uri, "lihuiyu:usb?bus=1&address=4");
}

TEST(DiagnoseOpenFailure, SaysWhatToDo) {
    EXPECT_THAT(diagnose_open_failure("/dev/ttyUSB0", EACCES), HasSubstr("usermod"));
    EXPECT_THAT(diagnose_open_failure("/dev/ttyUSB0", EBUSY), HasSubstr("another program"));
    EXPECT_THAT(diagnose_open_failure("/dev/ttyUSB0", ENOENT), HasSubstr("plug"));
}

}  // namespace
}  // namespace leafcutter::drivers
