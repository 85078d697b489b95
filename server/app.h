// The daemon: owns the store, the runners, the event hub and the HTTP edge, and takes them down in
// order.

#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/config.h"
#include "server/http/edge.h"
#include "server/http/event_hub.h"
#include "server/queue/compute_runner.h"
#include "server/queue/device_fleet.h"
#include "server/queue/housekeeper.h"
#include "server/store/store.h"

namespace leafcutter::server {

// Pieces of a finished job that are wanted again.
struct RecutCall {
    std::string job_name;
    std::string wishes_json;
    std::vector<std::string> material_records;
    std::function<std::string(const std::string& path)> read;  // A file of the job's package.
};

// What the daemon is given instead of choosing it, so that tests need neither geometry nor
// machines.
struct AppParts {
    Compute compute;
    std::function<std::unique_ptr<drivers::Device>(std::string_view uri)> open_device;

    // Throws geometry::Error for job parameters that can't be.
    std::function<void(const std::string& params_json)> check_params;

    // Within seconds. Throws geometry::Error.
    std::function<ComputeOutput(const RecutCall&)> recut;
};

class App {
public:
    // Everything runs when this returns. Throws StateDirUnusable, DatabaseUnusable, CannotListen.
    App(const Config& config, AppParts parts);

    // Running cuts are held and cancelled, running jobs go back to the queue.
    ~App();
    App(const App&) = delete;
    App& operator=(const App&) = delete;

    Store& store() { return *store_; }
    ComputeRunner& compute() { return *compute_; }
    DeviceFleet& fleet() { return *fleet_; }
    Housekeeper& housekeeper() { return *housekeeper_; }
    EventHub& hub() { return hub_; }
    const AppParts& parts() const { return parts_; }
    const std::filesystem::path& burn_logs() const { return burn_logs_; }
    int port() const { return edge_->port(); }

private:
    EventSource event_source();

    const AppParts parts_;
    const std::filesystem::path burn_logs_;  // Folder of simulated machines' beam logs.
    EventHub hub_;
    std::unique_ptr<Store> store_;
    std::unique_ptr<ComputeRunner> compute_;
    std::unique_ptr<DeviceFleet> fleet_;
    std::unique_ptr<Housekeeper> housekeeper_;
    std::unique_ptr<Edge> edge_;
};

}  // namespace leafcutter::server
