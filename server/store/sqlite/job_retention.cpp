// The part of SqliteJobStore that lets old jobs go.

#include <vector>

#include <SQLiteCpp/SQLiteCpp.h>

#include "server/store/sqlite/database.h"
#include "server/store/sqlite/job_rows.h"
#include "server/store/sqlite/jobs.h"

namespace leafcutter::server {

namespace {

// Cuts that are over but interrupted may still be finished: their jobs stay.
constexpr const char* kEnded =
    "SELECT id FROM job WHERE state IN ('done','failed','cancelled') AND updated_ms < ? "
    "AND NOT EXISTS(SELECT 1 FROM cut WHERE cut.job = job.id AND "
    "cut.state NOT IN ('done','aborted','failed')) ";

std::vector<std::string> ended_before(SQLite::Database& database,
                                      const std::string& more,
                                      std::int64_t before_ms,
                                      int limit) {
    SQLite::Statement query(database, kEnded + more + "ORDER BY updated_ms LIMIT ?");
    query.bind(1, before_ms);
    query.bind(2, limit);
    std::vector<std::string> ids;
    while (query.executeStep()) {
        ids.push_back(query.getColumn(0).getString());
    }
    return ids;
}

}  // namespace

int SqliteJobStore::remove_finished(std::int64_t before_ms, int limit) {
    int removed = 0;
    database_.write([&](SQLite::Database& database) {
        for (const std::string& id : ended_before(database, "", before_ms, limit)) {
            remove_job(database, id);
            ++removed;
        }
    });
    return removed;
}

int SqliteJobStore::drop_packages(std::int64_t before_ms, int limit) {
    int dropped = 0;
    database_.write([&](SQLite::Database& database) {
        SQLite::Statement erase(database, "DELETE FROM artifact WHERE job = ?");
        const std::string has_one =
            "AND EXISTS(SELECT 1 FROM artifact WHERE artifact.job = job.id) ";
        for (const std::string& id : ended_before(database, has_one, before_ms, limit)) {
            erase.bind(1, id);
            erase.exec();
            erase.reset();
            tell_job(database, id, "its package was let go");
            ++dropped;
        }
    });
    return dropped;
}

}  // namespace leafcutter::server
