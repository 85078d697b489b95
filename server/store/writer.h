// The only connection that writes, and the only one that checkpoints, on a thread of its own. What
// waits is committed together: one sync to disk carries many requests.

#pragma once

#include <condition_variable>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <stop_token>
#include <thread>
#include <vector>

#include "server/latency_histogram.h"

namespace SQLite {  // NOLINT(readability-identifier-naming): theirs
class Database;
}

namespace leafcutter::server {

class Writer {
public:
    // Opens or creates the database and brings its schema up to date. `after_commit` is called by
    // the writer's thread after every group.
    Writer(const std::filesystem::path& file, std::function<void()> after_commit);
    ~Writer();
    Writer(const Writer&) = delete;
    Writer& operator=(const Writer&) = delete;

    // Runs `work` inside a transaction and returns when it is on disk. Work that throws is rolled
    // back alone, and what it threw is thrown here.
    void run(const std::function<void(SQLite::Database&)>& work);

    // False after the disk failed a commit: the database takes nothing more.
    bool is_healthy() const;

    // Of every group's commit, sync included.
    const LatencyHistogram& commit_latency() const { return commit_latency_; }

private:
    struct Request;

    void loop(const std::stop_token& stop);
    void commit_group(const std::vector<Request*>& group);
    void checkpoint_if_due();

    std::unique_ptr<SQLite::Database> database_;  // Of the thread alone, once it runs.
    std::function<void()> after_commit_;
    int groups_since_checkpoint_ = 0;
    LatencyHistogram commit_latency_;

    mutable std::mutex mutex_;  // Guards the members below.
    std::condition_variable_any arrived_;
    std::condition_variable finished_;
    std::vector<Request*> waiting_;
    bool healthy_ = true;
    bool closed_ = false;

    std::jthread thread_;  // Last: it uses everything above.
};

}  // namespace leafcutter::server
