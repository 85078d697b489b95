// How far each webhook has been told of the event log: the log is the queue of what it is still to
// be told, and this is its place in it.

#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace leafcutter::server {

class Database;

class WebhookStore {
public:
    explicit WebhookStore(Database& database) : database_(database) {}

    // The last event it took; nothing for one that is new.
    std::optional<std::int64_t> told(const std::string& url) const;
    void set_told(const std::string& url, std::int64_t seq);

private:
    Database& database_;
};

}  // namespace leafcutter::server
