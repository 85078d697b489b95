#include "server/store/sql/job_rows.h"

#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "server/store/ids.h"
#include "server/store/sql/events.h"
#include "server/store/sql/session.h"

namespace leafcutter::server {

const char* const kSelectJob =
    "SELECT ordinal, id, name, state, version, created_ms, updated_ms, file_name, file_bytes, "
    "file_sha256, params, attempt, error_kind, error_code, error_detail, summary, recut_of, "
    "priority, retries, retry_cause, owner, fence, lease_until_ms, recut FROM job ";

JobRecord job_from(SqlStatement& row) {
    JobRecord job;
    job.ordinal = row.column(0).int64();
    job.id = row.column(1).text();
    job.name = row.column(2).text();
    job.state = job_state_named(row.column(3).text()).value_or(JobState::Failed);
    job.version = row.column(4).int64();
    job.created_ms = row.column(5).int64();
    job.updated_ms = row.column(6).int64();
    job.file = {row.column(7).text(), row.column(8).int64(), row.column(9).text()};
    job.params_json = row.column(10).text();
    job.attempt = row.column(11).integer();
    if (!row.column(12).is_null()) {
        job.failure = {row.column(12).text(), row.column(13).text(), row.column(14).text()};
    }
    if (!row.column(15).is_null()) {
        job.summary_json = row.column(15).text();
    }
    job.recut_of = row.column(16).text();
    job.priority = row.column(17).integer();
    job.retries = row.column(18).integer();
    job.retry_cause = row.column(19).text();
    job.owner = row.column(20).text();
    job.fence = row.column(21).int64();
    job.lease_until_ms = row.column(22).int64();
    job.recut_json = row.column(23).text();
    return job;
}

JobParts::JobParts(SqlSession& session)
    : sheets_(std::make_unique<SqlStatement>(
          session,
          "SELECT number, material, program_sha256, estimated_s, cut, width_mm, height_mm, stock, "
          "offcut FROM sheet WHERE job = ? ORDER BY number")),
      cuts_(std::make_unique<SqlStatement>(
          session, "SELECT id, state FROM cut WHERE job = ? ORDER BY ordinal")) {}

JobParts::~JobParts() = default;

void JobParts::add_to(JobRecord& job) {
    sheets_->reset();
    sheets_->bind(1, job.id);
    while (sheets_->step()) {
        SheetRecord sheet;
        sheet.number = sheets_->column(0).integer();
        sheet.material = sheets_->column(1).text();
        sheet.program_sha256 = sheets_->column(2).text();
        sheet.estimated_s = sheets_->column(3).real();
        sheet.cut = sheets_->column(4).integer() != 0;
        sheet.size_mm = {sheets_->column(5).real(), sheets_->column(6).real()};
        sheet.stock = sheets_->column(7).text();
        sheet.offcut_json = sheets_->column(8).text();
        job.sheets.push_back(std::move(sheet));
    }
    cuts_->reset();
    cuts_->bind(1, job.id);
    while (cuts_->step()) {
        job.cuts.push_back(cuts_->column(0).text());
        const auto state = cut_state_named(cuts_->column(1).text());
        job.has_open_cut = job.has_open_cut || !is_final(state.value_or(CutState::Cutting));
    }
}

std::optional<JobRecord> find_job(SqlSession& session, const std::string& id) {
    SqlStatement query(session, fmt::format("{} WHERE id = ?", kSelectJob));
    query.bind(1, id);
    if (!query.step()) {
        return std::nullopt;
    }
    JobRecord job = job_from(query);
    JobParts(session).add_to(job);
    return job;
}

void tell_job(SqlSession& session, const std::string& job, std::string note) {
    EventRecord event;
    event.type = "job";
    event.subject = job;
    event.job = job;
    event.note = std::move(note);
    append_event(session, event);
}

void tell_queue(SqlSession& session, std::string note) {
    EventRecord event;
    event.type = "queue";
    event.subject = "queue";
    event.note = std::move(note);
    append_event(session, event);
}

std::string insert_job(SqlSession& session, const NewJob& job, JobState state) {
    std::string id = new_id("j_");
    SqlStatement insert(session,
                        "INSERT INTO job(id, name, created_ms, updated_ms, file_name, "
                        "file_bytes, file_sha256, params, state, recut_of, recut) "
                        "VALUES(?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
    const std::int64_t now = session.now_ms();
    insert.bind(1, id);
    insert.bind(2, job.name);
    insert.bind(3, now);
    insert.bind(4, now);
    insert.bind(5, job.file.name);
    insert.bind(6, job.file.bytes);
    insert.bind(7, job.file.sha256);
    insert.bind(8, job.params_json);
    insert.bind(9, std::string(to_string(state)));
    insert.bind(10, job.recut_of);
    insert.bind(11, job.recut_json);
    insert.run();
    SqlStatement place(session, "UPDATE job SET place = ordinal * ? WHERE id = ?");
    place.bind(1, kPlaceGap);
    place.bind(2, id);
    place.run();
    tell_job(session, id, std::string(to_string(state)));
    return id;
}

void set_failure(SqlSession& session, const std::string& id, const JobFailure& failure) {
    SqlStatement update(
        session, "UPDATE job SET error_kind = ?, error_code = ?, error_detail = ? WHERE id = ?");
    update.bind(1, failure.kind);
    update.bind(2, failure.code);
    update.bind(3, failure.detail);
    update.bind(4, id);
    update.run();
}

void store_result(SqlSession& session, const std::string& id, const ComputedJob& result) {
    SqlStatement summary(session, "UPDATE job SET summary = ? WHERE id = ?");
    summary.bind(1, result.summary_json);
    summary.bind(2, id);
    summary.run();
    SqlStatement artifact(session,
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
        artifact.run();
        artifact.reset();
    }
    SqlStatement sheet(session,
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
        sheet.run();
        sheet.reset();
    }
}

void remove_job(SqlSession& session, const std::string& id) {
    SqlStatement erase(session, "DELETE FROM job WHERE id = ?");
    erase.bind(1, id);
    erase.run();
    tell_job(session, id, "removed");
}

namespace {

bool change_state(SqlSession& session, const JobClaim& job, JobState from, JobState to) {
    if (!may_follow(from, to)) {
        throw std::logic_error(
            fmt::format("a job never goes from {} to {}", to_string(from), to_string(to)));
    }
    SqlStatement update(session, fmt::format("UPDATE job SET state = ?, version = version + 1, "
                                             "updated_ms = ? WHERE id = ? AND state = ?{}",
                                             job.fence ? " AND fence = ?" : ""));
    update.bind(1, to_string(to));
    update.bind(2, session.now_ms());
    update.bind(3, job.id);
    update.bind(4, to_string(from));
    if (job.fence) {
        update.bind(5, *job.fence);
    }
    if (update.run() == 0) {
        return false;
    }
    tell_job(session, job.id, fmt::format("{} -> {}", to_string(from), to_string(to)));
    return true;
}

}  // namespace

bool move_job(SqlSession& session, const std::string& id, JobState from, JobState to) {
    return change_state(session, {id}, from, to);
}

bool settle_job(SqlSession& session, const JobClaim& job, JobState to) {
    return change_state(session, job, JobState::Computing, to);
}

bool give_back(SqlSession& session, const JobRecord& job, const std::string& how) {
    if (job.attempt < JobStore::kMostAttempts) {
        return move_job(session, job.id, JobState::Computing, JobState::Queued);
    }
    if (!move_job(session, job.id, JobState::Computing, JobState::Failed)) {
        return false;
    }
    set_failure(session, job.id,
                {"crashed", "poison-job",
                 fmt::format("it was tried {} times; the last time: {}", job.attempt, how)});
    return true;
}

}  // namespace leafcutter::server
