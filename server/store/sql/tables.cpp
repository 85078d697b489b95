#include "server/store/sql/tables.h"

#include <algorithm>

#include "server/store/sql/session.h"

namespace leafcutter::server {

namespace {

std::int64_t age_of(SqlSession& session, const char* query) {
    SqlStatement oldest(session, query);
    if (!oldest.step() || oldest.column(0).is_null()) {
        return 0;
    }
    return std::max<std::int64_t>(0, session.now_ms() - oldest.column(0).int64());
}

}  // namespace

SqlTables::SqlTables(SqlDatabase& database, const NodeScope& scope)
    : rows_(database),
      jobs_(database, scope),
      cuts_(database, scope),
      devices_(database),
      stock_(database),
      materials_(database, "material"),
      presets_(database, "preset"),
      settings_(database),
      events_(database),
      accounts_(database),
      fleet_(database, scope) {}

QueueAges SqlTables::queue_ages() const {
    QueueAges ages;
    rows_.read([&ages](SqlSession& session) {
        ages.oldest_job_ms =
            age_of(session, "SELECT min(created_ms) FROM job WHERE state = 'queued'");
        ages.oldest_cut_ms =
            age_of(session, "SELECT min(created_ms) FROM cut WHERE state = 'waiting'");
    });
    return ages;
}

}  // namespace leafcutter::server
