#include <filesystem>
#include <unistd.h>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "drivers/pty.h"
#include "drivers/sim/sim_link.h"
#include "drivers/transport.h"

namespace leafcutter::drivers {
namespace {

using std::chrono::milliseconds;

std::string all_bytes() {
    std::string bytes;
    for (int byte = 0; byte < 256; ++byte) {
        bytes += static_cast<char>(byte);
    }
    return bytes;
}

std::string read_exactly(Transport& transport, std::size_t count) {
    std::string bytes;
    for (int turn = 0; turn < 1000 && bytes.size() < count; ++turn) {
        bytes += transport.read_some(milliseconds(10));
    }
    return bytes;
}

TEST(SerialPort, CarriesEveryByteUnchangedBothWays) {
    Pty pty = open_pty();
    const auto port = open_transport(pty.port_path + "?baud=250000");
    port->write_all(all_bytes());
    std::string heard;
    for (int turn = 0; turn < 1000 && heard.size() < 256; ++turn) {
        heard += read_from(pty.controller, "pty", milliseconds(10));
    }
    EXPECT_EQ(heard, all_bytes());
    write_to(pty.controller, "pty", all_bytes());
    EXPECT_EQ(read_exactly(*port, 256), all_bytes());
}

TEST(SerialPort, FindsThePlugPulled) {
    Pty pty = open_pty();
    const auto port = open_transport(pty.port_path);
    EXPECT_EQ(port->read_some(milliseconds(0)), "");
    pty.controller.close();
    pty.keeper.close();
    EXPECT_THROW(port->read_some(milliseconds(1000)), LinkLost);
    EXPECT_THROW(port->write_all("?"), LinkLost);
}

TEST(SerialPort, MayBeOpenedAgainAfterClosing) {
    const Pty pty = open_pty();
    { const auto first = open_transport(pty.port_path); }
    const auto second = open_transport(pty.port_path);
    EXPECT_THROW(open_transport(pty.port_path), LinkLost);
}

TEST(PtyLink, ReplacesAStaleSymlinkButNoFile) {
    const auto path =
        std::filesystem::temp_directory_path() / fmt::format("leafcutter-pty-{}", getpid());
    std::filesystem::create_symlink("/dev/pts/no-such", path);
    {
        const auto link = open_pty_link(path.string());
        EXPECT_EQ(link->address(), path.string());
        const auto port = open_transport(link->address());
        port->write_all("G0\n");
        EXPECT_EQ(link->receive(milliseconds(1000)), "G0\n");
    }
    EXPECT_FALSE(std::filesystem::is_symlink(path));
    fclose(fopen(path.c_str(), "w"));
    EXPECT_THROW(open_pty_link(path.string()), LinkLost);
    std::filesystem::remove(path);
}

TEST(TcpSocket, FindsTheOtherEndGone) {
    const auto link = open_tcp_link(0);
    const auto socket = open_transport(link->address());
    socket->write_all("?");
    std::string heard;
    for (int turn = 0; turn < 1000 && heard.empty(); ++turn) {
        heard = link->receive(milliseconds(10));
    }
    EXPECT_EQ(heard, "?");
    link->send("ok\r\n");
    EXPECT_EQ(read_exactly(*socket, 4), "ok\r\n");
    link->unplug();
    EXPECT_THROW(read_exactly(*socket, 1), LinkLost);
}

}  // namespace
}  // namespace leafcutter::drivers
