#include "drivers/file_descriptor.h"

#include <array>
#include <cerrno>
#include <poll.h>
#include <sys/socket.h>
#include <system_error>
#include <unistd.h>

#include "drivers/transport.h"

namespace leafcutter::drivers {

namespace {

constexpr int kWriteTimeoutMs = 5000;

[[noreturn]] void lost(std::string_view link, std::string_view reason) {
    throw LinkLost(std::string(link) + ": " + std::string(reason));
}

// Returns the events that came, 0 after the time.
short wait_for(const FileDescriptor& file, std::string_view link, short events, int timeout_ms) {
    pollfd entry{file.get(), events, 0};
    const int ready = poll(&entry, 1, timeout_ms);
    if (ready < 0 && errno != EINTR) {
        lost(link, error_text(errno));
    }
    return ready > 0 ? entry.revents : static_cast<short>(0);
}

}  // namespace

void FileDescriptor::close() {
    if (number_ >= 0) {
        ::close(number_);
        number_ = -1;
    }
}

std::string error_text(int error_number) {
    return std::error_code(error_number, std::generic_category()).message();
}

std::string read_from(const FileDescriptor& file,
                      std::string_view link,
                      std::chrono::milliseconds timeout) {
    const short events = wait_for(file, link, POLLIN, static_cast<int>(timeout.count()));
    if (events == 0) {
        return {};
    }
    std::array<char, 4096> buffer{};
    const ssize_t count = ::read(file.get(), buffer.data(), buffer.size());
    if (count > 0) {
        return {buffer.data(), static_cast<std::size_t>(count)};
    }
    if (count == 0) {
        lost(link, "the other end has closed the link");
    }
    if (errno == EAGAIN || errno == EINTR) {
        if ((events & (POLLHUP | POLLERR | POLLNVAL)) != 0) {
            lost(link, "the other end is gone");
        }
        return {};
    }
    lost(link, error_text(errno));
}

namespace {

// A socket whose other end is gone must not kill the process with SIGPIPE.
ssize_t write_some(const FileDescriptor& file, std::string_view bytes) {
    const ssize_t sent = ::send(file.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
    return sent < 0 && errno == ENOTSOCK ? ::write(file.get(), bytes.data(), bytes.size()) : sent;
}

}  // namespace

void write_to(const FileDescriptor& file, std::string_view link, std::string_view bytes) {
    while (!bytes.empty()) {
        const ssize_t count = write_some(file, bytes);
        if (count >= 0) {
            bytes.remove_prefix(static_cast<std::size_t>(count));
            continue;
        }
        if (errno != EAGAIN && errno != EINTR) {
            lost(link, error_text(errno));
        }
        const short events = wait_for(file, link, POLLOUT, kWriteTimeoutMs);
        if (events == 0) {
            lost(link, "takes no bytes any more");
        }
        if ((events & (POLLHUP | POLLERR | POLLNVAL)) != 0) {
            lost(link, "the other end is gone");
        }
    }
}

}  // namespace leafcutter::drivers
