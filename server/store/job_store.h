// Jobs: accepted, claimed by a compute worker, finished, failed, cancelled, removed. Every change
// is a compare-and-set on the state, on disk when the call returns, with its event.

#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "server/store/records.h"

namespace leafcutter::server {

struct NewJob {
    std::string name;
    SourceFile file;
    std::string params_json;
    std::string recut_of = {};  // As JobRecord says, like the next.
    std::string recut_json = {};
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
    bool dead_letters = false;  // Only those that gave up on their own: see JobStore::crashed().
    int limit = 50;
    std::optional<std::int64_t> below_ordinal;  // Where the page before ended.
};

// What a finished computation leaves behind; the artifacts' blobs exist already.
struct ComputedJob {
    std::string summary_json;
    std::vector<ArtifactRecord> artifacts;
    std::vector<SheetRecord> sheets;
};

// A job in the hands of somebody who computes it.
struct JobClaim {
    std::string id;
    std::optional<std::int64_t> fence = {};  // As JobRecord::fence says; none: whoever has it.
};

enum class Removal { Removed, NotThere, StillInUse };

// How many jobs wait, run and gave up.
struct QueueCounts {
    std::int64_t queued = 0;
    std::int64_t computing = 0;
    std::int64_t dead_letters = 0;
};

class JobStore {
public:
    static constexpr int kMostAttempts = 3;
    static constexpr int kMostPriority = 1000;  // And as far below zero.

    virtual ~JobStore() = default;

    // Throws KeyReused.
    virtual AddedJob add(const NewJob& job, const std::optional<IdempotencyKey>& key) = 0;

    // A job that never waits: it is computed already.
    virtual JobRecord add_ready(const NewJob& job, const ComputedJob& result) = 0;

    virtual std::optional<JobRecord> find(const std::string& id) const = 0;

    // Newest first.
    virtual std::vector<JobRecord> list(const JobQuery& query) const = 0;

    // The first `limit` of those that wait, in the order in which they will be claimed.
    virtual std::vector<JobRecord> queue(int limit) const = 0;
    virtual QueueCounts queue_counts() const = 0;

    // The first job of the queue becomes computing: that of the highest priority, and of these the
    // one in front. Nothing if none is queued, or the queue is paused.
    virtual std::optional<JobRecord> claim() = 0;

    // The same among those that only cut pieces again: short work that somebody waits for.
    virtual std::optional<JobRecord> claim_recut() = 0;

    // A paused queue lets nobody claim; what is computing goes on. The reason is for people.
    virtual void pause_queue(const std::string& reason) = 0;
    virtual void resume_queue() = 0;

    // Why the queue is paused; nothing: it is not.
    virtual std::optional<std::string> queue_pause() const = 0;

    // Of a job in any state; it goes behind all others of its new priority. False: not there.
    virtual bool set_priority(const std::string& id, int priority) = 0;

    // To that place of the queue, from 1, and to the priority of the job that stood there; past the
    // end means last. False if the job is not queued.
    virtual bool move_to(const std::string& id, int position) = 0;

    // False: not there.
    virtual bool rename(const std::string& id, const std::string& name) = 0;

    // From failed or cancelled back to the queue's end, with its attempts forgotten. `cause` says
    // what has changed since. False if it is in neither state.
    virtual bool retry(const std::string& id, const std::string& cause) = 0;

    // From computing. False: it is no longer computing (cancelled meanwhile), or somebody else has
    // claimed it since; nothing was done.
    virtual bool finish(const JobClaim& job, const ComputedJob& result) = 0;
    virtual bool fail(const JobClaim& job, const JobFailure& failure) = 0;
    virtual bool requeue(const JobClaim& job) = 0;

    // The computation broke the process that ran it. Back to the queue, or after kMostAttempts
    // failed for good ("poison-job"): a dead letter. False: it is no longer computing.
    virtual bool crashed(const JobClaim& job, const std::string& how) = 0;

    // From queued or computing.
    virtual bool cancel(const std::string& id) = 0;

    // Any job that is neither queued nor computing and has no cut under way.
    virtual Removal remove(const std::string& id) = 0;

    virtual std::vector<ArtifactRecord> artifacts(const std::string& job) const = 0;
    virtual std::optional<ArtifactRecord> artifact(const std::string& job,
                                                   const std::string& path) const = 0;
    virtual bool refers_to_blob(const std::string& sha256) const = 0;

    // Of jobs that ended longer ago than `age` and have no cut under way, at most `limit`. Returns
    // how many: those removed with all their rows, or those whose package was let go.
    virtual int remove_finished(std::chrono::milliseconds age, int limit) = 0;
    virtual int drop_packages(std::chrono::milliseconds age, int limit) = 0;

    virtual std::int64_t count(JobState state) const = 0;

    // At start: what this node was computing goes back to the queue, or fails after kMostAttempts.
    virtual void recover() = 0;
};

}  // namespace leafcutter::server
