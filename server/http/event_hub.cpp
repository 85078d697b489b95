#include "server/http/event_hub.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <system_error>
#include <unistd.h>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

namespace leafcutter::server {

namespace {

using namespace std::chrono_literals;

constexpr auto kHeartbeat = 15s;
constexpr auto kPassingGap = 100ms;
constexpr auto kDismissalGap = 500ms;
constexpr std::size_t kSlack = 65536;

void watch(int epoll, int fd, int how, std::uint32_t events) {
    epoll_event event{};
    event.events = events;
    event.data.fd = fd;
    ::epoll_ctl(epoll, how, fd, &event);
}

std::string frame(const StoredEvent& event) {
    return fmt::format("id: {}\nevent: {}\ndata: {}\n\n", event.seq, event.type, event.data);
}

bool wants(const EventSubscription& subscription, const std::string& job) {
    return !subscription.job || *subscription.job == job;
}

}  // namespace

EventHub::EventHub(EventSource source)
    : source_(std::move(source)),
      epoll_(::epoll_create1(EPOLL_CLOEXEC)),
      wakeup_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
    if (epoll_ < 0 || wakeup_ < 0) {
        throw std::system_error(errno, std::generic_category(), "epoll");
    }
    watch(epoll_, wakeup_, EPOLL_CTL_ADD, EPOLLIN);
}

void EventHub::start() {
    told_ = source_.last_seq();
    thread_ = std::jthread([this](const std::stop_token& stop) { loop(stop); });
}

void EventHub::stop() {
    if (thread_.joinable()) {
        thread_.request_stop();
        rouse();
        thread_.join();
    }
}

EventHub::~EventHub() {
    stop();
    for (const auto& [fd, client] : clients_) {
        ::close(fd);
    }
    for (const auto& [fd, subscription] : newcomers_) {
        ::close(fd);
    }
    ::close(wakeup_);
    ::close(epoll_);
}

void EventHub::wake() {
    log_grew_ = true;
    rouse();
}

void EventHub::rouse() {
    const std::uint64_t one = 1;
    [[maybe_unused]] const ssize_t written = ::write(wakeup_, &one, sizeof one);
}

void EventHub::post(const std::string& type, const std::string& id) {
    {
        const std::scoped_lock lock(mutex_);
        passing_.emplace(type, id);
    }
    rouse();
}

void EventHub::adopt(int fd, EventSubscription subscription) {
    {
        const std::scoped_lock lock(mutex_);
        newcomers_.emplace_back(fd, std::move(subscription));
        ++client_count_;
    }
    rouse();
}

std::size_t EventHub::clients() const {
    const std::scoped_lock lock(mutex_);
    return client_count_;
}

void EventHub::loop(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
        try {
            round();
        } catch (const std::exception& error) {  // The store failed: the log is read again later.
            spdlog::error("events: {}", error.what());
        }
    }
}

void EventHub::round() {
    std::array<epoll_event, 64> events;
    constexpr int kTickMs = 100;
    const int count = ::epoll_wait(epoll_, events.data(), static_cast<int>(events.size()), kTickMs);
    for (int i = 0; i < count; ++i) {
        const epoll_event& event = events[static_cast<std::size_t>(i)];
        const int fd = event.data.fd;
        if (fd == wakeup_) {
            std::uint64_t ignored = 0;
            [[maybe_unused]] const ssize_t size = ::read(wakeup_, &ignored, sizeof ignored);
            continue;
        }
        if ((event.events & EPOLLIN) != 0) {
            std::array<char, 512> ignored;  // A stream's client has nothing more to say.
            if (::recv(fd, ignored.data(), ignored.size(), MSG_DONTWAIT) == 0) {
                drop(fd);
                continue;
            }
        }
        if ((event.events & (EPOLLHUP | EPOLLERR | EPOLLRDHUP)) != 0) {
            drop(fd);
        }
    }
    dismiss();
    tell_stored();
    welcome_new();
    tell_passing();
    beat();
    flush_all();
}

void EventHub::welcome_new() {
    std::vector<std::pair<int, EventSubscription>> newcomers;
    {
        const std::scoped_lock lock(mutex_);
        newcomers.swap(newcomers_);
    }
    for (auto next = newcomers.begin(); next != newcomers.end(); ++next) {
        Client client;
        client.subscription = next->second;
        client.most_bytes = SIZE_MAX;
        try {
            greet(client);
        } catch (...) {  // Nobody is told what is new before he was told what he missed.
            const std::scoped_lock lock(mutex_);
            newcomers_.insert(newcomers_.begin(), std::make_move_iterator(next),
                              std::make_move_iterator(newcomers.end()));
            throw;
        }
        client.most_bytes = client.out.size() + kSlack;
        watch(epoll_, next->first, EPOLL_CTL_ADD, EPOLLIN | EPOLLRDHUP);
        clients_[next->first] = std::move(client);
    }
}

// A newcomer's first words end exactly at `told_`, where the events for everybody go on.
void EventHub::greet(Client& client) {
    constexpr std::int64_t kLongestReplay = 10000;
    const std::optional<std::int64_t> seen = client.subscription.last_seen;
    append(client, "retry: 2000\n\n");
    std::vector<StoredEvent> missed;
    if (seen && *seen <= told_ && told_ - *seen <= kLongestReplay) {
        missed = source_.stored_after(*seen, static_cast<int>(told_ - *seen));
    }
    // Old events are let go from the front of the log: who missed any of those starts anew.
    const bool whole =
        seen && (*seen == told_ || (!missed.empty() && missed.front().seq == *seen + 1));
    if (!whole) {
        append(client, fmt::format("id: {}\nevent: snapshot\ndata: {}\n\n", told_,
                                   source_.snapshot(told_, client.subscription.job)));
        return;
    }
    for (const StoredEvent& event : missed) {
        if (event.seq <= told_ && wants(client.subscription, event.job)) {
            append(client, frame(event));
        }
    }
}

void EventHub::tell_stored() {
    constexpr int kAtOnce = 200;
    while (log_grew_.exchange(false)) {
        std::vector<StoredEvent> events;
        try {
            events = source_.stored_after(told_, kAtOnce);
        } catch (...) {
            log_grew_ = true;
            throw;
        }
        for (const StoredEvent& event : events) {
            const std::string text = clients_.empty() ? "" : frame(event);
            for (auto& [fd, client] : clients_) {
                if (wants(client.subscription, event.job)) {
                    append_flushing(fd, client, text);
                }
            }
            told_ = event.seq;
        }
        if (events.size() == kAtOnce) {
            log_grew_ = true;
        }
    }
}

void EventHub::tell_passing() {
    const Clock::time_point now = Clock::now();
    if (now < next_passing_) {
        return;
    }
    next_passing_ = now + kPassingGap;
    std::set<std::pair<std::string, std::string>> passing;
    {
        const std::scoped_lock lock(mutex_);
        passing.swap(passing_);
    }
    if (clients_.empty()) {
        return;
    }
    for (const auto& [type, id] : passing) {
        const std::optional<PassingEvent> event = source_.passing(type, id);
        if (!event) {
            continue;
        }
        const std::string text = fmt::format("event: {}\ndata: {}\n\n", type, event->data);
        for (auto& [fd, client] : clients_) {
            if (wants(client.subscription, event->job)) {
                append(client, text);
            }
        }
    }
}

void EventHub::beat() {
    const Clock::time_point now = Clock::now();
    for (auto& [fd, client] : clients_) {
        if (now >= client.heartbeat) {
            append(client, ": still here\n\n");
        }
    }
}

// Whose key was revoked, or whose session is over, hears nothing more.
void EventHub::dismiss() {
    const Clock::time_point now = Clock::now();
    if (now < next_dismissal_) {
        return;
    }
    next_dismissal_ = now + kDismissalGap;
    std::vector<int> dismissed;
    for (const auto& [fd, client] : clients_) {
        if (!source_.may_listen(client.subscription.caller)) {
            dismissed.push_back(fd);
        }
    }
    for (const int fd : dismissed) {
        drop(fd);
    }
}

void EventHub::append(Client& client, std::string_view text) {
    client.overrun = client.overrun || client.out.size() > client.most_bytes;
    if (!client.overrun) {
        client.out += fmt::format("{:x}\r\n{}\r\n", text.size(), text);
    }
    client.heartbeat = Clock::now() + kHeartbeat;
}

// After an outage there is more at once than a client's buffer here holds, but it may be quick.
void EventHub::append_flushing(int fd, Client& client, std::string_view text) {
    if (client.out.size() > client.most_bytes) {
        flush(fd, client);
    }
    append(client, text);
}

// False: the client is gone or too slow.
bool EventHub::flush(int fd, Client& client) {
    if (client.overrun) {
        return false;
    }
    while (!client.out.empty()) {
        const ssize_t sent =
            ::send(fd, client.out.data(), client.out.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
        if (sent <= 0) {
            const bool later = errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR;
            return later && client.out.size() <= client.most_bytes;
        }
        client.out.erase(0, static_cast<std::size_t>(sent));
    }
    client.most_bytes = kSlack;
    return true;
}

void EventHub::flush_all() {
    std::vector<int> lost;
    for (auto& [fd, client] : clients_) {
        if (!flush(fd, client)) {
            lost.push_back(fd);
        }
    }
    for (const int fd : lost) {
        drop(fd);
    }
}

void EventHub::drop(int fd) {
    if (clients_.erase(fd) == 0) {
        return;
    }
    ::epoll_ctl(epoll_, EPOLL_CTL_DEL, fd, nullptr);
    ::close(fd);
    const std::scoped_lock lock(mutex_);
    --client_count_;
}

}  // namespace leafcutter::server
