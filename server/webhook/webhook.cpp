#include "server/webhook/webhook.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <spdlog/spdlog.h>

#include "server/auth/secrets.h"
#include "server/fleet/duties.h"
#include "server/store/event_log.h"
#include "server/store/ids.h"
#include "server/store/settings.h"
#include "server/webhook/post.h"

namespace leafcutter::server {

using namespace std::chrono_literals;

namespace {

constexpr auto kLookAgain = 10s;  // Besides every wake(): a place may be lost to another node.

}  // namespace

std::string webhook_body(const EventRecord& event) {
    const nlohmann::ordered_json body = {{"format", "leafcutter-webhook/1"},
                                         {"seq", event.seq},
                                         {"at", rfc3339(event.at_ms)},
                                         {"type", event.type},
                                         {"id", event.subject},
                                         {"job", event.job},
                                         {"change", event.note}};
    return body.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

std::string webhook_signature(std::string_view secret, std::int64_t unix_s, std::string_view body) {
    return fmt::format("sha256={}", hmac_sha256(secret, fmt::format("{}.{}", unix_s, body)));
}

std::chrono::seconds webhook_back_off(int failures) {
    constexpr int kMostDoublings = 12;
    return std::min<std::chrono::seconds>(1s * (1 << std::clamp(failures - 1, 0, kMostDoublings)),
                                          1h);
}

Webhook::Webhook(WebhookConfig config, const EventLog& events, Settings& settings, Duties& duties)
    : config_(std::move(config)), events_(events), settings_(settings), duties_(duties) {
    if (!settings_.get(place_key())) {
        settings_.put(place_key(), std::to_string(events_.last_seq()));
    }
    told_ = place();
    duties.want(duty());
    thread_ = std::jthread([this](const std::stop_token& stop) { loop(stop); });
}

// The event log is the queue of what is still to be told; this is the hook's place in it.
std::string Webhook::place_key() const {
    return fmt::format("webhook.told:{}", config_.url);
}

std::string Webhook::duty() const {
    return fmt::format("webhook {}", config_.url);
}

std::int64_t Webhook::place() const {
    const std::optional<std::string> known = settings_.get(place_key());
    return known ? nlohmann::json::parse(*known).get<std::int64_t>() : events_.last_seq();
}

Webhook::~Webhook() {
    thread_.request_stop();
    thread_.join();
}

void Webhook::wake() {
    {
        const std::scoped_lock lock(mutex_);
        grew_ = true;
    }
    arrived_.notify_one();
}

void Webhook::loop(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
        try {
            if (!duties_.has(duty())) {
                std::unique_lock lock(mutex_);
                arrived_.wait_for(lock, stop, 1s, [] { return false; });
            } else if (!tell_next(stop)) {
                std::unique_lock lock(mutex_);
                arrived_.wait_for(lock, stop, kLookAgain, [this] { return grew_; });
                grew_ = false;
            }
        } catch (const std::exception& error) {  // The store failed: it is asked again later.
            spdlog::error("webhook {}: {}", config_.url, error.what());
            std::unique_lock lock(mutex_);
            arrived_.wait_for(lock, stop, webhook_back_off(1), [] { return false; });
        }
    }
}

// False: nothing is left to be told.
bool Webhook::tell_next(const std::stop_token& stop) {
    told_ = place();  // Another node may have gone on.
    const std::vector<EventRecord> next = events_.after(told_, 1);
    if (next.empty()) {
        return false;
    }
    const EventRecord& event = next.front();
    const bool wanted =
        std::find(config_.events.begin(), config_.events.end(), event.type) != config_.events.end();
    if (!wanted || deliver(event)) {
        failures_ = 0;
        pass(event);
        return true;
    }
    if (++failures_ >= kMostFailures) {
        spdlog::error("webhook {}: event {} is left out", config_.url, event.seq);
        failures_ = 0;
        pass(event);
        return true;
    }
    std::unique_lock lock(mutex_);
    arrived_.wait_for(lock, stop, webhook_back_off(failures_), [] { return false; });
    return true;
}

void Webhook::pass(const EventRecord& event) {
    // Not if this node was frozen in mid-call and another one has told more since.
    if (settings_.replace(place_key(), std::to_string(told_), std::to_string(event.seq))) {
        told_ = event.seq;
    }
}

bool Webhook::deliver(const EventRecord& event) {
    const std::string body = webhook_body(event);
    constexpr std::int64_t kMsPerS = 1000;
    const std::int64_t now_s = wall_clock_ms() / kMsPerS;
    const PostResult result =
        post_json(config_.url, body,
                  {{"X-Leafcutter-Event", event.type},
                   {"X-Leafcutter-Delivery", std::to_string(event.seq)},
                   {"X-Leafcutter-Timestamp", std::to_string(now_s)},
                   {"X-Leafcutter-Signature", webhook_signature(config_.secret, now_s, body)}},
                  config_.allow_private);
    if (!result.taken) {
        spdlog::warn("webhook {}: event {}: {}", config_.url, event.seq, result.trouble);
    }
    return result.taken;
}

}  // namespace leafcutter::server
