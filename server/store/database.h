// One SQLite file: one writer, any number of readers that never wait for it. Nobody else may open
// the file while the daemon runs.

#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <vector>

#include "server/store/writer.h"

namespace leafcutter::server {

class Database {
public:
    // `after_commit` is called by the writer's thread and must not wait. Throws DatabaseUnusable.
    Database(std::filesystem::path file, std::function<void()> after_commit);
    ~Database();
    Database(const Database&) = delete;
    Database& operator=(const Database&) = delete;

    // Returns when `work` is on disk; throws what it threw, with nothing of it done.
    void write(const std::function<void(SQLite::Database&)>& work) { writer_.run(work); }

    // Runs `work` on a read-only connection, in one consistent view.
    void read(const std::function<void(SQLite::Database&)>& work) const;

    bool is_healthy() const { return writer_.is_healthy(); }
    const LatencyHistogram& commit_latency() const { return writer_.commit_latency(); }

private:
    std::unique_ptr<SQLite::Database> take_reader() const;

    std::filesystem::path file_;
    Writer writer_;
    mutable std::mutex mutex_;  // Guards idle_readers_.
    mutable std::vector<std::unique_ptr<SQLite::Database>> idle_readers_;
};

}  // namespace leafcutter::server
