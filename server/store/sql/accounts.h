// Accounts and the audit log in SQL.

#pragma once

#include "server/store/account_store.h"

namespace leafcutter::server {

class SqlDatabase;

class SqlAccountStore final : public AccountStore {
public:
    explicit SqlAccountStore(SqlDatabase& database) : database_(database) {}

    StoredAccounts load() const override;
    void put(const User& user) override;
    void put(const ApiKey& key) override;
    void put(const Session& session) override;
    void remove_user(const std::string& name) override;
    void remove_key(const std::string& id) override;
    void remove_session(const std::string& token_hash) override;
    void remove_sessions_of(const std::string& user) override;
    void append(std::span<const AuditRecord> records) override;
    std::vector<AuditRecord> audit(std::optional<std::int64_t> below_seq, int limit) const override;

private:
    void erase(const char* statement, const std::string& key);

    SqlDatabase& database_;
};

}  // namespace leafcutter::server
