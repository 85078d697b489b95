// How far webhooks were told, in SQLite.

#pragma once

#include "server/store/webhook_store.h"

namespace leafcutter::server {

class Database;

class SqliteWebhookStore final : public WebhookStore {
public:
    explicit SqliteWebhookStore(Database& database) : database_(database) {}

    std::optional<std::int64_t> told(const std::string& url) const override;
    void set_told(const std::string& url, std::int64_t seq) override;

private:
    Database& database_;
};

}  // namespace leafcutter::server
