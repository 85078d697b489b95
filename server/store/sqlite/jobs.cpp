#include "server/store/sqlite/jobs.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>

#include "server/store/ids.h"
#include "server/store/sqlite/database.h"
#include "server/store/sqlite/events.h"
#include "server/store/sqlite/job_rows.h"

namespace leafcutter::server {

namespace {

constexpr const char* kIsDeadLetter = " AND error_code = 'poison-job' AND state = 'failed'";

// The job that an earlier request with this key made, if any.
std::optional<JobRecord> job_of_key(SQLite::Database& database, const IdempotencyKey& key) {
    SQLite::Statement query(database, "SELECT request_hash, job FROM idempotency WHERE key = ?");
    query.bind(1, key.key);
    if (!query.executeStep()) {
        return std::nullopt;
    }
    if (query.getColumn(0).getString() != key.request_hash) {
        throw KeyReused("this Idempotency-Key belongs to a different request");
    }
    return find_job(database, query.getColumn(1).getString());
}

void remember_key(SQLite::Database& database, const IdempotencyKey& key, const std::string& job) {
    constexpr std::int64_t kKeptMs = 7LL * 24 * 3600 * 1000;
    SQLite::Statement forget(database, "DELETE FROM idempotency WHERE at_ms < ?");
    forget.bind(1, wall_clock_ms() - kKeptMs);
    forget.exec();
    SQLite::Statement insert(
        database,
        "INSERT OR REPLACE INTO idempotency(key, request_hash, job, at_ms) VALUES(?, ?, ?, ?)");
    insert.bind(1, key.key);
    insert.bind(2, key.request_hash);
    insert.bind(3, job);
    insert.bind(4, wall_clock_ms());
    insert.exec();
}

// Computing again, or never more: what broke several times would break again.
bool give_back(SQLite::Database& database, const JobRecord& job, const std::string& how) {
    if (job.attempt < JobStore::kMostAttempts) {
        return move_job(database, job.id, JobState::Computing, JobState::Queued);
    }
    if (!move_job(database, job.id, JobState::Computing, JobState::Failed)) {
        return false;
    }
    set_failure(database, job.id,
                {"crashed", "poison-job",
                 fmt::format("it was tried {} times; the last time: {}", job.attempt, how)});
    return true;
}

}  // namespace

AddedJob SqliteJobStore::add(const NewJob& job, const std::optional<IdempotencyKey>& key) {
    AddedJob added;
    database_.write([&](SQLite::Database& database) {
        if (key) {
            if (const auto known = job_of_key(database, *key)) {
                added = {*known, true};
                return;
            }
        }
        const std::string id = insert_job(database, job, JobState::Queued);
        if (key) {
            remember_key(database, *key, id);
        }
        added = {find_job(database, id).value(), false};
    });
    return added;
}

JobRecord SqliteJobStore::add_ready(const NewJob& job,
                                    const std::string& recut_of,
                                    const ComputedJob& result) {
    JobRecord added;
    database_.write([&](SQLite::Database& database) {
        const std::string id = insert_job(database, job, JobState::Ready);
        SQLite::Statement update(database, "UPDATE job SET recut_of = ? WHERE id = ?");
        update.bind(1, recut_of);
        update.bind(2, id);
        update.exec();
        store_result(database, id, result);
        added = find_job(database, id).value();
    });
    return added;
}

std::optional<JobRecord> SqliteJobStore::find(const std::string& id) const {
    std::optional<JobRecord> job;
    database_.read([&](SQLite::Database& database) { job = find_job(database, id); });
    return job;
}

std::vector<JobRecord> SqliteJobStore::list(const JobQuery& wanted) const {
    std::vector<JobRecord> jobs;
    database_.read([&](SQLite::Database& database) {
        SQLite::Statement query(
            database, fmt::format("{} WHERE ordinal < ?{}{} ORDER BY ordinal DESC LIMIT ?",
                                  kSelectJob, wanted.state ? " AND state = ?" : "",
                                  wanted.dead_letters ? kIsDeadLetter : ""));
        int parameter = 1;
        query.bind(parameter++, wanted.below_ordinal.value_or(INT64_MAX));
        if (wanted.state) {
            query.bind(parameter++, std::string(to_string(*wanted.state)));
        }
        query.bind(parameter, wanted.limit);
        JobParts parts(database);
        while (query.executeStep()) {
            jobs.push_back(job_from(query));
            parts.add_to(jobs.back());
        }
    });
    return jobs;
}

bool SqliteJobStore::finish(const std::string& id, const ComputedJob& result) {
    bool moved = false;
    database_.write([&](SQLite::Database& database) {
        moved = move_job(database, id, JobState::Computing, JobState::Ready);
        if (moved) {
            store_result(database, id, result);
        }
    });
    return moved;
}

bool SqliteJobStore::fail(const std::string& id, const JobFailure& failure) {
    bool moved = false;
    database_.write([&](SQLite::Database& database) {
        moved = move_job(database, id, JobState::Computing, JobState::Failed);
        if (moved) {
            set_failure(database, id, failure);
        }
    });
    return moved;
}

bool SqliteJobStore::requeue(const std::string& id) {
    bool moved = false;
    database_.write([&](SQLite::Database& database) {
        moved = move_job(database, id, JobState::Computing, JobState::Queued);
        // Stopped on purpose: that was no failed attempt.
        SQLite::Statement uncount(database, "UPDATE job SET attempt = attempt - 1 WHERE id = ?");
        uncount.bind(1, id);
        if (moved) {
            uncount.exec();
        }
    });
    return moved;
}

bool SqliteJobStore::cancel(const std::string& id) {
    bool moved = false;
    database_.write([&](SQLite::Database& database) {
        moved = move_job(database, id, JobState::Queued, JobState::Cancelled) ||
                move_job(database, id, JobState::Computing, JobState::Cancelled);
    });
    return moved;
}

bool SqliteJobStore::rename(const std::string& id, const std::string& name) {
    bool renamed = false;
    database_.write([&](SQLite::Database& database) {
        SQLite::Statement update(database,
                                 "UPDATE job SET name = ?, version = version + 1, updated_ms = ? "
                                 "WHERE id = ?");
        update.bind(1, name);
        update.bind(2, wall_clock_ms());
        update.bind(3, id);
        renamed = update.exec() > 0;
        if (renamed) {
            tell_job(database, id, "renamed");
        }
    });
    return renamed;
}

bool SqliteJobStore::crashed(const std::string& id, const std::string& how) {
    bool moved = false;
    database_.write([&](SQLite::Database& database) {
        const auto job = find_job(database, id);
        moved = job && give_back(database, *job, how);
    });
    return moved;
}

Removal SqliteJobStore::remove(const std::string& id) {
    Removal removal = Removal::NotThere;
    database_.write([&](SQLite::Database& database) {
        const auto job = find_job(database, id);
        if (!job) {
            return;
        }
        const bool unfinished = job->state == JobState::Queued || job->state == JobState::Computing;
        if (unfinished || job->has_open_cut) {
            removal = Removal::StillInUse;
            return;
        }
        remove_job(database, id);
        removal = Removal::Removed;
    });
    return removal;
}

std::int64_t SqliteJobStore::count(JobState state) const {
    std::int64_t counted = 0;
    database_.read([&](SQLite::Database& database) {
        SQLite::Statement query(database, "SELECT count(*) FROM job WHERE state = ?");
        query.bind(1, std::string(to_string(state)));
        counted = query.executeStep() ? query.getColumn(0).getInt64() : 0;
    });
    return counted;
}

void SqliteJobStore::recover() {
    database_.write([](SQLite::Database& database) {
        std::vector<JobRecord> cut_short;
        SQLite::Statement query(database, fmt::format("{} WHERE state = 'computing'", kSelectJob));
        while (query.executeStep()) {
            cut_short.push_back(job_from(query));
        }
        for (const JobRecord& job : cut_short) {
            give_back(database, job, "the daemon died while it was computed");
        }
    });
}

}  // namespace leafcutter::server
