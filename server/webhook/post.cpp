#include "server/webhook/post.h"

#include <arpa/inet.h>
#include <array>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <memory>
#include <netdb.h>
#include <netinet/in.h>

#include <fmt/format.h>
#include <httplib.h>

namespace leafcutter::server {

namespace {

struct Network {
    std::uint32_t address = 0;
    int bits = 0;
};

// RFC 6890 and its like: what is not the public internet.
constexpr std::array<Network, 14> kNotPublic{{{0x00000000U, 8},
                                              {0x0A000000U, 8},
                                              {0x64400000U, 10},
                                              {0x7F000000U, 8},
                                              {0xA9FE0000U, 16},
                                              {0xAC100000U, 12},
                                              {0xC0000000U, 24},
                                              {0xC0000200U, 24},
                                              {0xC0A80000U, 16},
                                              {0xC6120000U, 15},
                                              {0xC6336400U, 24},
                                              {0xCB007100U, 24},
                                              {0xE0000000U, 4},
                                              {0xF0000000U, 4}}};

bool is_private_v4(std::uint32_t address) {
    for (const Network& network : kNotPublic) {
        const std::uint32_t mask = ~std::uint32_t{0} << (32 - network.bits);
        if ((address & mask) == network.address) {
            return true;
        }
    }
    return false;
}

// Only global unicast, 2000::/3, leads out; 2002::/16 and 2001::/32 carry IPv4 addresses inside.
bool is_private_v6(const in6_addr& address) {
    const auto& bytes = address.s6_addr;
    const bool global = (bytes[0] & 0xE0U) == 0x20U;
    const bool six_to_four = bytes[0] == 0x20U && bytes[1] == 0x02U;
    const bool teredo = bytes[0] == 0x20U && bytes[1] == 0x01U && bytes[2] == 0U && bytes[3] == 0U;
    const bool documentation =
        bytes[0] == 0x20U && bytes[1] == 0x01U && bytes[2] == 0x0DU && bytes[3] == 0xB8U;
    return !global || six_to_four || teredo || documentation;
}

std::optional<std::string> first_address(const Target& target, bool allow_private) {
    addrinfo hints{};
    hints.ai_socktype = SOCK_STREAM;
    addrinfo* first = nullptr;
    if (::getaddrinfo(target.host.c_str(), nullptr, &hints, &first) != 0) {
        return std::nullopt;
    }
    const std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)> owner(first, &::freeaddrinfo);
    for (const addrinfo* each = first; each != nullptr; each = each->ai_next) {
        std::array<char, NI_MAXHOST> text{};
        const bool known = ::getnameinfo(each->ai_addr, each->ai_addrlen, text.data(), text.size(),
                                         nullptr, 0, NI_NUMERICHOST) == 0;
        if (known && (allow_private || !is_private_address(text.data()))) {
            return text.data();
        }
    }
    return std::nullopt;
}

}  // namespace

std::optional<Target> target_of(std::string_view url) {
    Target target;
    const std::size_t colon = url.find("://");
    target.scheme = url.substr(0, std::min(colon, url.size()));
    if (colon == std::string_view::npos || (target.scheme != "http" && target.scheme != "https")) {
        return std::nullopt;
    }
    target.port = target.scheme == "https" ? 443 : 80;
    std::string_view rest = url.substr(colon + 3);
    const std::size_t slash = std::min(rest.find_first_of("/?"), rest.size());
    std::string_view host = rest.substr(0, slash);
    const std::string_view path = rest.substr(slash);
    target.path = path.starts_with('/') ? std::string(path) : fmt::format("/{}", path);
    const std::size_t end_of_name = host.starts_with('[') ? host.find(']') : 0;
    const std::size_t port_at = host.find(':', std::min(end_of_name, host.size()));
    if (port_at != std::string_view::npos) {
        const char* end = host.data() + host.size();
        const auto parsed = std::from_chars(host.data() + port_at + 1, end, target.port);
        if (parsed.ec != std::errc() || parsed.ptr != end || target.port < 1 ||
            target.port > 65535) {
            return std::nullopt;
        }
        host = host.substr(0, port_at);
    }
    if (host.starts_with('[') && host.ends_with(']')) {
        host = host.substr(1, host.size() - 2);
    }
    target.host = host;
    const bool plain = url.find_first_of("@#\\ \t\r\n") == std::string_view::npos;
    return plain && !host.empty() ? std::optional(target) : std::nullopt;
}

bool is_private_address(const std::string& address) {
    in_addr v4{};
    if (::inet_pton(AF_INET, address.c_str(), &v4) == 1) {
        return is_private_v4(ntohl(v4.s_addr));
    }
    in6_addr v6{};
    if (::inet_pton(AF_INET6, address.substr(0, address.find('%')).c_str(), &v6) == 1) {
        return is_private_v6(v6);
    }
    return true;
}

PostResult post_json(const std::string& url,
                     const std::string& body,
                     const std::map<std::string, std::string>& headers,
                     bool allow_private) {
    const std::optional<Target> target = target_of(url);
    if (!target) {
        return {false, "this is no http or https address"};
    }
    const std::optional<std::string> address = first_address(*target, allow_private);
    if (!address) {
        return {false, allow_private ? "the name is not known"
                                     : "the name is not known, or leads into a private network "
                                       "(allow_private)"};
    }
    const bool v6 = target->host.find(':') != std::string::npos;
    httplib::Client client(fmt::format("{}://{}:{}", target->scheme,
                                       v6 ? fmt::format("[{}]", target->host) : target->host,
                                       target->port));
    client.set_hostname_addr_map({{target->host, *address}});
    constexpr int kPatienceS = 5;
    client.set_connection_timeout(kPatienceS);
    client.set_read_timeout(kPatienceS);
    client.set_write_timeout(kPatienceS);
    client.set_follow_location(false);
    client.set_decompress(false);
    httplib::Request request;
    request.method = "POST";
    request.path = target->path;
    request.body = body;
    request.headers.emplace("Content-Type", "application/json");
    for (const auto& [name, value] : headers) {
        request.headers.emplace(name, value);
    }
    std::size_t heard = 0;
    constexpr std::size_t kMostHeard = 65536;  // Nobody reads the answer; it just has to end.
    request.content_receiver = [&heard](const char*, std::size_t size, std::uint64_t,
                                        std::uint64_t) { return (heard += size) <= kMostHeard; };
    const httplib::Result result = client.send(request);
    if (!result) {
        return {false, httplib::to_string(result.error())};
    }
    const bool taken = result->status >= 200 && result->status < 300;
    return {taken, taken ? "" : fmt::format("answered with {}", result->status)};
}

}  // namespace leafcutter::server
