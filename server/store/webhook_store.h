// How far each webhook has been told of the event log: the log is the queue of what it is still to
// be told, and this is its place in it.

#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace leafcutter::server {

class WebhookStore {
public:
    virtual ~WebhookStore() = default;

    // The last event it took; nothing for one that is new.
    virtual std::optional<std::int64_t> told(const std::string& url) const = 0;
    virtual void set_told(const std::string& url, std::int64_t seq) = 0;
};

}  // namespace leafcutter::server
