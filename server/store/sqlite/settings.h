// Settings in SQLite.

#pragma once

#include "server/store/settings.h"

namespace leafcutter::server {

class Database;

class SqliteSettings final : public Settings {
public:
    explicit SqliteSettings(Database& database) : database_(database) {}

    std::optional<std::string> get(const std::string& key) const override;
    void put(const std::string& key, const std::string& json) override;
    void remove(const std::string& key) override;

private:
    Database& database_;
};

}  // namespace leafcutter::server
