// Accounts and the audit log on disk. Every change is there when the call returns.

#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "server/auth/account.h"

namespace leafcutter::server {

class Database;

class AccountStore {
public:
    explicit AccountStore(Database& database) : database_(database) {}

    StoredAccounts load() const;

    // In the place of the one there was.
    void put(const User& user);
    void put(const ApiKey& key);
    void put(const Session& session);

    // With the keys and sessions.
    void remove_user(const std::string& name);
    void remove_key(const std::string& id);
    void remove_session(const std::string& token_hash);
    void remove_sessions_of(const std::string& user);

    void append(std::span<const AuditRecord> records);

    // Newest first, below `below_seq` if it is given.
    std::vector<AuditRecord> audit(std::optional<std::int64_t> below_seq, int limit) const;

private:
    void erase(const char* statement, const std::string& key);

    Database& database_;
};

}  // namespace leafcutter::server
