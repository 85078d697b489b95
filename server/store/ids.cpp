#include "server/store/ids.h"

#include <array>
#include <chrono>
#include <cstddef>
#include <ctime>
#include <sys/random.h>
#include <system_error>

#include <fmt/format.h>

namespace leafcutter::server {

std::int64_t wall_clock_ms() {
    const auto since = std::chrono::system_clock::now().time_since_epoch();
    return std::chrono::duration_cast<std::chrono::milliseconds>(since).count();
}

std::string rfc3339(std::int64_t wall_ms) {
    const std::time_t seconds = wall_ms / 1000;
    std::tm parts{};
    gmtime_r(&seconds, &parts);
    return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}.{:03}Z", parts.tm_year + 1900,
                       parts.tm_mon + 1, parts.tm_mday, parts.tm_hour, parts.tm_min, parts.tm_sec,
                       wall_ms % 1000);
}

std::string new_id(std::string_view prefix) {
    constexpr std::string_view kLetters = "0123456789abcdefghjkmnpqrstvwxyz";
    std::array<unsigned char, 16> random{};
    if (getrandom(random.data(), random.size(), 0) != static_cast<ssize_t>(random.size())) {
        throw std::system_error(errno, std::generic_category(), "getrandom");
    }
    std::string id(prefix);
    const auto time = static_cast<std::uint64_t>(wall_clock_ms());
    for (int shift = 45; shift >= 0; shift -= 5) {
        id += kLetters[(time >> shift) & 31U];
    }
    for (const unsigned char byte : random) {
        id += kLetters[byte & 31U];
    }
    return id;
}

}  // namespace leafcutter::server
