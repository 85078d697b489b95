#include "server/auth/role.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace leafcutter::server {

namespace {

constexpr std::array<std::string_view, 5> kNames{"nobody", "viewer", "submitter", "operator",
                                                 "admin"};

}  // namespace

std::string_view to_string(Role role) {
    return kNames.at(static_cast<std::size_t>(role));
}

std::optional<Role> role_named(std::string_view name) {
    const auto* const found = std::find(kNames.begin() + 1, kNames.end(), name);
    return found == kNames.end() ? std::nullopt
                                 : std::optional(static_cast<Role>(found - kNames.begin()));
}

}  // namespace leafcutter::server
