#include "server/store/sql/settings.h"

#include "server/store/sql/session.h"
#include "server/store/sql/setting_rows.h"

namespace leafcutter::server {

std::optional<std::string> setting(SqlSession& session, const std::string& key) {
    SqlStatement query(session, "SELECT value FROM setting WHERE key = ?");
    query.bind(1, key);
    return query.step() ? std::optional(query.column(0).text()) : std::nullopt;
}

void set_setting(SqlSession& session, const std::string& key, const std::string& value) {
    SqlStatement upsert(session,
                        "INSERT INTO setting(key, value) VALUES(?, ?) "
                        "ON CONFLICT(key) DO UPDATE SET value = excluded.value");
    upsert.bind(1, key);
    upsert.bind(2, value);
    upsert.run();
}

void forget_setting(SqlSession& session, const std::string& key) {
    SqlStatement erase(session, "DELETE FROM setting WHERE key = ?");
    erase.bind(1, key);
    erase.run();
}

std::optional<std::string> SqlSettings::get(const std::string& key) const {
    std::optional<std::string> value;
    database_.read([&](SqlSession& session) { value = setting(session, key); });
    return value;
}

void SqlSettings::put(const std::string& key, const std::string& json) {
    database_.write([&](SqlSession& session) { set_setting(session, key, json); });
}

bool SqlSettings::replace(const std::string& key,
                          const std::string& expected,
                          const std::string& json) {
    bool replaced = false;
    database_.write([&](SqlSession& session) {
        SqlStatement update(session, "UPDATE setting SET value = ? WHERE key = ? AND value = ?");
        update.bind(1, json);
        update.bind(2, key);
        update.bind(3, expected);
        replaced = update.run() > 0;
    });
    return replaced;
}

void SqlSettings::remove(const std::string& key) {
    database_.write([&](SqlSession& session) { forget_setting(session, key); });
}

}  // namespace leafcutter::server
