#include "drivers/tcp_socket.h"

#include <cerrno>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <utility>

#include "drivers/file_descriptor.h"

namespace leafcutter::drivers {

namespace {

constexpr int kConnectTimeoutMs = 5000;
// A peer that is switched off is gone after about 5 s, whether we write to it or not.
constexpr int kKeepAliveSeconds = 2;
constexpr int kKeepAliveTries = 3;
constexpr int kUnansweredMs = 5000;

class TcpSocket final : public Transport {
public:
    TcpSocket(FileDescriptor file, std::string name)
        : file_(std::move(file)), name_(std::move(name)) {}

    std::string read_some(std::chrono::milliseconds timeout) override {
        return read_from(file_, name_, timeout);
    }
    void write_all(std::string_view bytes) override { write_to(file_, name_, bytes); }
    std::string description() const override { return name_; }

private:
    FileDescriptor file_;
    std::string name_;
};

// Returns 0, or the errno of the failure.
int connect_within(const FileDescriptor& file, const addrinfo& address) {
    if (connect(file.get(), address.ai_addr, address.ai_addrlen) == 0) {
        return 0;
    }
    if (errno != EINPROGRESS) {
        return errno;
    }
    pollfd entry{file.get(), POLLOUT, 0};
    if (poll(&entry, 1, kConnectTimeoutMs) <= 0) {
        return ETIMEDOUT;
    }
    int error = 0;
    socklen_t size = sizeof error;
    getsockopt(file.get(), SOL_SOCKET, SO_ERROR, &error, &size);
    return error;
}

void set_option(const FileDescriptor& file, int level, int name, int value) {
    setsockopt(file.get(), level, name, &value, sizeof value);
}

}  // namespace

std::unique_ptr<Transport> open_tcp_socket(const std::string& host, const std::string& port) {
    const std::string name = "tcp://" + host + ":" + port;
    addrinfo wanted{};
    wanted.ai_socktype = SOCK_STREAM;
    addrinfo* found = nullptr;
    if (const int fault = getaddrinfo(host.c_str(), port.c_str(), &wanted, &found); fault != 0) {
        throw LinkLost(name + ": " + gai_strerror(fault));
    }
    const std::unique_ptr<addrinfo, decltype(&freeaddrinfo)> addresses(found, &freeaddrinfo);
    int error = EHOSTUNREACH;
    for (const addrinfo* address = found; address != nullptr; address = address->ai_next) {
        FileDescriptor file(socket(address->ai_family,
                                   address->ai_socktype | SOCK_NONBLOCK | SOCK_CLOEXEC,
                                   address->ai_protocol));
        if (!file.is_open()) {
            continue;
        }
        error = connect_within(file, *address);
        if (error == 0) {
            // A single real-time byte must not wait for company; a dead peer is to be noticed.
            set_option(file, IPPROTO_TCP, TCP_NODELAY, 1);
            set_option(file, SOL_SOCKET, SO_KEEPALIVE, 1);
            set_option(file, IPPROTO_TCP, TCP_KEEPIDLE, kKeepAliveSeconds);
            set_option(file, IPPROTO_TCP, TCP_KEEPINTVL, 1);
            set_option(file, IPPROTO_TCP, TCP_KEEPCNT, kKeepAliveTries);
            set_option(file, IPPROTO_TCP, TCP_USER_TIMEOUT, kUnansweredMs);
            return std::make_unique<TcpSocket>(std::move(file), name);
        }
    }
    throw LinkLost(name + ": " + error_text(error));
}

}  // namespace leafcutter::drivers
