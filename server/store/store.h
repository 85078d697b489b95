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

// Which rows a store works with, and what of them is its business.
struct StoreChoice {
    std::string uri;  // "postgresql://…", shared with others; empty: SQLite in the folder.
    NodeScope scope;
    bool computes = true;      // Takes jobs up.
    bool has_machines = true;  // Those of its node, or all of a daemon alone.
    bool adopts = false;       // Machines that no node has yet become its own.
    std::function<void(const std::string& text)> on_passing;  // As Engine::pass_on() of anybody.
    Blobs::Others others;
};

class Store {
public:
    // Locks the folder, opens, migrates and recovers. `after_commit` is called by the engine's
    // thread and must not wait. Throws StateDirUnusable, DatabaseUnusable.
    Store(const std::filesystem::path& path,
          std::function<void()> after_commit,
          StoreChoice choice = {});

    const StateDir folder;

private:
    const StoreChoice choice_;
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
    FleetStore& fleet;
    std::vector<std::string> interrupted_devices;  // Whose cut a dead daemon left in mid-beam.

    // The machine hangs on this node.
    bool has_machine(const DeviceRecord& device) const {
        return choice_.has_machines && device.station == choice_.scope.node;
    }

    void pass_on(const std::string& key, const std::string& text) { engine_->pass_on(key, text); }

    // Why it takes no changes; empty: it does.
    std::string trouble() const { return engine_->trouble(); }

    // What people have to know of how it was opened; empty: nothing.
    const std::string& notice() const { return notice_; }

    QueueAges queue_ages() const { return engine_->queue_ages(); }

    // How long commits took; null: there are none in this mode.
    const LatencyHistogram* commit_latency() const { return engine_->commit_latency(); }

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
    void take_up();
};

// The engine of the choice; SQLite's rows and all backups are in the folder. `after_commit` is
// called by a thread of the engine and must not wait. Throws DatabaseUnusable.
OpenedEngine open_engine(const std::filesystem::path& folder,
                         std::function<void()> after_commit,
                         const StoreChoice& choice);

}  // namespace leafcutter::server
