// Calls another program's address whenever a job or a cut changes its state. Every event is told in
// order and at least once: a call that fails is repeated, ever more rarely, for about a day. What
// is told twice has the same X-Leafcutter-Delivery, the number of its event.
//
// The body is JSON, leafcutter-webhook/1. The header X-Leafcutter-Signature is "sha256=" and the
// hex HMAC-SHA256, with the hook's secret, of the X-Leafcutter-Timestamp (seconds since 1970), a
// dot, and the body.

#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <stop_token>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "server/store/records.h"

namespace leafcutter::server {

class Duties;
class EventLog;
class Settings;

struct WebhookConfig {
    std::string url;     // http:// or https://
    std::string secret;  // 16 bytes and more.
    std::vector<std::string> events{"job", "cut"};
    bool allow_private = false;  // May lead to this host or its network.
};

// What is sent of an event, and its signature.
std::string webhook_body(const EventRecord& event);
std::string webhook_signature(std::string_view secret, std::int64_t unix_s, std::string_view body);

// The wait after that many failures: 1 s, doubling up to an hour.
std::chrono::seconds webhook_back_off(int failures);

class Webhook {
public:
    // Failures of one event after which it is left out, so that those after it are told: a day.
    static constexpr int kMostFailures = 35;

    // A hook that is new is told of what happens from now on.
    // In a fleet one of the nodes that have it tells it, and another one goes on where that ends.
    Webhook(WebhookConfig config, const EventLog& events, Settings& settings, Duties& duties);
    ~Webhook();
    Webhook(const Webhook&) = delete;
    Webhook& operator=(const Webhook&) = delete;

    // There may be new events. Any thread; never waits.
    void wake();

    // Since the last call that was taken.
    int failures() const { return failures_; }
    std::int64_t told() const { return told_; }
    const std::string& url() const { return config_.url; }

private:
    void loop(const std::stop_token& stop);
    bool tell_next(const std::stop_token& stop);
    bool deliver(const EventRecord& event);
    void pass(const EventRecord& event);
    std::string place_key() const;
    std::string duty() const;
    std::int64_t place() const;

    const WebhookConfig config_;
    const EventLog& events_;
    Settings& settings_;
    const Duties& duties_;
    std::atomic<std::int64_t> told_{0};
    std::atomic<int> failures_{0};

    std::mutex mutex_;  // Guards grew_.
    std::condition_variable_any arrived_;
    bool grew_ = true;

    std::jthread thread_;  // Last: it uses everything above.
};

}  // namespace leafcutter::server
