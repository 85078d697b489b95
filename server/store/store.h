// Everything the daemon remembers, in one folder: rows in leafcutter.db, files in blobs/, copies of
// the rows in backups/.

#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "server/store/blobs.h"
#include "server/store/engine.h"
#include "server/store/state_dir.h"

namespace leafcutter::server {

class Store {
public:
    // Locks the folder, opens, migrates and recovers. `after_commit` is called by the engine's
    // thread and must not wait. Throws StateDirUnusable, DatabaseUnusable.
    Store(const std::filesystem::path& path, std::function<void()> after_commit);

    const StateDir folder;

private:
    std::string notice_;  // Filled while engine_ is opened.
    bool restored_ = false;
    const std::unique_ptr<Engine> engine_;

public:
    const Blobs blobs;
    JobStore& jobs;
    CutStore& cuts;
    DeviceStore& devices;
    StockStore& stock;
    NamedRecords& materials;
    NamedRecords& presets;
    Settings& settings;
    EventLog& events;
    AccountStore& accounts;
    WebhookStore& webhooks;
    std::vector<std::string> interrupted_devices;  // Whose cut a dead daemon left in mid-beam.

    // Why it takes no changes; empty: it does.
    std::string trouble() const { return engine_->trouble(); }

    // What people have to know of how it was opened; empty: nothing.
    const std::string& notice() const { return notice_; }

    QueueAges queue_ages() const { return engine_->queue_ages(); }
    const LatencyHistogram& commit_latency() const { return engine_->commit_latency(); }

    // What is wrong with the rows; empty: nothing. Slow, beside the work.
    std::string check() const { return engine_->check(); }

    // The rows as they are now, as a file of backups(), of which the newest `kept` stay. Returns
    // its name. Throws StoreError.
    std::string back_up(std::size_t kept) const;
    // Newest first: names and bytes.
    std::vector<std::pair<std::string, std::int64_t>> list_backups() const;
    std::filesystem::path backups() const { return folder.path() / "backups"; }

    // Removes files that nobody names and that are older than a day. Returns how many.
    std::size_t collect_garbage() const;

private:
    std::unique_ptr<Engine> open_engine(std::function<void()> after_commit);
};

}  // namespace leafcutter::server
