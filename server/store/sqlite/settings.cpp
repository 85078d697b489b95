#include "server/store/sqlite/settings.h"

#include <SQLiteCpp/SQLiteCpp.h>

#include "server/store/sqlite/database.h"
#include "server/store/sqlite/setting_rows.h"

namespace leafcutter::server {

std::optional<std::string> setting(SQLite::Database& database, const std::string& key) {
    SQLite::Statement query(database, "SELECT value FROM setting WHERE key = ?");
    query.bind(1, key);
    return query.executeStep() ? std::optional(query.getColumn(0).getString()) : std::nullopt;
}

void set_setting(SQLite::Database& database, const std::string& key, const std::string& value) {
    SQLite::Statement upsert(database, "INSERT OR REPLACE INTO setting(key, value) VALUES(?, ?)");
    upsert.bind(1, key);
    upsert.bind(2, value);
    upsert.exec();
}

void forget_setting(SQLite::Database& database, const std::string& key) {
    SQLite::Statement erase(database, "DELETE FROM setting WHERE key = ?");
    erase.bind(1, key);
    erase.exec();
}

std::optional<std::string> SqliteSettings::get(const std::string& key) const {
    std::optional<std::string> value;
    database_.read([&](SQLite::Database& database) { value = setting(database, key); });
    return value;
}

void SqliteSettings::put(const std::string& key, const std::string& json) {
    database_.write([&](SQLite::Database& database) { set_setting(database, key, json); });
}

void SqliteSettings::remove(const std::string& key) {
    database_.write([&](SQLite::Database& database) { forget_setting(database, key); });
}

}  // namespace leafcutter::server
