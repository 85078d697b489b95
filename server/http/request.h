// One request, vetted by the edge: what handlers see instead of any HTTP library.

#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "server/auth/role.h"

namespace leafcutter::server {

// The body on its way in, never held as a whole.
struct RequestBody {
    std::int64_t bytes = 0;  // As announced; the edge lets no other number through.

    // Fills at most `room` bytes; 0 at the end. Throws RequestAborted if the client is gone or too
    // slow.
    std::function<std::size_t(std::span<char> room)> read;
};

struct Request {
    std::string method;
    std::string path;                             // Decoded; starts with '/'.
    std::map<std::string, std::string> query;     // Decoded.
    std::map<std::string, std::string> headers;   // Names in lower case.
    std::map<std::string, std::string> captures;  // The {names} of the route.
    RequestBody body;
    std::string remote;      // The client's address, or what a trusted proxy says it is.
    bool is_secure = false;  // By TLS, as far as the last trusted proxy.
    Caller caller;           // Found out by the router.
    std::string audit_note;  // What the path doesn't say of the action; for the audit log.

    std::optional<std::string> header(const std::string& lower_name) const;
    const std::string& capture(const std::string& name) const { return captures.at(name); }
};

// The client went away or dawdles: there is nobody to answer.
class RequestAborted : public std::exception {
public:
    const char* what() const noexcept override { return "the client went away or was too slow"; }
};

// "%41" -> "A". Nothing for broken escapes or a NUL.
std::optional<std::string> percent_decoded(std::string_view text);

}  // namespace leafcutter::server
