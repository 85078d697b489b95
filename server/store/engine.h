// What keeps the daemon's rows. Nothing above knows which engine it is; tests/server/test_store.cpp
// holds each one to the same rules.

#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "server/latency_histogram.h"
#include "server/store/account_store.h"
#include "server/store/cut_store.h"
#include "server/store/device_store.h"
#include "server/store/event_log.h"
#include "server/store/fleet_store.h"
#include "server/store/job_store.h"
#include "server/store/named_records.h"
#include "server/store/settings.h"
#include "server/store/stock_store.h"

namespace leafcutter::server {

// For how long the longest-waiting ones have waited.
struct QueueAges {
    std::int64_t oldest_job_ms = 0;  // Since the oldest queued job was accepted; 0: none waits.
    std::int64_t oldest_cut_ms = 0;  // Likewise of waiting cuts.
};

class SqlDatabase;

class Engine {
public:
    virtual ~Engine() = default;

    virtual JobStore& jobs() = 0;
    virtual CutStore& cuts() = 0;
    virtual DeviceStore& devices() = 0;
    virtual StockStore& stock() = 0;
    virtual NamedRecords& materials() = 0;
    virtual NamedRecords& presets() = 0;
    virtual Settings& settings() = 0;
    virtual EventLog& events() = 0;
    virtual AccountStore& accounts() = 0;
    virtual FleetStore& fleet() = 0;

    // The database below, for copying all of it.
    virtual SqlDatabase& rows() = 0;

    // Tells all processes that share the database something that nobody keeps: of the same key the
    // newest text, and what waits together in the order of its keys.
    virtual void pass_on(const std::string& key, const std::string& text) = 0;

    virtual QueueAges queue_ages() const = 0;

    // How long commits took; null: there are none in this mode.
    virtual const LatencyHistogram* commit_latency() const = 0;

    // Why it takes no changes; empty: it does. Never throws.
    virtual std::string trouble() const = 0;

    // Looks through everything that is kept; what is wrong, or nothing. Slow, beside the work.
    virtual std::string check() const = 0;

    // A copy of all rows as they are now, on disk when this returns; the work goes on meanwhile.
    // Throws StoreError.
    virtual void back_up_to(const std::filesystem::path& file) const = 0;
};

struct OpenedEngine {
    std::unique_ptr<Engine> engine;
    std::string notice;     // What was done to make it usable, for people; empty: nothing.
    bool restored = false;  // It is what a backup holds: older than what happened since.
};

}  // namespace leafcutter::server
