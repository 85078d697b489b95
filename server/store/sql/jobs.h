// Jobs in SQL.

#pragma once

#include "server/store/fleet_store.h"
#include "server/store/job_store.h"

namespace leafcutter::server {

class SqlDatabase;

class SqlJobStore final : public JobStore {
public:
    SqlJobStore(SqlDatabase& database, const NodeScope& scope)
        : database_(database), scope_(scope) {}

    AddedJob add(const NewJob& job, const std::optional<IdempotencyKey>& key) override;
    JobRecord add_ready(const NewJob& job, const ComputedJob& result) override;
    std::optional<JobRecord> find(const std::string& id) const override;
    std::vector<JobRecord> list(const JobQuery& query) const override;
    std::vector<JobRecord> queue(int limit) const override;
    QueueCounts queue_counts() const override;
    std::optional<JobRecord> claim() override;
    std::optional<JobRecord> claim_recut() override;
    void pause_queue(const std::string& reason) override;
    void resume_queue() override;
    std::optional<std::string> queue_pause() const override;
    bool set_priority(const std::string& id, int priority) override;
    bool move_to(const std::string& id, int position) override;
    bool rename(const std::string& id, const std::string& name) override;
    bool retry(const std::string& id, const std::string& cause) override;
    bool finish(const JobClaim& job, const ComputedJob& result) override;
    bool fail(const JobClaim& job, const JobFailure& failure) override;
    bool requeue(const JobClaim& job) override;
    bool crashed(const JobClaim& job, const std::string& how) override;
    bool cancel(const std::string& id) override;
    Removal remove(const std::string& id) override;
    std::vector<ArtifactRecord> artifacts(const std::string& job) const override;
    std::optional<ArtifactRecord> artifact(const std::string& job,
                                           const std::string& path) const override;
    bool refers_to_blob(const std::string& sha256) const override;
    int remove_finished(std::chrono::milliseconds age, int limit) override;
    int drop_packages(std::chrono::milliseconds age, int limit) override;
    std::int64_t count(JobState state) const override;
    void recover() override;

private:
    std::optional<JobRecord> claim_first(const char* among);

    SqlDatabase& database_;
    const NodeScope scope_;
};

}  // namespace leafcutter::server
