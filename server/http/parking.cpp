#include "server/http/parking.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <system_error>
#include <unistd.h>
#include <utility>

#include "server/http/head.h"

namespace leafcutter::server {

namespace {

constexpr std::string_view kHeadEnd = "\r\n\r\n";

void add_to_epoll(int epoll, int fd) {
    epoll_event event{};
    event.events = EPOLLIN | EPOLLRDHUP;
    event.data.fd = fd;
    ::epoll_ctl(epoll, EPOLL_CTL_ADD, fd, &event);
}

enum class Received { Some, Nothing, Gone };

Received receive(int fd, std::string& bytes) {
    std::array<char, 4096> buffer;
    const ssize_t size = ::recv(fd, buffer.data(), buffer.size(), MSG_DONTWAIT);
    if (size > 0) {
        bytes.append(buffer.data(), static_cast<std::size_t>(size));
        return Received::Some;
    }
    const bool later = size < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR);
    return later ? Received::Nothing : Received::Gone;
}

}  // namespace

Parking::Parking(const ParkingLimits& limits, Ready ready, TooMuch too_much)
    : limits_(limits),
      ready_(std::move(ready)),
      too_much_(std::move(too_much)),
      epoll_(::epoll_create1(EPOLL_CLOEXEC)),
      wakeup_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
    if (epoll_ < 0 || wakeup_ < 0) {
        throw std::system_error(errno, std::generic_category(), "epoll");
    }
    add_to_epoll(epoll_, wakeup_);
    thread_ = std::jthread([this](const std::stop_token& stop) { loop(stop); });
}

Parking::~Parking() {
    thread_.request_stop();
    const std::uint64_t one = 1;
    [[maybe_unused]] const ssize_t written = ::write(wakeup_, &one, sizeof one);
    thread_.join();
    for (const auto& [fd, guest] : guests_) {
        ::close(fd);
    }
    for (const Arrival& arrival : arrivals_) {
        ::close(arrival.fd);
    }
    ::close(wakeup_);
    ::close(epoll_);
}

void Parking::park(int fd, std::string bytes) {
    const auto time = bytes.empty() ? limits_.idle_time : limits_.head_time;
    arrive(fd, {std::move(bytes), Clock::now() + time, Stay::Waiting, 0});
}

void Parking::park_for_body(int fd, std::string bytes, std::size_t wanted) {
    arrive(fd, {std::move(bytes), Clock::now() + limits_.body_time, Stay::Waiting, wanted});
}

void Parking::drain(int fd) {
    ::shutdown(fd, SHUT_WR);
    arrive(fd, {{}, Clock::now() + limits_.drain_time, Stay::Draining, 0});
}

void Parking::arrive(int fd, Guest guest) {
    {
        const std::scoped_lock lock(mutex_);
        arrivals_.push_back({fd, std::move(guest)});
    }
    const std::uint64_t one = 1;
    [[maybe_unused]] const ssize_t written = ::write(wakeup_, &one, sizeof one);
}

void Parking::loop(const std::stop_token& stop) {
    constexpr int kSweepMs = 250;
    std::array<epoll_event, 64> events;
    Clock::time_point next_sweep = Clock::now();
    while (!stop.stop_requested()) {
        const int count =
            ::epoll_wait(epoll_, events.data(), static_cast<int>(events.size()), kSweepMs);
        for (int i = 0; i < count; ++i) {
            const int fd = events[static_cast<std::size_t>(i)].data.fd;
            if (fd == wakeup_) {
                admit_arrivals();
            } else {
                serve(fd);
            }
        }
        if (Clock::now() >= next_sweep) {
            expel_late_ones();
            next_sweep = Clock::now() + std::chrono::milliseconds(kSweepMs);
        }
    }
}

void Parking::admit_arrivals() {
    std::uint64_t ignored = 0;
    [[maybe_unused]] const ssize_t size = ::read(wakeup_, &ignored, sizeof ignored);
    std::vector<Arrival> arrivals;
    {
        const std::scoped_lock lock(mutex_);
        arrivals.swap(arrivals_);
    }
    for (Arrival& arrival : arrivals) {
        if (guests_.size() >= limits_.connections) {
            send_one_away();
        }
        add_to_epoll(epoll_, arrival.fd);
        Guest& guest = guests_[arrival.fd] = std::move(arrival.guest);
        take_if_whole(arrival.fd, guest);
    }
}

void Parking::serve(int fd) {
    const auto found = guests_.find(fd);
    if (found == guests_.end()) {
        return;
    }
    Guest& guest = found->second;
    const bool first_bytes = guest.bytes.empty();
    const Received received = receive(fd, guest.bytes);
    if (received == Received::Gone) {
        leave(fd);
        ::close(fd);
        return;
    }
    if (guest.stay == Stay::Draining) {
        guest.bytes.clear();
        return;
    }
    if (first_bytes && !guest.bytes.empty()) {
        guest.leaves = Clock::now() + limits_.head_time;
    }
    take_if_whole(fd, guest);
}

void Parking::take_if_whole(int fd, Guest& guest) {
    if (guest.stay == Stay::Draining || guest.bytes.size() < guest.wanted) {
        return;
    }
    const std::size_t end = guest.bytes.find(kHeadEnd);
    const bool whole = end != std::string::npos;
    const std::size_t head_bytes = whole ? end + kHeadEnd.size() : guest.bytes.size();
    if (head_bytes > HeadRules::kMostBytes) {
        leave(fd);
        too_much_(fd, 431);
    } else if (whole) {
        std::string bytes = std::move(guest.bytes);
        leave(fd);
        ready_(fd, std::move(bytes));
    }
}

void Parking::expel_late_ones() {
    const Clock::time_point now = Clock::now();
    std::vector<int> late;
    for (const auto& [fd, guest] : guests_) {
        if (guest.leaves < now) {
            late.push_back(fd);
        }
    }
    for (const int fd : late) {
        const Guest guest = std::move(guests_.at(fd));
        leave(fd);
        if (guest.stay == Stay::Waiting && !guest.bytes.empty()) {
            too_much_(fd, 408);
        } else {
            ::close(fd);
        }
    }
}

// The one that would go next, with half a head or nothing: a crowd keeps nobody from the stop
// button.
void Parking::send_one_away() {
    const auto least = std::min_element(
        guests_.begin(), guests_.end(),
        [](const auto& a, const auto& b) { return a.second.leaves < b.second.leaves; });
    const int fd = least->first;
    leave(fd);
    ::close(fd);
}

void Parking::leave(int fd) {
    ::epoll_ctl(epoll_, EPOLL_CTL_DEL, fd, nullptr);
    guests_.erase(fd);
}

}  // namespace leafcutter::server
