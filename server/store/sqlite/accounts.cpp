#include "server/store/sqlite/accounts.h"

#include <limits>

#include <SQLiteCpp/SQLiteCpp.h>

#include "server/store/sqlite/database.h"

namespace leafcutter::server {

namespace {

// A word this version doesn't know gives no rights.
Role role_in(const SQLite::Column& column) {
    return role_named(column.getString()).value_or(Role::Nobody);
}

std::vector<User> users_of(SQLite::Database& database) {
    std::vector<User> users;
    SQLite::Statement query(database, "SELECT name, role, password_hash, created_ms FROM account");
    while (query.executeStep()) {
        users.push_back({query.getColumn(0).getString(), role_in(query.getColumn(1)),
                         query.getColumn(2).getString(), query.getColumn(3).getInt64()});
    }
    return users;
}

std::vector<ApiKey> keys_of(SQLite::Database& database) {
    std::vector<ApiKey> keys;
    SQLite::Statement query(database,
                            "SELECT id, account, label, role, may_fire, secret_hash, created_ms, "
                            "expires_ms FROM api_key");
    while (query.executeStep()) {
        ApiKey& key = keys.emplace_back();
        key.id = query.getColumn(0).getString();
        key.user = query.getColumn(1).getString();
        key.label = query.getColumn(2).getString();
        key.role = role_in(query.getColumn(3));
        key.may_fire = query.getColumn(4).getInt() != 0;
        key.secret_hash = query.getColumn(5).getString();
        key.created_ms = query.getColumn(6).getInt64();
        key.expires_ms = query.getColumn(7).getInt64();
    }
    return keys;
}

std::vector<Session> sessions_of(SQLite::Database& database) {
    std::vector<Session> sessions;
    SQLite::Statement query(database, "SELECT token_hash, account, created_ms FROM session");
    while (query.executeStep()) {
        const std::int64_t created_ms = query.getColumn(2).getInt64();
        sessions.push_back({query.getColumn(0).getString(), query.getColumn(1).getString(),
                            created_ms, created_ms});
    }
    return sessions;
}

}  // namespace

StoredAccounts SqliteAccountStore::load() const {
    StoredAccounts stored;
    database_.read([&stored](SQLite::Database& database) {
        stored = {users_of(database), keys_of(database), sessions_of(database)};
    });
    return stored;
}

void SqliteAccountStore::put(const User& user) {
    database_.write([&user](SQLite::Database& database) {
        // No REPLACE, which would remove the row first, and its keys with it.
        SQLite::Statement upsert(
            database,
            "INSERT INTO account(name, role, password_hash, created_ms) VALUES(?, ?, ?, ?) "
            "ON CONFLICT(name) DO UPDATE SET role = excluded.role, "
            "password_hash = excluded.password_hash");
        upsert.bind(1, user.name);
        upsert.bind(2, std::string(to_string(user.role)));
        upsert.bind(3, user.password_hash);
        upsert.bind(4, user.created_ms);
        upsert.exec();
    });
}

void SqliteAccountStore::put(const ApiKey& key) {
    database_.write([&key](SQLite::Database& database) {
        SQLite::Statement insert(database,
                                 "INSERT OR REPLACE INTO api_key(id, account, label, role, "
                                 "may_fire, secret_hash, created_ms, expires_ms) "
                                 "VALUES(?, ?, ?, ?, ?, ?, ?, ?)");
        insert.bind(1, key.id);
        insert.bind(2, key.user);
        insert.bind(3, key.label);
        insert.bind(4, std::string(to_string(key.role)));
        insert.bind(5, key.may_fire ? 1 : 0);
        insert.bind(6, key.secret_hash);
        insert.bind(7, key.created_ms);
        insert.bind(8, key.expires_ms);
        insert.exec();
    });
}

void SqliteAccountStore::put(const Session& session) {
    database_.write([&session](SQLite::Database& database) {
        SQLite::Statement insert(
            database,
            "INSERT OR REPLACE INTO session(token_hash, account, created_ms) VALUES(?, ?, ?)");
        insert.bind(1, session.token_hash);
        insert.bind(2, session.user);
        insert.bind(3, session.created_ms);
        insert.exec();
    });
}

void SqliteAccountStore::erase(const char* statement, const std::string& key) {
    database_.write([&](SQLite::Database& database) {
        SQLite::Statement erase(database, statement);
        erase.bind(1, key);
        erase.exec();
    });
}

void SqliteAccountStore::remove_user(const std::string& name) {
    erase("DELETE FROM account WHERE name = ?", name);
}

void SqliteAccountStore::remove_key(const std::string& id) {
    erase("DELETE FROM api_key WHERE id = ?", id);
}

void SqliteAccountStore::remove_session(const std::string& token_hash) {
    erase("DELETE FROM session WHERE token_hash = ?", token_hash);
}

void SqliteAccountStore::remove_sessions_of(const std::string& user) {
    erase("DELETE FROM session WHERE account = ?", user);
}

void SqliteAccountStore::append(std::span<const AuditRecord> records) {
    database_.write([&records](SQLite::Database& database) {
        SQLite::Statement insert(database,
                                 "INSERT INTO audit(at_ms, account, remote, action, note, status) "
                                 "VALUES(?, ?, ?, ?, ?, ?)");
        for (const AuditRecord& record : records) {
            insert.bind(1, record.at_ms);
            insert.bind(2, record.user);
            insert.bind(3, record.remote);
            insert.bind(4, record.action);
            insert.bind(5, record.note);
            insert.bind(6, record.status);
            insert.exec();
            insert.reset();
        }
    });
}

std::vector<AuditRecord> SqliteAccountStore::audit(std::optional<std::int64_t> below_seq,
                                                   int limit) const {
    std::vector<AuditRecord> records;
    database_.read([&](SQLite::Database& database) {
        SQLite::Statement query(database,
                                "SELECT seq, at_ms, account, remote, action, note, status "
                                "FROM audit WHERE seq < ? ORDER BY seq DESC LIMIT ?");
        query.bind(1, below_seq.value_or(std::numeric_limits<std::int64_t>::max()));
        query.bind(2, limit);
        while (query.executeStep()) {
            records.push_back({query.getColumn(0).getInt64(), query.getColumn(1).getInt64(),
                               query.getColumn(2).getString(), query.getColumn(3).getString(),
                               query.getColumn(4).getString(), query.getColumn(5).getString(),
                               query.getColumn(6).getInt()});
        }
    });
    return records;
}

}  // namespace leafcutter::server
