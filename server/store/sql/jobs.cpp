#include "server/store/sql/jobs.h"

#include <fmt/format.h>

#include "server/store/sql/events.h"
#include "server/store/sql/job_rows.h"
#include "server/store/sql/session.h"

namespace leafcutter::server {

namespace {

constexpr const char* kIsDeadLetter = " AND error_code = 'poison-job' AND state = 'failed'";

// The job that an earlier request with this key made, if any.
std::optional<JobRecord> job_of_key(SqlSession& session, const IdempotencyKey& key) {
    SqlStatement query(session, "SELECT request_hash, job FROM idempotency WHERE key = ?");
    query.bind(1, key.key);
    if (!query.step()) {
        return std::nullopt;
    }
    if (query.column(0).text() != key.request_hash) {
        throw KeyReused("this Idempotency-Key belongs to a different request");
    }
    return find_job(session, query.column(1).text());
}

void remember_key(SqlSession& session, const IdempotencyKey& key, const std::string& job) {
    constexpr std::int64_t kKeptMs = 7LL * 24 * 3600 * 1000;
    SqlStatement forget(session, "DELETE FROM idempotency WHERE at_ms < ?");
    forget.bind(1, session.now_ms() - kKeptMs);
    forget.run();
    SqlStatement insert(session,
                        "INSERT INTO idempotency(key, request_hash, job, at_ms) VALUES(?, ?, ?, ?) "
                        "ON CONFLICT(key) DO UPDATE SET request_hash = excluded.request_hash, "
                        "job = excluded.job, at_ms = excluded.at_ms");
    insert.bind(1, key.key);
    insert.bind(2, key.request_hash);
    insert.bind(3, job);
    insert.bind(4, session.now_ms());
    insert.run();
}

}  // namespace

AddedJob SqlJobStore::add(const NewJob& job, const std::optional<IdempotencyKey>& key) {
    AddedJob added;
    database_.write([&](SqlSession& session) {
        if (key) {
            if (const auto known = job_of_key(session, *key)) {
                added = {*known, true};
                return;
            }
        }
        const std::string id = insert_job(session, job, JobState::Queued);
        if (key) {
            remember_key(session, *key, id);
        }
        added = {find_job(session, id).value(), false};
    });
    return added;
}

JobRecord SqlJobStore::add_ready(const NewJob& job, const ComputedJob& result) {
    JobRecord added;
    database_.write([&](SqlSession& session) {
        const std::string id = insert_job(session, job, JobState::Ready);
        store_result(session, id, result);
        added = find_job(session, id).value();
    });
    return added;
}

std::optional<JobRecord> SqlJobStore::find(const std::string& id) const {
    std::optional<JobRecord> job;
    database_.read([&](SqlSession& session) { job = find_job(session, id); });
    return job;
}

std::vector<JobRecord> SqlJobStore::list(const JobQuery& wanted) const {
    std::vector<JobRecord> jobs;
    database_.read([&](SqlSession& session) {
        SqlStatement query(session,
                           fmt::format("{} WHERE ordinal < ?{}{} ORDER BY ordinal DESC LIMIT ?",
                                       kSelectJob, wanted.state ? " AND state = ?" : "",
                                       wanted.dead_letters ? kIsDeadLetter : ""));
        int parameter = 1;
        query.bind(parameter++, wanted.below_ordinal.value_or(INT64_MAX));
        if (wanted.state) {
            query.bind(parameter++, std::string(to_string(*wanted.state)));
        }
        query.bind(parameter, wanted.limit);
        JobParts parts(session);
        while (query.step()) {
            jobs.push_back(job_from(query));
            parts.add_to(jobs.back());
        }
    });
    return jobs;
}

bool SqlJobStore::finish(const JobClaim& job, const ComputedJob& result) {
    bool moved = false;
    database_.write(
        [&](SqlSession& session) {
            moved = settle_job(session, job, JobState::Ready);
            if (moved) {
                store_result(session, job.id, result);
            }
        },
        WriteOrder::Beside);
    return moved;
}

bool SqlJobStore::fail(const JobClaim& job, const JobFailure& failure) {
    bool moved = false;
    database_.write(
        [&](SqlSession& session) {
            moved = settle_job(session, job, JobState::Failed);
            if (moved) {
                set_failure(session, job.id, failure);
            }
        },
        WriteOrder::Beside);
    return moved;
}

bool SqlJobStore::requeue(const JobClaim& job) {
    bool moved = false;
    database_.write(
        [&](SqlSession& session) {
            moved = settle_job(session, job, JobState::Queued);
            // Stopped on purpose: that was no failed attempt.
            SqlStatement uncount(session, "UPDATE job SET attempt = attempt - 1 WHERE id = ?");
            uncount.bind(1, job.id);
            if (moved) {
                uncount.run();
            }
        },
        WriteOrder::Beside);
    return moved;
}

bool SqlJobStore::cancel(const std::string& id) {
    bool moved = false;
    database_.write([&](SqlSession& session) {
        moved = move_job(session, id, JobState::Queued, JobState::Cancelled) ||
                move_job(session, id, JobState::Computing, JobState::Cancelled);
    });
    return moved;
}

bool SqlJobStore::rename(const std::string& id, const std::string& name) {
    bool renamed = false;
    database_.write([&](SqlSession& session) {
        SqlStatement update(session,
                            "UPDATE job SET name = ?, version = version + 1, updated_ms = ? "
                            "WHERE id = ?");
        update.bind(1, name);
        update.bind(2, session.now_ms());
        update.bind(3, id);
        renamed = update.run() > 0;
        if (renamed) {
            tell_job(session, id, "renamed");
        }
    });
    return renamed;
}

bool SqlJobStore::crashed(const JobClaim& claim, const std::string& how) {
    bool moved = false;
    database_.write([&](SqlSession& session) {
        const auto job = find_job(session, claim.id);
        moved =
            job && claim.fence.value_or(job->fence) == job->fence && give_back(session, *job, how);
    });
    return moved;
}

Removal SqlJobStore::remove(const std::string& id) {
    Removal removal = Removal::NotThere;
    database_.write([&](SqlSession& session) {
        const auto job = find_job(session, id);
        if (!job) {
            return;
        }
        const bool unfinished = job->state == JobState::Queued || job->state == JobState::Computing;
        if (unfinished || job->has_open_cut) {
            removal = Removal::StillInUse;
            return;
        }
        remove_job(session, id);
        removal = Removal::Removed;
    });
    return removal;
}

std::int64_t SqlJobStore::count(JobState state) const {
    std::int64_t counted = 0;
    database_.read([&](SqlSession& session) {
        SqlStatement query(session, "SELECT count(*) FROM job WHERE state = ?");
        query.bind(1, std::string(to_string(state)));
        counted = query.step() ? query.column(0).int64() : 0;
    });
    return counted;
}

void SqlJobStore::recover() {
    database_.write([this](SqlSession& session) {
        std::vector<JobRecord> cut_short;
        SqlStatement query(session,
                           fmt::format("{} WHERE state = 'computing' AND owner = ?", kSelectJob));
        query.bind(1, scope_.node);
        while (query.step()) {
            cut_short.push_back(job_from(query));
        }
        for (const JobRecord& job : cut_short) {
            give_back(session, job, "the daemon died while it was computed");
        }
    });
}

}  // namespace leafcutter::server
