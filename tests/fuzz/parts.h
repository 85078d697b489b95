// How fuzzers of protocols read their input: a byte that chooses, then parts with time between
// them.

#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>
#include <vector>

namespace leafcutter::fuzz {

struct Script {
    unsigned choice = 0;
    std::vector<std::string_view> parts;  // Cut at every byte 1.
};

inline Script read_script(const std::uint8_t* data, std::size_t size) {
    Script script;
    if (size == 0) {
        return script;
    }
    script.choice = data[0];
    std::string_view rest(reinterpret_cast<const char*>(data) + 1, size - 1);
    while (!rest.empty()) {
        const std::size_t end = std::min(rest.find('\1'), rest.size());
        script.parts.push_back(rest.substr(0, end));
        rest.remove_prefix(std::min(end + 1, rest.size()));
    }
    return script;
}

inline void require(bool holds) {
    if (!holds) {
        std::abort();
    }
}

}  // namespace leafcutter::fuzz
