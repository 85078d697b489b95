// The rows of jobs, as the store's parts read and change them.

#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "server/store/job_store.h"

namespace leafcutter::server {

class SqlSession;
class SqlStatement;

// The columns that job_from() takes, up to "FROM job ".
inline constexpr const char* kSelectJob =
    "SELECT ordinal, id, name, state, version, created_ms, updated_ms, file_name, file_bytes, "
    "file_sha256, params, attempt, error_kind, error_code, error_detail, summary, recut_of, "
    "priority, retries, retry_cause, owner, fence, lease_until_ms, recut FROM job ";

// Between the places of two neighbours in the queue, at first: room to put others between them.
constexpr std::int64_t kPlaceGap = 1 << 20;

JobRecord job_from(SqlStatement& row);
std::optional<JobRecord> find_job(SqlSession& session, const std::string& id);

// Reads what other tables hold of a job; prepared once for many.
class JobParts {
public:
    explicit JobParts(SqlSession& session);
    ~JobParts();
    JobParts(const JobParts&) = delete;
    JobParts& operator=(const JobParts&) = delete;

    void add_to(JobRecord& job);

private:
    std::unique_ptr<SqlStatement> sheets_;
    std::unique_ptr<SqlStatement> cuts_;
};

void tell_job(SqlSession& session, const std::string& job, std::string note);

// Of the queue itself.
void tell_queue(SqlSession& session, std::string note);

// At the queue's end. Returns its id.
std::string insert_job(SqlSession& session, const NewJob& job, JobState state);

void set_failure(SqlSession& session, const std::string& id, const JobFailure& failure);
void store_result(SqlSession& session, const std::string& id, const ComputedJob& result);

// With everything of it, and an event.
void remove_job(SqlSession& session, const std::string& id);

// The one place where a job changes its state. False if the job is not in `from`. Throws
// std::logic_error if the table of states forbids the move.
bool move_job(SqlSession& session, const std::string& id, JobState from, JobState to);

// Likewise from computing, by who claimed it.
bool settle_job(SqlSession& session, const JobClaim& job, JobState to);

// From computing: to be tried again, or never more, for what broke several times would break again.
bool give_back(SqlSession& session, const JobRecord& job, const std::string& how);

}  // namespace leafcutter::server
