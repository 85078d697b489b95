// Who may do what: each role may do all that the ones before it may.

#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace leafcutter::server {

enum class Role { Nobody, Viewer, Submitter, Operator, Admin };

std::string_view to_string(Role role);

// "viewer" to "admin"; nothing for any other word, "nobody" included.
std::optional<Role> role_named(std::string_view name);

// Who sent a request.
struct Caller {
    enum class Proof { None, NoAccounts, Session, Key };

    Proof proof = Proof::None;
    std::string name;  // The user's; empty for nobody, and while there are no accounts.
    Role role = Role::Nobody;
    bool may_fire = false;        // May do what can turn the beam on, with the role for it.
    std::string credential = {};  // A key's id, or a session's hash.
};

}  // namespace leafcutter::server
