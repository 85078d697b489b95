// The rows of settings, as the store's parts read and change them.

#pragma once

#include <optional>
#include <string>

namespace SQLite {  // NOLINT(readability-identifier-naming): theirs
class Database;
}

namespace leafcutter::server {

std::optional<std::string> setting(SQLite::Database& database, const std::string& key);
void set_setting(SQLite::Database& database, const std::string& key, const std::string& value);
void forget_setting(SQLite::Database& database, const std::string& key);

}  // namespace leafcutter::server
