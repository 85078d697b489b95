// One POST to an address that a configuration named.

#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace leafcutter::server {

struct Target {
    std::string scheme;  // "http" or "https".
    std::string host;    // Without brackets.
    int port = 80;
    std::string path = "/";
};

// Nothing unless it is http://… or https://… with a host and neither user nor fragment.
std::optional<Target> target_of(std::string_view url);

// A numeric address that leads to this host or its own network: loopback, private, link-local,
// unique local, multicast, unspecified, and IPv4 in IPv6's clothes alike. Also what is none at all.
bool is_private_address(const std::string& address);

struct PostResult {
    bool taken = false;   // Answered with 2xx.
    std::string trouble;  // Else why not.
};

// Follows no redirect, gives up after seconds. The name is looked up once: the address that was
// judged is the one that is called.
PostResult post_json(const std::string& url,
                     const std::string& body,
                     const std::map<std::string, std::string>& headers,
                     bool allow_private);

}  // namespace leafcutter::server
