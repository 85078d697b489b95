#include "server/store/sqlite/job_rows.h"

#include <stdexcept>
#include <utility>

#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>

#include "server/store/ids.h"
#include "server/store/sqlite/events.h"

namespace leafcutter::server {

const char* const kSelectJob =
    "SELECT ordinal, id, name, state, version, created_ms, updated_ms, file_name, file_bytes, "
    "file_sha256, params, attempt, error_kind, error_code, error_detail, summary, recut_of, "
    "priority, retries, retry_cause FROM job ";

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
    job.priority = row.getColumn(17).getInt();
    job.retries = row.getColumn(18).getInt();
    job.retry_cause = row.getColumn(19).getString();
    return job;
}

JobParts::JobParts(SQLite::Database& database)
    : sheets_(std::make_unique<SQLite::Statement>(
          database,
          "SELECT number, material, program_sha256, estimated_s, cut, width_mm, height_mm, stock, "
          "offcut FROM sheet WHERE job = ? ORDER BY number")),
      cuts_(std::make_unique<SQLite::Statement>(
          database, "SELECT id, state FROM cut WHERE job = ? ORDER BY ordinal")) {}

JobParts::~JobParts() = default;

void JobParts::add_to(JobRecord& job) {
    sheets_->reset();
    sheets_->bind(1, job.id);
    while (sheets_->executeStep()) {
        SheetRecord sheet;
        sheet.number = sheets_->getColumn(0).getInt();
        sheet.material = sheets_->getColumn(1).getString();
        sheet.program_sha256 = sheets_->getColumn(2).getString();
        sheet.estimated_s = sheets_->getColumn(3).getDouble();
        sheet.cut = sheets_->getColumn(4).getInt() != 0;
        sheet.size_mm = {sheets_->getColumn(5).getDouble(), sheets_->getColumn(6).getDouble()};
        sheet.stock = sheets_->getColumn(7).getString();
        sheet.offcut_json = sheets_->getColumn(8).getString();
        job.sheets.push_back(std::move(sheet));
    }
    cuts_->reset();
    cuts_->bind(1, job.id);
    while (cuts_->executeStep()) {
        job.cuts.push_back(cuts_->getColumn(0).getString());
        const auto state = cut_state_named(cuts_->getColumn(1).getString());
        job.has_open_cut = job.has_open_cut || !is_final(state.value_or(CutState::Cutting));
    }
}

std::optional<JobRecord> find_job(SQLite::Database& database, const std::string& id) {
    SQLite::Statement query(database, fmt::format("{} WHERE id = ?", kSelectJob));
    query.bind(1, id);
    if (!query.executeStep()) {
        return std::nullopt;
    }
    JobRecord job = job_from(query);
    JobParts(database).add_to(job);
    return job;
}

void tell_job(SQLite::Database& database, const std::string& job, std::string note) {
    EventRecord event;
    event.type = "job";
    event.subject = job;
    event.job = job;
    event.note = std::move(note);
    append_event(database, event);
}

void tell_queue(SQLite::Database& database, std::string note) {
    EventRecord event;
    event.type = "queue";
    event.subject = "queue";
    event.note = std::move(note);
    append_event(database, event);
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
    SQLite::Statement place(database, "UPDATE job SET place = ordinal * ? WHERE id = ?");
    place.bind(1, kPlaceGap);
    place.bind(2, id);
    place.exec();
    tell_job(database, id, std::string(to_string(state)));
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
    SQLite::Statement sheet(
        database,
        "INSERT INTO sheet(job, number, material, program_sha256, estimated_s, "
        "width_mm, height_mm, stock, offcut) VALUES(?, ?, ?, ?, ?, ?, ?, ?, ?)");
    for (const SheetRecord& each : result.sheets) {
        sheet.bind(1, id);
        sheet.bind(2, each.number);
        sheet.bind(3, each.material);
        sheet.bind(4, each.program_sha256);
        sheet.bind(5, each.estimated_s);
        sheet.bind(6, each.size_mm[0]);
        sheet.bind(7, each.size_mm[1]);
        sheet.bind(8, each.stock);
        sheet.bind(9, each.offcut_json);
        sheet.exec();
        sheet.reset();
    }
}

void remove_job(SQLite::Database& database, const std::string& id) {
    SQLite::Statement erase(database, "DELETE FROM job WHERE id = ?");
    erase.bind(1, id);
    erase.exec();
    tell_job(database, id, "removed");
}

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
    tell_job(database, id, fmt::format("{} -> {}", to_string(from), to_string(to)));
    return true;
}

}  // namespace leafcutter::server
