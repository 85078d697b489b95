// The only connection that writes, and the only one that checkpoints, on a thread of its own. What
// waits is committed together: one sync to disk carries many requests.

#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <string>

#include "server/latency_histogram.h"
#include "server/store/sql/commit_queue.h"

namespace SQLite {  // NOLINT(readability-identifier-naming): theirs
class Database;
}

namespace leafcutter::server {

class Writer {
public:
    // Opens the database or creates it, and brings its schema up to date. `after_commit` is called
    // by the writer's thread after every group. Throws DatabaseUnusable, SQLite::Exception.
    Writer(const std::filesystem::path& file, std::function<void()> after_commit);
    ~Writer();
    Writer(const Writer&) = delete;
    Writer& operator=(const Writer&) = delete;

    // Runs `work` inside a transaction and returns when it is on disk. Work that throws is rolled
    // back alone, and what it threw is thrown here; SQLite's errors as StoreError.
    void run(const SqlDatabase::Work& work);

    // Not empty after the disk failed a commit, or after give_up(): nothing more is written.
    std::string trouble() const;
    void give_up(const std::string& what);

    // Of every group's commit, sync included.
    const LatencyHistogram& commit_latency() const { return queue_->latency(); }

private:
    void commit(const CommitQueue::Group& group);
    void after_group();
    void checkpoint_if_due();

    const std::filesystem::path file_;
    std::unique_ptr<SQLite::Database> database_;  // Of the queue's thread alone, once it runs.
    std::function<void()> after_commit_;
    int groups_since_checkpoint_ = 0;

    mutable std::mutex mutex_;  // Guards trouble_.
    std::string trouble_;

    std::unique_ptr<CommitQueue> queue_;  // Last: its thread uses everything above.
};

}  // namespace leafcutter::server
