// One SQLite file: one writer, any number of readers that never wait for it. Nobody else may open
// the file while the daemon runs.

#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "server/store/sqlite/writer.h"

namespace leafcutter::server {

class Database {
public:
    // For reading and writing: `after_commit` is called by the writer's thread and must not wait.
    Database(std::filesystem::path file, std::function<void()> after_commit);

    // For reading alone, because of `trouble`.
    Database(std::filesystem::path file, std::string trouble);

    ~Database();
    Database(const Database&) = delete;
    Database& operator=(const Database&) = delete;

    // Returns when `work` is on disk; throws what it threw, with nothing of it done. Throws
    // StoreError.
    void write(const std::function<void(SQLite::Database&)>& work);

    // Runs `work` on a read-only connection, in one consistent view. Throws StoreError.
    void read(const std::function<void(SQLite::Database&)>& work) const;

    // Why nothing is written any more; empty: it is.
    std::string trouble() const;

    // Reading showed that the file is damaged: nothing is written to it any more.
    void note_damage(const std::string& what);

    const std::filesystem::path& file() const { return file_; }
    // Of every group's commit, sync included.
    const LatencyHistogram& commit_latency() const;

private:
    std::unique_ptr<SQLite::Database> take_reader() const;

    const std::filesystem::path file_;
    const std::string trouble_;  // From the start.
    const LatencyHistogram no_commits_;
    std::unique_ptr<Writer> writer_;
    mutable std::mutex mutex_;  // Guards idle_readers_.
    mutable std::vector<std::unique_ptr<SQLite::Database>> idle_readers_;
};

// A connection that only reads and never checkpoints. Throws SQLite::Exception.
std::unique_ptr<SQLite::Database> open_reader(const std::filesystem::path& file);

}  // namespace leafcutter::server
