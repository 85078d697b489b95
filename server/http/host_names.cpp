#include "server/http/host_names.h"

#include <algorithm>
#include <array>
#include <ifaddrs.h>
#include <memory>
#include <netdb.h>
#include <sys/socket.h>
#include <unistd.h>

#include <fmt/format.h>

#include "server/config.h"

namespace leafcutter::server {

namespace {

std::string as_host(const std::string& address) {
    const bool v6 = address.find(':') != std::string::npos;
    return v6 ? fmt::format("[{}]", address) : address;
}

std::vector<std::string> interface_addresses() {
    ifaddrs* first = nullptr;
    if (::getifaddrs(&first) != 0) {
        return {};
    }
    const std::unique_ptr<ifaddrs, decltype(&::freeifaddrs)> owner(first, &::freeifaddrs);
    std::vector<std::string> addresses;
    for (const ifaddrs* each = first; each != nullptr; each = each->ifa_next) {
        const int family = each->ifa_addr == nullptr ? AF_UNSPEC : each->ifa_addr->sa_family;
        if (family != AF_INET && family != AF_INET6) {
            continue;
        }
        const socklen_t size = family == AF_INET ? sizeof(sockaddr_in) : sizeof(sockaddr_in6);
        std::array<char, NI_MAXHOST> text{};
        if (::getnameinfo(each->ifa_addr, size, text.data(), text.size(), nullptr, 0,
                          NI_NUMERICHOST) == 0) {
            addresses.emplace_back(text.data());
        }
    }
    return addresses;
}

}  // namespace

std::string lower_host_name() {
    std::array<char, 256> name{};
    if (::gethostname(name.data(), name.size() - 1) != 0) {
        return {};
    }
    std::string result = name.data();
    std::transform(result.begin(), result.end(), result.begin(), [](char c) {
        return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    });
    return result;
}

std::vector<std::string> own_host_names(const std::string& listen_address) {
    std::vector<std::string> names{as_host(listen_address)};
    if (is_loopback(listen_address)) {
        return names;
    }
    if (listen_address == "0.0.0.0" || listen_address == "::") {
        for (const std::string& address : interface_addresses()) {
            names.push_back(as_host(address));
        }
    }
    const std::string host = lower_host_name();
    if (!host.empty()) {
        names.push_back(host);
        names.push_back(fmt::format("{}.local", host));
    }
    return names;
}

}  // namespace leafcutter::server
