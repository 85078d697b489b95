// Live events to any number of clients (Server-Sent Events), all on one thread: replay of the
// stored log after what a client saw last, then what happens, then a heartbeat where nothing does.
// A client that reads too slowly is dropped; it comes back and is told what it missed.

#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <thread>
#include <unordered_map>
#include <utility>
#include <vector>

#include "server/http/response.h"

namespace leafcutter::server {

struct StoredEvent {
    std::int64_t seq = 0;
    std::string type;
    std::string job;   // The job it belongs to.
    std::string data;  // JSON.
};

struct PassingEvent {
    std::string job;  // Empty: of interest to clients of no single job.
    std::string data;
};

// Where events come from. Called by the hub's thread alone.
struct EventSource {
    std::function<std::int64_t()> last_seq;
    std::function<std::vector<StoredEvent>(std::int64_t after, int limit)> stored_after;
    std::function<std::optional<PassingEvent>(const std::string& type, const std::string& id)>
        passing;
    std::function<std::string(std::int64_t seq, const std::optional<std::string>& job)> snapshot;
    std::function<bool(const Caller& caller)> may_listen;
};

class EventHub {
public:
    static constexpr std::size_t kMostClients = 1024;

    explicit EventHub(EventSource source);
    ~EventHub();
    EventHub(const EventHub&) = delete;
    EventHub& operator=(const EventHub&) = delete;

    // From now on the source is called, until stop() returns; before and after, news just wait.
    void start();
    void stop();

    // There are new stored events. Any thread; never waits.
    void wake();

    // Something changed that is not stored; equal ones within a tick are told once.
    void post(const std::string& type, const std::string& id);

    // Takes over a connection on which the response's head was sent.
    void adopt(int fd, EventSubscription subscription);

    std::size_t clients() const;

private:
    using Clock = std::chrono::steady_clock;

    struct Client {
        EventSubscription subscription;
        std::string out;             // In chunks, not sent yet.
        std::size_t most_bytes = 0;  // Of `out`.
        bool overrun = false;        // Something was left out: it has to begin anew.
        Clock::time_point heartbeat;
    };

    void loop(const std::stop_token& stop);
    void round();
    void welcome_new();
    void greet(Client& client);
    void tell_stored();
    void tell_passing();
    void beat();
    void dismiss();
    void rouse();
    static void append(Client& client, std::string_view text);
    static void append_flushing(int fd, Client& client, std::string_view text);
    static bool flush(int fd, Client& client);
    void flush_all();
    void drop(int fd);

    const EventSource source_;
    int epoll_ = -1;
    int wakeup_ = -1;
    std::atomic<bool> log_grew_{true};

    // Of the hub's thread alone.
    std::unordered_map<int, Client> clients_;
    std::int64_t told_ = 0;  // The last event that went to every client.
    Clock::time_point next_passing_{};
    Clock::time_point next_dismissal_{};

    mutable std::mutex mutex_;  // Guards the members below.
    std::vector<std::pair<int, EventSubscription>> newcomers_;
    std::set<std::pair<std::string, std::string>> passing_;
    std::size_t client_count_ = 0;

    std::jthread thread_;  // Last: it uses everything above.
};

}  // namespace leafcutter::server
