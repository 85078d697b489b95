// Jobs in SQL.

#pragma once

#include "server/store/job_store.h"

namespace leafcutter::server {

class SqlDatabase;

class SqlJobStore final : public JobStore {
public:
    explicit SqlJobStore(SqlDatabase& database) : database_(database) {}

    AddedJob add(const NewJob& job, const std::optional<IdempotencyKey>& key) override;
    JobRecord add_ready(const NewJob& job,
                        const std::string& recut_of,
                        const ComputedJob& result) override;
    std::optional<JobRecord> find(const std::string& id) const override;
    std::vector<JobRecord> list(const JobQuery& query) const override;
    std::vector<JobRecord> queue(int limit) const override;
    QueueCounts queue_counts() const override;
    std::optional<JobRecord> claim() override;
    void pause_queue(const std::string& reason) override;
    void resume_queue() override;
    std::optional<std::string> queue_pause() const override;
    bool set_priority(const std::string& id, int priority) override;
    bool move_to(const std::string& id, int position) override;
    bool rename(const std::string& id, const std::string& name) override;
    bool retry(const std::string& id, const std::string& cause) override;
    bool finish(const std::string& id, const ComputedJob& result) override;
    bool fail(const std::string& id, const JobFailure& failure) override;
    bool requeue(const std::string& id) override;
    bool crashed(const std::string& id, const std::string& how) override;
    bool cancel(const std::string& id) override;
    Removal remove(const std::string& id) override;
    std::vector<ArtifactRecord> artifacts(const std::string& job) const override;
    std::optional<ArtifactRecord> artifact(const std::string& job,
                                           const std::string& path) const override;
    bool refers_to_blob(const std::string& sha256) const override;
    int remove_finished(std::int64_t before_ms, int limit) override;
    int drop_packages(std::int64_t before_ms, int limit) override;
    std::int64_t count(JobState state) const override;
    void recover() override;

private:
    SqlDatabase& database_;
};

}  // namespace leafcutter::server
