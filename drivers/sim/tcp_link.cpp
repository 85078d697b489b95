#include <arpa/inet.h>
#include <cerrno>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <thread>

#include "drivers/file_descriptor.h"
#include "drivers/sim/sim_link.h"
#include "drivers/transport.h"

namespace leafcutter::drivers {

namespace {

class TcpLink final : public SimLink {
public:
    explicit TcpLink(unsigned short port)
        : listener_(socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)) {
        sockaddr_in place{};
        place.sin_family = AF_INET;
        place.sin_port = htons(port);
        place.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        const int yes = 1;
        setsockopt(listener_.get(), SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
        socklen_t size = sizeof place;
        auto* const address = reinterpret_cast<sockaddr*>(&place);
        if (!listener_.is_open() || bind(listener_.get(), address, size) != 0 ||
            listen(listener_.get(), 1) != 0 || getsockname(listener_.get(), address, &size) != 0) {
            throw LinkLost("127.0.0.1:" + std::to_string(port) + ": " + error_text(errno));
        }
        address_ = "tcp://127.0.0.1:" + std::to_string(ntohs(place.sin_port));
    }

    std::string receive(std::chrono::milliseconds timeout) override {
        if (!client_.is_open()) {
            accept_within(timeout);
            return {};
        }
        try {
            return read_from(client_, address_, timeout);
        } catch (const LinkLost&) {
            client_.close();
            return {};
        }
    }

    void send(std::string_view bytes) override {
        if (client_.is_open() && !bytes.empty()) {
            ::send(client_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
        }
    }

    void unplug() override {
        client_.close();
        listener_.close();
    }

    std::string address() const override { return address_; }

private:
    void accept_within(std::chrono::milliseconds timeout) {
        if (!listener_.is_open()) {
            std::this_thread::sleep_for(timeout);
            return;
        }
        pollfd entry{listener_.get(), POLLIN, 0};
        if (poll(&entry, 1, static_cast<int>(timeout.count())) <= 0) {
            return;
        }
        client_ = FileDescriptor(
            accept4(listener_.get(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
        const int yes = 1;
        setsockopt(client_.get(), IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
    }

    FileDescriptor listener_;
    FileDescriptor client_;
    std::string address_;
};

}  // namespace

std::unique_ptr<SimLink> open_tcp_link(unsigned short port) {
    return std::make_unique<TcpLink>(port);
}

}  // namespace leafcutter::drivers
