#include "server/http/connection.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <poll.h>
#include <string_view>
#include <sys/socket.h>
#include <thread>
#include <unistd.h>
#include <utility>

#include "server/http/request.h"

namespace leafcutter::server {

Connection::Connection(int fd, std::string early, const Patience& patience)
    : fd_(fd), early_(std::move(early)), patience_(patience) {}

void Connection::expect_body(std::int64_t bytes, bool wants_continue) {
    body_left_ = bytes;
    owes_continue_ = wants_continue && bytes > 0 && early_.empty();
}

std::size_t Connection::read_body(std::span<char> room) {
    if (owes_continue_) {
        owes_continue_ = false;
        constexpr std::string_view kContinue = "HTTP/1.1 100 Continue\r\n\r\n";
        if (!write_all(kContinue.data(), kContinue.size())) {
            throw RequestAborted();
        }
    }
    const auto wanted = static_cast<std::size_t>(
        std::min<std::int64_t>(body_left_, static_cast<std::int64_t>(room.size())));
    if (wanted == 0) {
        return 0;
    }
    std::size_t size = std::min(wanted, early_.size());
    if (size > 0) {
        std::memcpy(room.data(), early_.data(), size);
        early_.erase(0, size);
    } else {
        ssize_t received = -1;
        do {
            if (!wait_for(POLLIN) || is_too_slow(moved_in_)) {
                throw RequestAborted();
            }
            received = ::recv(fd_, room.data(), wanted, MSG_DONTWAIT);
        } while (received < 0 && (errno == EAGAIN || errno == EINTR));
        if (received <= 0) {
            throw RequestAborted();
        }
        size = static_cast<std::size_t>(received);
    }
    body_left_ -= static_cast<std::int64_t>(size);
    moved_in_ += static_cast<std::int64_t>(size);
    return size;
}

bool Connection::write_all(const char* data, std::size_t size) {
    while (size > 0) {
        const ssize_t sent = ::send(fd_, data, size, MSG_DONTWAIT | MSG_NOSIGNAL);
        if (sent > 0) {
            data += sent;
            size -= static_cast<std::size_t>(sent);
            moved_out_ += sent;
            continue;
        }
        const bool later = sent < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR);
        if (!later || !wait_for(POLLOUT) || is_too_slow(moved_in_ + moved_out_)) {
            return false;
        }
    }
    return true;
}

std::string Connection::take_early() {
    return std::exchange(early_, {});
}

bool Connection::wait_for(short event) const {
    pollfd poller{fd_, event, 0};
    int ready = 0;
    do {
        ready = ::poll(&poller, 1, static_cast<int>(patience_.per_step.count()));
    } while (ready < 0 && errno == EINTR);
    return ready > 0;
}

bool Connection::is_too_slow(std::int64_t moved) const {
    const auto spent = Clock::now() - since_ - patience_.per_step;
    const double seconds = std::chrono::duration<double>(spent).count();
    return seconds > 0.0 &&
           static_cast<double>(moved) < seconds * static_cast<double>(patience_.least_bytes_per_s);
}

int with_low_number(int fd, int most) {
    constexpr int kTries = 100;
    for (int tries = 0; fd > most && tries < kTries; ++tries) {
        const int other = ::fcntl(fd, F_DUPFD_CLOEXEC, 0);
        if (other >= 0) {
            ::close(std::max(fd, other));
            fd = std::min(fd, other);
        }
        if (fd > most) {
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
    }
    if (fd <= most) {
        return fd;
    }
    ::close(fd);
    return -1;
}

}  // namespace leafcutter::server
