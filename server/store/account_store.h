// Accounts and the audit log on disk. Every change is there when the call returns.

#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "server/auth/account.h"

namespace leafcutter::server {

class AccountStore {
public:
    virtual ~AccountStore() = default;

    virtual StoredAccounts load() const = 0;

    // In the place of the one there was.
    virtual void put(const User& user) = 0;
    virtual void put(const ApiKey& key) = 0;
    virtual void put(const Session& session) = 0;

    // With the keys and sessions.
    virtual void remove_user(const std::string& name) = 0;
    virtual void remove_key(const std::string& id) = 0;
    virtual void remove_session(const std::string& token_hash) = 0;
    virtual void remove_sessions_of(const std::string& user) = 0;

    virtual void append(std::span<const AuditRecord> records) = 0;

    // Newest first, below `below_seq` if it is given.
    virtual std::vector<AuditRecord> audit(std::optional<std::int64_t> below_seq,
                                           int limit) const = 0;
};

}  // namespace leafcutter::server
