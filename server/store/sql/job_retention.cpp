// The part of SqlJobStore that lets old jobs go.

#include <vector>

#include "server/store/sql/job_rows.h"
#include "server/store/sql/jobs.h"
#include "server/store/sql/session.h"

namespace leafcutter::server {

namespace {

// Cuts that are over but interrupted may still be finished: their jobs stay.
constexpr const char* kEnded =
    "SELECT id FROM job WHERE state IN ('done','failed','cancelled') AND updated_ms < ? "
    "AND NOT EXISTS(SELECT 1 FROM cut WHERE cut.job = job.id AND "
    "cut.state NOT IN ('done','aborted','failed')) ";

// The database's clock decides: a node's own may be wrong.
std::vector<std::string> ended_before(SqlSession& session,
                                      const std::string& more,
                                      std::chrono::milliseconds age,
                                      int limit) {
    SqlStatement query(session, kEnded + more + "ORDER BY updated_ms LIMIT ?");
    query.bind(1, session.now_ms() - age.count());
    query.bind(2, limit);
    std::vector<std::string> ids;
    while (query.step()) {
        ids.push_back(query.column(0).text());
    }
    return ids;
}

}  // namespace

int SqlJobStore::remove_finished(std::chrono::milliseconds age, int limit) {
    int removed = 0;
    database_.write([&](SqlSession& session) {
        for (const std::string& id : ended_before(session, "", age, limit)) {
            remove_job(session, id);
            ++removed;
        }
    });
    return removed;
}

int SqlJobStore::drop_packages(std::chrono::milliseconds age, int limit) {
    int dropped = 0;
    database_.write([&](SqlSession& session) {
        SqlStatement erase(session, "DELETE FROM artifact WHERE job = ?");
        const std::string has_one =
            "AND EXISTS(SELECT 1 FROM artifact WHERE artifact.job = job.id) ";
        for (const std::string& id : ended_before(session, has_one, age, limit)) {
            erase.bind(1, id);
            erase.run();
            erase.reset();
            tell_job(session, id, "its package was let go");
            ++dropped;
        }
    });
    return dropped;
}

}  // namespace leafcutter::server
