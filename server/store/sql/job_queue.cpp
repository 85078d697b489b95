// The part of SqlJobStore that knows who is next.

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "server/store/sql/fleet.h"
#include "server/store/sql/job_rows.h"
#include "server/store/sql/jobs.h"
#include "server/store/sql/session.h"
#include "server/store/sql/setting_rows.h"

namespace leafcutter::server {

namespace {

constexpr const char* kInOrder = "WHERE state = 'queued' ORDER BY priority DESC, place, ordinal ";
constexpr const char* kRecutsInOrder =
    "WHERE state = 'queued' AND recut <> '' ORDER BY priority DESC, place, ordinal ";
constexpr const char* kPause = "queue.paused";

struct Place {
    int priority = 0;
    std::int64_t at = 0;
};

void set_place(SqlSession& session, const std::string& id, const Place& place) {
    SqlStatement update(
        session,
        "UPDATE job SET priority = ?, place = ?, version = version + 1, updated_ms = ? "
        "WHERE id = ?");
    update.bind(1, place.priority);
    update.bind(2, place.at);
    update.bind(3, session.now_ms());
    update.bind(4, id);
    update.run();
}

// Behind every job of that priority that waits.
Place last_place(SqlSession& session, int priority) {
    SqlStatement query(session,
                       "SELECT coalesce(max(place), 0) FROM job WHERE state = 'queued' AND "
                       "priority = ?");
    query.bind(1, priority);
    query.step();
    SqlStatement newest(session, "SELECT coalesce(max(ordinal), 0) FROM job");
    newest.step();
    // Those that come later get a place by their number: they must not come before this one.
    return {priority, std::max(query.column(0).int64() + kPlaceGap,
                               newest.column(0).int64() * kPlaceGap + kPlaceGap / 2)};
}

// Wide gaps again, in the same order.
void spread_places(SqlSession& session) {
    std::vector<std::string> ids;
    SqlStatement query(session, fmt::format("SELECT id FROM job {}", kInOrder));
    while (query.step()) {
        ids.push_back(query.column(0).text());
    }
    // From the newest number backwards: whoever comes later comes behind.
    const std::int64_t newest = number_in(session, "SELECT coalesce(max(ordinal), 0) FROM job");
    std::int64_t place = (newest - static_cast<std::int64_t>(ids.size())) * kPlaceGap;
    SqlStatement update(session, "UPDATE job SET place = ? WHERE id = ?");
    for (const std::string& id : ids) {
        update.bind(1, place += kPlaceGap);
        update.bind(2, id);
        update.run();
        update.reset();
    }
}

struct Neighbours {
    std::optional<Place> before;
    std::optional<Place> there;  // Whoever stands at the wanted place now.
};

Neighbours neighbours_at(SqlSession& session, const std::string& id, int position) {
    SqlStatement query(session,
                       "SELECT priority, place FROM job WHERE state = 'queued' AND id <> ? "
                       "ORDER BY priority DESC, place, ordinal LIMIT 2 OFFSET ?");
    query.bind(1, id);
    query.bind(2, std::max(0, position - 2));
    std::vector<Place> found;
    while (query.step()) {
        found.push_back({query.column(0).integer(), query.column(1).int64()});
    }
    Neighbours around;
    if (position <= 1) {
        around.there = found.empty() ? std::nullopt : std::optional(found.front());
    } else {
        around.before = found.empty() ? std::nullopt : std::optional(found.front());
        around.there = found.size() < 2 ? std::nullopt : std::optional(found.back());
    }
    return around;
}

// Where it comes to stand between them; nothing if there is no room.
std::optional<Place> place_between(const Neighbours& around) {
    const bool same = around.before && around.before->priority == around.there->priority;
    if (!same) {
        return Place{around.there->priority, around.there->at - kPlaceGap};
    }
    const std::int64_t middle = around.before->at + (around.there->at - around.before->at) / 2;
    if (middle == around.before->at) {
        return std::nullopt;
    }
    return Place{around.there->priority, middle};
}

void take(SqlSession& session, const NodeScope& scope, const std::string& id) {
    SqlStatement update(session,
                        "UPDATE job SET attempt = attempt + 1, fence = fence + 1, owner = ?, "
                        "lease_until_ms = ? WHERE id = ?");
    const std::int64_t lease_ms = scope.lease.count();
    update.bind(1, scope.node);
    update.bind(2, lease_ms > 0 ? session.now_ms() + lease_ms : 0);
    update.bind(3, id);
    update.run();
}

bool is_queued(SqlSession& session, const std::string& id) {
    SqlStatement query(session, "SELECT 1 FROM job WHERE id = ? AND state = 'queued'");
    query.bind(1, id);
    return query.step();
}

void put_at(SqlSession& session, const std::string& id, int position) {
    Neighbours around = neighbours_at(session, id, position);
    if (!around.there) {  // Past the end: behind whoever is last.
        SqlStatement last(session,
                          "SELECT priority FROM job WHERE state = 'queued' AND id <> ? "
                          "ORDER BY priority, place DESC LIMIT 1");
        last.bind(1, id);
        if (last.step()) {
            set_place(session, id, last_place(session, last.column(0).integer()));
        }
        return;
    }
    std::optional<Place> place = place_between(around);
    if (!place) {
        spread_places(session);
        place = place_between(neighbours_at(session, id, position));
    }
    set_place(session, id, place.value());
}

}  // namespace

std::vector<JobRecord> SqlJobStore::queue(int limit) const {
    std::vector<JobRecord> jobs;
    database_.read([&](SqlSession& session) {
        SqlStatement query(session, fmt::format("{}{}LIMIT ?", kSelectJob, kInOrder));
        query.bind(1, limit);
        while (query.step()) {
            jobs.push_back(job_from(query));
        }
    });
    return jobs;
}

QueueCounts SqlJobStore::queue_counts() const {
    QueueCounts counts;
    database_.read([&](SqlSession& session) {
        SqlStatement query(
            session,
            "SELECT (SELECT count(*) FROM job WHERE state = 'queued'), "
            "(SELECT count(*) FROM job WHERE state = 'computing'), "
            "(SELECT count(*) FROM job WHERE error_code = 'poison-job' AND state = 'failed')");
        query.step();
        counts = {query.column(0).int64(), query.column(1).int64(), query.column(2).int64()};
    });
    return counts;
}

std::optional<JobRecord> SqlJobStore::claim() {
    return claim_first(kInOrder);
}

std::optional<JobRecord> SqlJobStore::claim_recut() {
    return claim_first(kRecutsInOrder);
}

std::optional<JobRecord> SqlJobStore::claim_first(const char* among) {
    std::optional<JobRecord> job;
    database_.write(
        [&](SqlSession& session) {
            job.reset();
            if (setting(session, kPause) || !is_active(session, scope_)) {
                return;
            }
            SqlStatement query(session, fmt::format("SELECT id FROM job {}LIMIT 1 {}", among,
                                                    session.for_update_of_free_rows()));
            if (!query.step()) {
                return;
            }
            const std::string id = query.column(0).text();
            query.reset();
            take(session, scope_, id);
            move_job(session, id, JobState::Queued, JobState::Computing);
            job = find_job(session, id);
        },
        WriteOrder::Beside);
    return job;
}

void SqlJobStore::pause_queue(const std::string& reason) {
    database_.write([&](SqlSession& session) {
        set_setting(session, kPause, reason);
        tell_queue(session, reason.empty() ? "paused" : fmt::format("paused: {}", reason));
    });
}

void SqlJobStore::resume_queue() {
    database_.write([](SqlSession& session) {
        if (setting(session, kPause)) {
            forget_setting(session, kPause);
            tell_queue(session, "resumed");
        }
    });
}

std::optional<std::string> SqlJobStore::queue_pause() const {
    std::optional<std::string> reason;
    database_.read([&reason](SqlSession& session) { reason = setting(session, kPause); });
    return reason;
}

bool SqlJobStore::set_priority(const std::string& id, int priority) {
    bool found = false;
    database_.write([&](SqlSession& session) {
        const auto job = find_job(session, id);
        found = job.has_value();
        if (found && job->priority != priority) {
            set_place(session, id, last_place(session, priority));
            tell_job(session, id, fmt::format("priority {}", priority));
        }
    });
    return found;
}

bool SqlJobStore::move_to(const std::string& id, int position) {
    bool moved = false;
    database_.write([&](SqlSession& session) {
        moved = is_queued(session, id);
        if (moved) {
            put_at(session, id, position);
            tell_job(session, id, fmt::format("moved to place {} of the queue", position));
        }
    });
    return moved;
}

bool SqlJobStore::retry(const std::string& id, const std::string& cause) {
    bool moved = false;
    database_.write([&](SqlSession& session) {
        moved = move_job(session, id, JobState::Failed, JobState::Queued) ||
                move_job(session, id, JobState::Cancelled, JobState::Queued);
        if (!moved) {
            return;
        }
        SqlStatement update(
            session,
            "UPDATE job SET attempt = 0, retries = retries + 1, retry_cause = ?, "
            "error_kind = NULL, error_code = NULL, error_detail = NULL WHERE id = ?");
        update.bind(1, cause);
        update.bind(2, id);
        update.run();
        set_place(session, id, last_place(session, find_job(session, id)->priority));
        tell_job(session, id, fmt::format("tried again: {}", cause));
    });
    return moved;
}

}  // namespace leafcutter::server
