#include "server/store/sqlite/webhooks.h"

#include <SQLiteCpp/SQLiteCpp.h>

#include "server/store/sqlite/database.h"

namespace leafcutter::server {

std::optional<std::int64_t> SqliteWebhookStore::told(const std::string& url) const {
    std::optional<std::int64_t> seq;
    database_.read([&](SQLite::Database& database) {
        SQLite::Statement query(database, "SELECT told_seq FROM webhook WHERE url = ?");
        query.bind(1, url);
        if (query.executeStep()) {
            seq = query.getColumn(0).getInt64();
        }
    });
    return seq;
}

void SqliteWebhookStore::set_told(const std::string& url, std::int64_t seq) {
    database_.write([&](SQLite::Database& database) {
        SQLite::Statement upsert(database,
                                 "INSERT OR REPLACE INTO webhook(url, told_seq) VALUES(?, ?)");
        upsert.bind(1, url);
        upsert.bind(2, seq);
        upsert.exec();
    });
}

}  // namespace leafcutter::server
