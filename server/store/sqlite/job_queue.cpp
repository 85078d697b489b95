// The part of SqliteJobStore that knows who is next.

#include <algorithm>
#include <utility>

#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>

#include "server/store/ids.h"
#include "server/store/sqlite/database.h"
#include "server/store/sqlite/job_rows.h"
#include "server/store/sqlite/jobs.h"
#include "server/store/sqlite/setting_rows.h"

namespace leafcutter::server {

namespace {

constexpr const char* kInOrder = "WHERE state = 'queued' ORDER BY priority DESC, place, ordinal ";
constexpr const char* kPause = "queue.paused";

struct Place {
    int priority = 0;
    std::int64_t at = 0;
};

void set_place(SQLite::Database& database, const std::string& id, const Place& place) {
    SQLite::Statement update(
        database,
        "UPDATE job SET priority = ?, place = ?, version = version + 1, updated_ms = ? "
        "WHERE id = ?");
    update.bind(1, place.priority);
    update.bind(2, place.at);
    update.bind(3, wall_clock_ms());
    update.bind(4, id);
    update.exec();
}

// Behind every job of that priority that waits.
Place last_place(SQLite::Database& database, int priority) {
    SQLite::Statement query(database,
                            "SELECT coalesce(max(place), 0) FROM job WHERE state = 'queued' AND "
                            "priority = ?");
    query.bind(1, priority);
    query.executeStep();
    SQLite::Statement newest(database, "SELECT coalesce(max(ordinal), 0) FROM job");
    newest.executeStep();
    // Those that come later get a place by their number: they must not come before this one.
    return {priority, std::max(query.getColumn(0).getInt64() + kPlaceGap,
                               newest.getColumn(0).getInt64() * kPlaceGap + kPlaceGap / 2)};
}

// Wide gaps again, in the same order.
void spread_places(SQLite::Database& database) {
    std::vector<std::string> ids;
    SQLite::Statement query(database, fmt::format("SELECT id FROM job {}", kInOrder));
    while (query.executeStep()) {
        ids.push_back(query.getColumn(0).getString());
    }
    // From the newest number backwards: whoever comes later comes behind.
    const std::int64_t newest =
        database.execAndGet("SELECT coalesce(max(ordinal), 0) FROM job").getInt64();
    std::int64_t place = (newest - static_cast<std::int64_t>(ids.size())) * kPlaceGap;
    SQLite::Statement update(database, "UPDATE job SET place = ? WHERE id = ?");
    for (const std::string& id : ids) {
        update.bind(1, place += kPlaceGap);
        update.bind(2, id);
        update.exec();
        update.reset();
    }
}

struct Neighbours {
    std::optional<Place> before;
    std::optional<Place> there;  // Whoever stands at the wanted place now.
};

Neighbours neighbours_at(SQLite::Database& database, const std::string& id, int position) {
    SQLite::Statement query(database,
                            "SELECT priority, place FROM job WHERE state = 'queued' AND id <> ? "
                            "ORDER BY priority DESC, place, ordinal LIMIT 2 OFFSET ?");
    query.bind(1, id);
    query.bind(2, std::max(0, position - 2));
    std::vector<Place> found;
    while (query.executeStep()) {
        found.push_back({query.getColumn(0).getInt(), query.getColumn(1).getInt64()});
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

bool is_queued(SQLite::Database& database, const std::string& id) {
    SQLite::Statement query(database, "SELECT 1 FROM job WHERE id = ? AND state = 'queued'");
    query.bind(1, id);
    return query.executeStep();
}

void put_at(SQLite::Database& database, const std::string& id, int position) {
    Neighbours around = neighbours_at(database, id, position);
    if (!around.there) {  // Past the end: behind whoever is last.
        SQLite::Statement last(database,
                               "SELECT priority FROM job WHERE state = 'queued' AND id <> ? "
                               "ORDER BY priority, place DESC LIMIT 1");
        last.bind(1, id);
        if (last.executeStep()) {
            set_place(database, id, last_place(database, last.getColumn(0).getInt()));
        }
        return;
    }
    std::optional<Place> place = place_between(around);
    if (!place) {
        spread_places(database);
        place = place_between(neighbours_at(database, id, position));
    }
    set_place(database, id, place.value());
}

}  // namespace

std::vector<JobRecord> SqliteJobStore::queue(int limit) const {
    std::vector<JobRecord> jobs;
    database_.read([&](SQLite::Database& database) {
        SQLite::Statement query(database, fmt::format("{}{}LIMIT ?", kSelectJob, kInOrder));
        query.bind(1, limit);
        while (query.executeStep()) {
            jobs.push_back(job_from(query));
        }
    });
    return jobs;
}

QueueCounts SqliteJobStore::queue_counts() const {
    QueueCounts counts;
    database_.read([&](SQLite::Database& database) {
        SQLite::Statement query(
            database,
            "SELECT (SELECT count(*) FROM job WHERE state = 'queued'), "
            "(SELECT count(*) FROM job WHERE state = 'computing'), "
            "(SELECT count(*) FROM job WHERE error_code = 'poison-job' AND state = 'failed')");
        query.executeStep();
        counts = {query.getColumn(0).getInt64(), query.getColumn(1).getInt64(),
                  query.getColumn(2).getInt64()};
    });
    return counts;
}

std::optional<JobRecord> SqliteJobStore::claim() {
    std::optional<JobRecord> job;
    database_.write([&](SQLite::Database& database) {
        SQLite::Statement query(database, fmt::format("SELECT id FROM job {}LIMIT 1", kInOrder));
        if (setting(database, kPause) || !query.executeStep()) {
            return;
        }
        const std::string id = query.getColumn(0).getString();
        query.reset();
        SQLite::Statement count(database, "UPDATE job SET attempt = attempt + 1 WHERE id = ?");
        count.bind(1, id);
        count.exec();
        move_job(database, id, JobState::Queued, JobState::Computing);
        job = find_job(database, id);
    });
    return job;
}

void SqliteJobStore::pause_queue(const std::string& reason) {
    database_.write([&](SQLite::Database& database) {
        set_setting(database, kPause, reason);
        tell_queue(database, reason.empty() ? "paused" : fmt::format("paused: {}", reason));
    });
}

void SqliteJobStore::resume_queue() {
    database_.write([](SQLite::Database& database) {
        if (setting(database, kPause)) {
            forget_setting(database, kPause);
            tell_queue(database, "resumed");
        }
    });
}

std::optional<std::string> SqliteJobStore::queue_pause() const {
    std::optional<std::string> reason;
    database_.read([&reason](SQLite::Database& database) { reason = setting(database, kPause); });
    return reason;
}

bool SqliteJobStore::set_priority(const std::string& id, int priority) {
    bool found = false;
    database_.write([&](SQLite::Database& database) {
        const auto job = find_job(database, id);
        found = job.has_value();
        if (found && job->priority != priority) {
            set_place(database, id, last_place(database, priority));
            tell_job(database, id, fmt::format("priority {}", priority));
        }
    });
    return found;
}

bool SqliteJobStore::move_to(const std::string& id, int position) {
    bool moved = false;
    database_.write([&](SQLite::Database& database) {
        moved = is_queued(database, id);
        if (moved) {
            put_at(database, id, position);
            tell_job(database, id, fmt::format("moved to place {} of the queue", position));
        }
    });
    return moved;
}

bool SqliteJobStore::retry(const std::string& id, const std::string& cause) {
    bool moved = false;
    database_.write([&](SQLite::Database& database) {
        moved = move_job(database, id, JobState::Failed, JobState::Queued) ||
                move_job(database, id, JobState::Cancelled, JobState::Queued);
        if (!moved) {
            return;
        }
        SQLite::Statement update(
            database,
            "UPDATE job SET attempt = 0, retries = retries + 1, retry_cause = ?, "
            "error_kind = NULL, error_code = NULL, error_detail = NULL WHERE id = ?");
        update.bind(1, cause);
        update.bind(2, id);
        update.exec();
        set_place(database, id, last_place(database, find_job(database, id)->priority));
        tell_job(database, id, fmt::format("tried again: {}", cause));
    });
    return moved;
}

}  // namespace leafcutter::server
