// One SQLite file: one writer, any number of readers that never wait for it. Nobody else may open
// the file while the daemon runs.

#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "server/store/sql/session.h"
#include "server/store/sqlite/writer.h"

namespace leafcutter::server {

class Database final : public SqlDatabase {
public:
    // For reading and writing: `after_commit` is called by the writer's thread and must not wait.
    Database(std::filesystem::path file, std::function<void()> after_commit);

    // For reading alone, because of `trouble`.
    Database(std::filesystem::path file, std::string trouble);

    ~Database() override;
    Database(const Database&) = delete;
    Database& operator=(const Database&) = delete;

    using SqlDatabase::write;
    void write(const Work& work, WriteOrder order) override;
    void write_soon(const std::string& key, const Work& work) override;
    void read(const Work& work) const override;

    // Why nothing is written any more; empty: it is.
    std::string trouble() const;

    // Reading showed that the file is damaged: nothing is written to it any more.
    void note_damage(const std::string& what);

    const std::filesystem::path& file() const { return file_; }
    const LatencyHistogram* commit_latency() const {
        return writer_ ? &writer_->commit_latency() : nullptr;
    }

private:
    std::unique_ptr<SQLite::Database> take_reader() const;

    const std::filesystem::path file_;
    const std::string trouble_;  // From the start.
    std::unique_ptr<Writer> writer_;
    mutable std::mutex mutex_;  // Guards idle_readers_.
    mutable std::vector<std::unique_ptr<SQLite::Database>> idle_readers_;
};

// A connection that only reads and never checkpoints. Throws SQLite::Exception.
std::unique_ptr<SQLite::Database> open_reader(const std::filesystem::path& file);

}  // namespace leafcutter::server
