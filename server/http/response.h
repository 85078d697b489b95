// What a handler answers.

#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "server/auth/role.h"
#include "server/store/blobs.h"

namespace leafcutter::server {

// Part of a file, sent in pieces.
struct FilePart {
    std::shared_ptr<FileHandle> file;  // Shared with whoever sends it.
    std::int64_t offset = 0;
    std::int64_t bytes = 0;
};

// The connection becomes a stream of events.
struct EventSubscription {
    std::optional<std::string> job;         // Events of this job only.
    std::optional<std::int64_t> last_seen;  // Replay what came after it.
    Caller caller;                          // The stream ends when the daemon would refuse it.
};

struct Response {
    int status = 200;
    std::string content_type = "application/json";
    std::string body;
    std::map<std::string, std::string> headers;
    std::optional<FilePart> file;             // Instead of `body`.
    std::optional<EventSubscription> events;  // Instead of any body.
};

}  // namespace leafcutter::server
