#include "server/store/sqlite/queue_ages.h"

#include <algorithm>

#include <SQLiteCpp/SQLiteCpp.h>

#include "server/store/ids.h"
#include "server/store/sqlite/database.h"

namespace leafcutter::server {

namespace {

std::int64_t age_of(SQLite::Database& database, const char* query) {
    const SQLite::Column oldest = database.execAndGet(query);
    return oldest.isNull() ? 0 : std::max<std::int64_t>(0, wall_clock_ms() - oldest.getInt64());
}

}  // namespace

QueueAges queue_ages_of(const Database& database) {
    QueueAges ages;
    database.read([&ages](SQLite::Database& reader) {
        ages.oldest_job_ms =
            age_of(reader, "SELECT min(created_ms) FROM job WHERE state = 'queued'");
        ages.oldest_cut_ms =
            age_of(reader, "SELECT min(created_ms) FROM cut WHERE state = 'waiting'");
    });
    return ages;
}

}  // namespace leafcutter::server
