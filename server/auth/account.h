// Accounts as they are stored. Secrets only as digests. Times are milliseconds since 1970.

#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "server/auth/role.h"

namespace leafcutter::server {

struct User {
    std::string name;  // 1 to 64 of a-z, 0-9, '-', '_' and '.'.
    Role role = Role::Viewer;
    std::string password_hash;  // argon2id, in its own text form.
    std::int64_t created_ms = 0;
};

// A program's way in: never more than its user may do.
struct ApiKey {
    std::string id;
    std::string user;
    std::string label;
    Role role = Role::Viewer;
    bool may_fire = false;
    std::string secret_hash;  // SHA-256, hex: the secret is random, so no slow hash is needed.
    std::int64_t created_ms = 0;
    std::int64_t expires_ms = 0;  // 0: never.
    std::int64_t used_ms = 0;     // Last; 0: never.
};

struct Session {
    std::string token_hash;  // SHA-256, hex.
    std::string user;
    std::int64_t created_ms = 0;
    std::int64_t used_ms = 0;
};

struct StoredAccounts {
    std::vector<User> users;
    std::vector<ApiKey> keys;
    std::vector<Session> sessions;
};

// One action of somebody, as the audit log keeps it.
struct AuditRecord {
    std::int64_t seq = 0;
    std::int64_t at_ms = 0;
    std::string user;    // Empty: nobody known.
    std::string remote;  // The address it came from; empty: this host's command line.
    std::string action;  // "POST /api/v1/cuts/c_1/start", "login".
    std::string note;    // What the path doesn't say.
    int status = 0;      // As answered.
};

}  // namespace leafcutter::server
