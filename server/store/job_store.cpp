#include "server/store/job_store.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>

#include "server/store/database.h"
#include "server/store/event_log.h"
#include "server/store/ids.h"

namespace leafcutter::server {

namespace {

constexpr const char* kColumns =
    "ordinal, id, name, state, version, created_ms, updated_ms, file_name, file_bytes, "
    "file_sha256, "
    "params, attempt, error_kind, error_code, error_detail, summary, recut_of";

JobRecord job_from(SQLite::Statement& row) {
    JobRecord job;
    job.ordinal = row.getColumn(0).getInt64();
    job.id = row.getColumn(1).getString();
    job.name = row.getColumn(2).getString();
    job.state = job_state_named(row.getColumn(3).getString()).value_or(JobState::Failed);
    job.version = row.getColumn(4).getInt64();
    job.created_ms = row.getColumn(5).getInt64();
    job.updated_ms = row.getColumn(6).getInt64();
    job.file = {row.getColumn(7).getString(), row.getColumn(8).getInt64(),
                row.getColumn(9).getString()};
    job.params_json = row.getColumn(10).getString();
    job.attempt = row.getColumn(11).getInt();
    if (!row.getColumn(12).isNull()) {
        job.failure = {row.getColumn(12).getString(), row.getColumn(13).getString(),
                       row.getColumn(14).getString()};
    }
    if (!row.getColumn(15).isNull()) {
        job.summary_json = row.getColumn(15).getString();
    }
    job.recut_of = row.getColumn(16).getString();
    return job;
}

void add_sheets_and_cuts(SQLite::Database& database, JobRecord& job) {
    SQLite::Statement sheets(database,
                             "SELECT number, material, program_sha256, estimated_s, cut FROM sheet "
                             "WHERE job = ? ORDER BY number");
    sheets.bind(1, job.id);
    while (sheets.executeStep()) {
        job.sheets.push_back({sheets.getColumn(0).getInt(), sheets.getColumn(1).getString(),
                              sheets.getColumn(2).getString(), sheets.getColumn(3).getDouble(),
                              sheets.getColumn(4).getInt() != 0});
    }
    SQLite::Statement cuts(database, "SELECT id FROM cut WHERE job = ? ORDER BY ordinal");
    cuts.bind(1, job.id);
    while (cuts.executeStep()) {
        job.cuts.push_back(cuts.getColumn(0).getString());
    }
}

std::optional<JobRecord> find_job(SQLite::Database& database, const std::string& id) {
    SQLite::Statement query(database, fmt::format("SELECT {} FROM job WHERE id = ?", kColumns));
    query.bind(1, id);
    if (!query.executeStep()) {
        return std::nullopt;
    }
    JobRecord job = job_from(query);
    add_sheets_and_cuts(database, job);
    return job;
}

void tell(SQLite::Database& database, const std::string& job, std::string note) {
    EventRecord event;
    event.type = "job";
    event.subject = job;
    event.job = job;
    event.note = std::move(note);
    append_event(database, event);
}

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

std::string insert_job(SQLite::Database& database, const NewJob& job, JobState state) {
    std::string id = new_id("j_");
    SQLite::Statement insert(
        database,
        "INSERT INTO job(id, name, created_ms, updated_ms, file_name, "
        "file_bytes, file_sha256, params, state) VALUES(?, ?, ?, ?, ?, ?, ?, ?, ?)");
    const std::int64_t now = wall_clock_ms();
    insert.bind(1, id);
    insert.bind(2, job.name);
    insert.bind(3, now);
    insert.bind(4, now);
    insert.bind(5, job.file.name);
    insert.bind(6, job.file.bytes);
    insert.bind(7, job.file.sha256);
    insert.bind(8, job.params_json);
    insert.bind(9, std::string(to_string(state)));
    insert.exec();
    tell(database, id, std::string(to_string(state)));
    return id;
}

void set_failure(SQLite::Database& database, const std::string& id, const JobFailure& failure) {
    SQLite::Statement update(
        database, "UPDATE job SET error_kind = ?, error_code = ?, error_detail = ? WHERE id = ?");
    update.bind(1, failure.kind);
    update.bind(2, failure.code);
    update.bind(3, failure.detail);
    update.bind(4, id);
    update.exec();
}

void store_result(SQLite::Database& database, const std::string& id, const ComputedJob& result) {
    SQLite::Statement summary(database, "UPDATE job SET summary = ? WHERE id = ?");
    summary.bind(1, result.summary_json);
    summary.bind(2, id);
    summary.exec();
    SQLite::Statement artifact(
        database,
        "INSERT INTO artifact(job, position, path, bytes, sha256, media_type) "
        "VALUES(?, ?, ?, ?, ?, ?)");
    int position = 0;
    for (const ArtifactRecord& file : result.artifacts) {
        artifact.bind(1, id);
        artifact.bind(2, position++);
        artifact.bind(3, file.path);
        artifact.bind(4, file.bytes);
        artifact.bind(5, file.sha256);
        artifact.bind(6, file.media_type);
        artifact.exec();
        artifact.reset();
    }
    SQLite::Statement sheet(database,
                            "INSERT INTO sheet(job, number, material, program_sha256, estimated_s) "
                            "VALUES(?, ?, ?, ?, ?)");
    for (const SheetRecord& each : result.sheets) {
        sheet.bind(1, id);
        sheet.bind(2, each.number);
        sheet.bind(3, each.material);
        sheet.bind(4, each.program_sha256);
        sheet.bind(5, each.estimated_s);
        sheet.exec();
        sheet.reset();
    }
}

bool has_open_cut(SQLite::Database& database, const std::string& job) {
    SQLite::Statement query(database, "SELECT state FROM cut WHERE job = ?");
    query.bind(1, job);
    while (query.executeStep()) {
        if (!is_final(
                cut_state_named(query.getColumn(0).getString()).value_or(CutState::Cutting))) {
            return true;
        }
    }
    return false;
}

}  // namespace

bool move_job(SQLite::Database& database, const std::string& id, JobState from, JobState to) {
    if (!may_follow(from, to)) {
        throw std::logic_error(
            fmt::format("a job never goes from {} to {}", to_string(from), to_string(to)));
    }
    SQLite::Statement update(database,
                             "UPDATE job SET state = ?, version = version + 1, updated_ms = ? "
                             "WHERE id = ? AND state = ?");
    update.bind(1, std::string(to_string(to)));
    update.bind(2, wall_clock_ms());
    update.bind(3, id);
    update.bind(4, std::string(to_string(from)));
    if (update.exec() == 0) {
        return false;
    }
    tell(database, id, fmt::format("{} -> {}", to_string(from), to_string(to)));
    return true;
}

AddedJob JobStore::add(const NewJob& job, const std::optional<IdempotencyKey>& key) {
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

JobRecord JobStore::add_ready(const NewJob& job,
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

std::optional<JobRecord> JobStore::find(const std::string& id) const {
    std::optional<JobRecord> job;
    database_.read([&](SQLite::Database& database) { job = find_job(database, id); });
    return job;
}

std::vector<JobRecord> JobStore::list(const JobQuery& wanted) const {
    std::vector<JobRecord> jobs;
    database_.read([&](SQLite::Database& database) {
        SQLite::Statement query(database,
                                fmt::format("SELECT {} FROM job WHERE ordinal < ?{} "
                                            "ORDER BY ordinal DESC LIMIT ?",
                                            kColumns, wanted.state ? " AND state = ?" : ""));
        int parameter = 1;
        query.bind(parameter++, wanted.below_ordinal.value_or(INT64_MAX));
        if (wanted.state) {
            query.bind(parameter++, std::string(to_string(*wanted.state)));
        }
        query.bind(parameter, wanted.limit);
        while (query.executeStep()) {
            jobs.push_back(job_from(query));
            add_sheets_and_cuts(database, jobs.back());
        }
    });
    return jobs;
}

std::optional<JobRecord> JobStore::claim() {
    std::optional<JobRecord> job;
    database_.write([&](SQLite::Database& database) {
        SQLite::Statement query(
            database, "SELECT id FROM job WHERE state = 'queued' ORDER BY ordinal LIMIT 1");
        if (!query.executeStep()) {
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

bool JobStore::finish(const std::string& id, const ComputedJob& result) {
    bool moved = false;
    database_.write([&](SQLite::Database& database) {
        moved = move_job(database, id, JobState::Computing, JobState::Ready);
        if (moved) {
            store_result(database, id, result);
        }
    });
    return moved;
}

bool JobStore::fail(const std::string& id, const JobFailure& failure) {
    bool moved = false;
    database_.write([&](SQLite::Database& database) {
        moved = move_job(database, id, JobState::Computing, JobState::Failed);
        if (moved) {
            set_failure(database, id, failure);
        }
    });
    return moved;
}

bool JobStore::requeue(const std::string& id) {
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

bool JobStore::cancel(const std::string& id) {
    bool moved = false;
    database_.write([&](SQLite::Database& database) {
        moved = move_job(database, id, JobState::Queued, JobState::Cancelled) ||
                move_job(database, id, JobState::Computing, JobState::Cancelled);
    });
    return moved;
}

Removal JobStore::remove(const std::string& id) {
    Removal removal = Removal::NotThere;
    database_.write([&](SQLite::Database& database) {
        const auto job = find_job(database, id);
        if (!job) {
            return;
        }
        const bool unfinished = job->state == JobState::Queued || job->state == JobState::Computing;
        if (unfinished || has_open_cut(database, id)) {
            removal = Removal::StillInUse;
            return;
        }
        SQLite::Statement erase(database, "DELETE FROM job WHERE id = ?");
        erase.bind(1, id);
        erase.exec();
        tell(database, id, "removed");
        removal = Removal::Removed;
    });
    return removal;
}

std::int64_t JobStore::count(JobState state) const {
    std::int64_t counted = 0;
    database_.read([&](SQLite::Database& database) {
        SQLite::Statement query(database, "SELECT count(*) FROM job WHERE state = ?");
        query.bind(1, std::string(to_string(state)));
        counted = query.executeStep() ? query.getColumn(0).getInt64() : 0;
    });
    return counted;
}

void JobStore::recover() {
    database_.write([](SQLite::Database& database) {
        std::vector<std::pair<std::string, int>> cut_short;
        SQLite::Statement query(database, "SELECT id, attempt FROM job WHERE state = 'computing'");
        while (query.executeStep()) {
            cut_short.emplace_back(query.getColumn(0).getString(), query.getColumn(1).getInt());
        }
        for (const auto& [id, attempt] : cut_short) {
            if (attempt < kMostAttempts) {
                move_job(database, id, JobState::Computing, JobState::Queued);
                continue;
            }
            move_job(database, id, JobState::Computing, JobState::Failed);
            set_failure(database, id,
                        {"crashed", "poison-job",
                         fmt::format("the daemon died {} times while computing it", attempt)});
        }
    });
}

}  // namespace leafcutter::server
