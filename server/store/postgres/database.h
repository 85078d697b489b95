// One PostgreSQL database that many processes share: one connection that writes, any number that
// read, and one that listens and watches. While the server is out of reach every call fails at
// once; the watcher tries to come back.

#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "server/store/postgres/connection.h"
#include "server/store/sql/commit_queue.h"
#include "server/store/sql/session.h"

namespace leafcutter::server {

// What a database tells without being asked; called by its own threads, must not wait.
struct PgHooks {
    std::function<void()> on_change;                          // There may be new events.
    std::function<void(const std::string& text)> on_passing;  // From pass_on(), of anybody.
};

class PgDatabase final : public SqlDatabase {
public:
    // Connects and migrates. Throws DatabaseUnusable if the server doesn't answer for a while, or
    // holds what only a newer Leafcutter knows.
    PgDatabase(std::string uri, PgHooks hooks);
    ~PgDatabase() override;
    PgDatabase(const PgDatabase&) = delete;
    PgDatabase& operator=(const PgDatabase&) = delete;

    using SqlDatabase::write;
    void write(const Work& work, WriteOrder order) override;
    void write_soon(const std::string& key, const Work& work) override;
    void read(const Work& work) const override;

    // Tells every process that listens; lost where nobody does.
    void pass_on(const std::string& key, const std::string& text);

    // Empty: the server answers.
    std::string trouble() const;

    const LatencyHistogram& commit_latency() const { return queue_->latency(); }

private:
    void commit(const CommitQueue::Group& group);
    bool try_commit(const CommitQueue::Group& group);
    void watch(const std::stop_token& stop);
    void listen(const std::stop_token& stop);
    void tell(const std::vector<PgNotice>& notices);
    void note_lost(const char* why) const;
    void note_back();
    void check_reachable() const;
    std::unique_ptr<PgConnection> take_reader() const;

    const std::string uri_;
    const PgHooks hooks_;
    std::string where_;

    mutable std::mutex mutex_;  // Guards the members below.
    mutable std::vector<std::unique_ptr<PgConnection>> idle_readers_;
    mutable std::string trouble_;

    std::unique_ptr<PgConnection> writer_;  // Of the queue's thread alone.
    std::unique_ptr<CommitQueue> queue_;
    std::jthread watcher_;  // Last: it uses everything above.
};

}  // namespace leafcutter::server
