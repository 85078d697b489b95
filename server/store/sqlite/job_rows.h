// The rows of jobs, as the store's parts read and change them.

#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "server/store/job_store.h"

namespace SQLite {  // NOLINT(readability-identifier-naming): theirs
class Database;
class Statement;
}  // namespace SQLite

namespace leafcutter::server {

// The columns that job_from() takes, up to "FROM job ".
extern const char* const kSelectJob;

// Between the places of two neighbours in the queue, at first: room to put others between them.
constexpr std::int64_t kPlaceGap = 1 << 20;

JobRecord job_from(SQLite::Statement& row);
std::optional<JobRecord> find_job(SQLite::Database& database, const std::string& id);

// Reads what other tables hold of a job; prepared once for many.
class JobParts {
public:
    explicit JobParts(SQLite::Database& database);
    ~JobParts();
    JobParts(const JobParts&) = delete;
    JobParts& operator=(const JobParts&) = delete;

    void add_to(JobRecord& job);

private:
    std::unique_ptr<SQLite::Statement> sheets_;
    std::unique_ptr<SQLite::Statement> cuts_;
};

void tell_job(SQLite::Database& database, const std::string& job, std::string note);

// Of the queue itself.
void tell_queue(SQLite::Database& database, std::string note);

// At the queue's end. Returns its id.
std::string insert_job(SQLite::Database& database, const NewJob& job, JobState state);

void set_failure(SQLite::Database& database, const std::string& id, const JobFailure& failure);
void store_result(SQLite::Database& database, const std::string& id, const ComputedJob& result);

// With everything of it, and an event.
void remove_job(SQLite::Database& database, const std::string& id);

// The one place where a job changes its state. False if the job is not in `from`. Throws
// std::logic_error if the table of states forbids the move.
bool move_job(SQLite::Database& database, const std::string& id, JobState from, JobState to);

}  // namespace leafcutter::server
