// Settings in SQL.

#pragma once

#include "server/store/settings.h"

namespace leafcutter::server {

class SqlDatabase;

class SqlSettings final : public Settings {
public:
    explicit SqlSettings(SqlDatabase& database) : database_(database) {}

    std::optional<std::string> get(const std::string& key) const override;
    void put(const std::string& key, const std::string& json) override;
    bool replace(const std::string& key,
                 const std::string& expected,
                 const std::string& json) override;
    void remove(const std::string& key) override;

private:
    SqlDatabase& database_;
};

}  // namespace leafcutter::server
