#include "server/store/sql/accounts.h"

#include <limits>

#include "server/store/sql/session.h"

namespace leafcutter::server {

namespace {

// A word this version doesn't know gives no rights.
Role role_in(const SqlColumn& column) {
    return role_named(column.text()).value_or(Role::Nobody);
}

std::vector<User> users_of(SqlSession& session) {
    std::vector<User> users;
    SqlStatement query(session, "SELECT name, role, password_hash, created_ms FROM account");
    while (query.step()) {
        users.push_back({query.column(0).text(), role_in(query.column(1)), query.column(2).text(),
                         query.column(3).int64()});
    }
    return users;
}

std::vector<ApiKey> keys_of(SqlSession& session) {
    std::vector<ApiKey> keys;
    SqlStatement query(session,
                       "SELECT id, account, label, role, may_fire, secret_hash, created_ms, "
                       "expires_ms FROM api_key");
    while (query.step()) {
        ApiKey& key = keys.emplace_back();
        key.id = query.column(0).text();
        key.user = query.column(1).text();
        key.label = query.column(2).text();
        key.role = role_in(query.column(3));
        key.may_fire = query.column(4).integer() != 0;
        key.secret_hash = query.column(5).text();
        key.created_ms = query.column(6).int64();
        key.expires_ms = query.column(7).int64();
    }
    return keys;
}

std::vector<Session> sessions_of(SqlSession& session) {
    std::vector<Session> sessions;
    SqlStatement query(session, "SELECT token_hash, account, created_ms FROM session");
    while (query.step()) {
        const std::int64_t created_ms = query.column(2).int64();
        sessions.push_back(
            {query.column(0).text(), query.column(1).text(), created_ms, created_ms});
    }
    return sessions;
}

}  // namespace

StoredAccounts SqlAccountStore::load() const {
    StoredAccounts stored;
    database_.read([&stored](SqlSession& session) {
        stored = {users_of(session), keys_of(session), sessions_of(session)};
    });
    return stored;
}

void SqlAccountStore::put(const User& user) {
    database_.write([&user](SqlSession& session) {
        // No REPLACE, which would remove the row first, and its keys with it.
        SqlStatement upsert(
            session,
            "INSERT INTO account(name, role, password_hash, created_ms) VALUES(?, ?, ?, ?) "
            "ON CONFLICT(name) DO UPDATE SET role = excluded.role, "
            "password_hash = excluded.password_hash");
        upsert.bind(1, user.name);
        upsert.bind(2, std::string(to_string(user.role)));
        upsert.bind(3, user.password_hash);
        upsert.bind(4, user.created_ms);
        upsert.run();
    });
}

void SqlAccountStore::put(const ApiKey& key) {
    database_.write([&key](SqlSession& session) {
        SqlStatement insert(session,
                            "INSERT INTO api_key(id, account, label, role, "
                            "may_fire, secret_hash, created_ms, expires_ms) "
                            "VALUES(?, ?, ?, ?, ?, ?, ?, ?) ON CONFLICT(id) DO UPDATE SET "
                            "account = excluded.account, label = excluded.label, "
                            "role = excluded.role, may_fire = excluded.may_fire, "
                            "secret_hash = excluded.secret_hash, "
                            "created_ms = excluded.created_ms, "
                            "expires_ms = excluded.expires_ms");
        insert.bind(1, key.id);
        insert.bind(2, key.user);
        insert.bind(3, key.label);
        insert.bind(4, std::string(to_string(key.role)));
        insert.bind(5, key.may_fire ? 1 : 0);
        insert.bind(6, key.secret_hash);
        insert.bind(7, key.created_ms);
        insert.bind(8, key.expires_ms);
        insert.run();
    });
}

void SqlAccountStore::put(const Session& added) {
    database_.write([&added](SqlSession& session) {
        SqlStatement insert(session,
                            "INSERT INTO session(token_hash, account, created_ms) VALUES(?, ?, ?) "
                            "ON CONFLICT(token_hash) DO UPDATE SET account = excluded.account, "
                            "created_ms = excluded.created_ms");
        insert.bind(1, added.token_hash);
        insert.bind(2, added.user);
        insert.bind(3, added.created_ms);
        insert.run();
    });
}

void SqlAccountStore::erase(const char* statement, const std::string& key) {
    database_.write([&](SqlSession& session) {
        SqlStatement erase(session, statement);
        erase.bind(1, key);
        erase.run();
    });
}

void SqlAccountStore::remove_user(const std::string& name) {
    erase("DELETE FROM account WHERE name = ?", name);
}

void SqlAccountStore::remove_key(const std::string& id) {
    erase("DELETE FROM api_key WHERE id = ?", id);
}

void SqlAccountStore::remove_session(const std::string& token_hash) {
    erase("DELETE FROM session WHERE token_hash = ?", token_hash);
}

void SqlAccountStore::remove_sessions_of(const std::string& user) {
    erase("DELETE FROM session WHERE account = ?", user);
}

void SqlAccountStore::append(std::span<const AuditRecord> records) {
    database_.write([&records](SqlSession& session) {
        SqlStatement insert(session,
                            "INSERT INTO audit(at_ms, account, remote, action, note, status) "
                            "VALUES(?, ?, ?, ?, ?, ?)");
        for (const AuditRecord& record : records) {
            insert.bind(1, record.at_ms);
            insert.bind(2, record.user);
            insert.bind(3, record.remote);
            insert.bind(4, record.action);
            insert.bind(5, record.note);
            insert.bind(6, record.status);
            insert.run();
            insert.reset();
        }
    });
}

std::vector<AuditRecord> SqlAccountStore::audit(std::optional<std::int64_t> below_seq,
                                                int limit) const {
    std::vector<AuditRecord> records;
    database_.read([&](SqlSession& session) {
        SqlStatement query(session,
                           "SELECT seq, at_ms, account, remote, action, note, status "
                           "FROM audit WHERE seq < ? ORDER BY seq DESC LIMIT ?");
        query.bind(1, below_seq.value_or(std::numeric_limits<std::int64_t>::max()));
        query.bind(2, limit);
        while (query.step()) {
            records.push_back({query.column(0).int64(), query.column(1).int64(),
                               query.column(2).text(), query.column(3).text(),
                               query.column(4).text(), query.column(5).text(),
                               query.column(6).integer()});
        }
    });
    return records;
}

}  // namespace leafcutter::server
