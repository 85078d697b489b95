// The firewall: the head of a request is read and judged here, completely, before any library sees
// it. Pure: bytes in, a request or a refusal out.

#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "server/http/request.h"

namespace leafcutter::server {

struct HeadRules {
    static constexpr std::size_t kMostBytes = 16384;
    static constexpr std::size_t kMostHeaders = 64;
    static constexpr std::size_t kLongestPath = 1024;

    std::vector<std::string> hosts{"localhost", "127.0.0.1", "[::1]"};  // Without port.

    // Addresses whose X-Forwarded-For and X-Forwarded-Proto are believed.
    std::vector<std::string> trusted_proxies;
};

struct Refusal {
    int status = 400;
    std::string code;
    std::string detail;
};

struct VettedHead {
    Request request;  // Without body; `body.bytes` says what is to come.
    bool keep_alive = true;
    bool expects_continue = false;
};

// `head` ends with the empty line. `peer` is the address at the connection's other end.
std::variant<VettedHead, Refusal> vet_head(std::string_view head,
                                           const HeadRules& rules,
                                           const std::string& peer = {});

}  // namespace leafcutter::server
