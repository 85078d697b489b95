// Jobs: accepted, claimed by a compute worker, finished, failed, cancelled, removed. Every change
// is a compare-and-set on the state, on disk when the call returns, with its event.

#pragma once

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "server/store/records.h"

namespace SQLite {  // NOLINT(readability-identifier-naming): theirs
class Database;
}

namespace leafcutter::server {

class Database;

struct NewJob {
    std::string name;
    SourceFile file;
    std::string params_json;
};

// What a client said to make a repeated request harmless.
struct IdempotencyKey {
    std::string key;
    std::string request_hash;  // Of everything that makes the request what it is.
};

// The same key was used for a different request.
class KeyReused : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

struct AddedJob {
    JobRecord job;
    bool replayed = false;  // The key was known: this is the job of the first request.
};

struct JobQuery {
    std::optional<JobState> state;
    int limit = 50;
    std::optional<std::int64_t> below_ordinal;  // Where the page before ended.
};

// What a finished computation leaves behind; the artifacts' blobs exist already.
struct ComputedJob {
    std::string summary_json;
    std::vector<ArtifactRecord> artifacts;
    std::vector<SheetRecord> sheets;
};

enum class Removal { Removed, NotThere, StillInUse };

class JobStore {
public:
    static constexpr int kMostAttempts = 3;

    explicit JobStore(Database& database) : database_(database) {}

    // Throws KeyReused.
    AddedJob add(const NewJob& job, const std::optional<IdempotencyKey>& key);

    // A job that never waits: pieces of `recut_of` again, computed already.
    JobRecord add_ready(const NewJob& job, const std::string& recut_of, const ComputedJob& result);

    std::optional<JobRecord> find(const std::string& id) const;

    // Newest first.
    std::vector<JobRecord> list(const JobQuery& query) const;

    // The oldest queued job becomes computing; nothing if none is queued.
    std::optional<JobRecord> claim();

    // From computing. False: it is no longer computing (cancelled meanwhile), nothing was done.
    bool finish(const std::string& id, const ComputedJob& result);
    bool fail(const std::string& id, const JobFailure& failure);
    bool requeue(const std::string& id);

    // From queued or computing.
    bool cancel(const std::string& id);

    // Any job that is neither queued nor computing and has no cut under way.
    Removal remove(const std::string& id);

    std::vector<ArtifactRecord> artifacts(const std::string& job) const;
    std::optional<ArtifactRecord> artifact(const std::string& job, const std::string& path) const;
    bool refers_to_blob(const std::string& sha256) const;
    std::int64_t count(JobState state) const;

    // At start: what was computing goes back to the queue, or fails after kMostAttempts.
    void recover();

private:
    Database& database_;
};

// Within a transaction: throws std::logic_error if the table of states forbids the move; false if
// the job is not in `from`.
bool move_job(SQLite::Database& database, const std::string& id, JobState from, JobState to);

}  // namespace leafcutter::server
