#include "server/outline_json.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "fab/nest/simple_ring.h"
#include "server/json_reader.h"

namespace leafcutter::server {

using nlohmann::json;

namespace {

constexpr std::size_t kMostCorners = 2'000;

}  // namespace

fab::Ring read_outline(const json& value, const std::string& path) {
    if (!value.is_array() || value.size() < 3 || value.size() > kMostCorners) {
        refuse_param(path, fmt::format("must be a list of 3 to {} points [x, y]", kMostCorners));
    }
    constexpr Range kPlace{-kLargestLengthMm, kLargestLengthMm};
    fab::Ring ring;
    for (std::size_t i = 0; i < value.size(); ++i) {
        const std::string corner = fmt::format("{}[{}]", path, i);
        if (!value[i].is_array() || value[i].size() != 2) {
            refuse_param(corner, "must be [x, y]");
        }
        ring.emplace_back(read_number(value[i][0], corner, kPlace),
                          read_number(value[i][1], corner, kPlace));
    }
    if (ring.size() > 3 && ring.front() == ring.back()) {
        ring.pop_back();
    }
    if (const std::string fault = fab::ring_fault(ring); !fault.empty()) {
        refuse_param(path, fault);
    }
    return ring;
}

}  // namespace leafcutter::server
