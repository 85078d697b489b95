// The daemon: owns the store, the runners, the event hub and the HTTP edge, and takes them down in
// order.

#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "server/auth/accounts.h"
#include "server/auth/audit_log.h"
#include "server/auth/login_limit.h"
#include "server/config.h"
#include "server/fleet/duties.h"
#include "server/fleet/fleet_node.h"
#include "server/fleet/peers.h"
#include "server/fleet/remote_views.h"
#include "server/http/edge.h"
#include "server/http/event_hub.h"
#include "server/http/http_metrics.h"
#include "server/queue/compute_runner.h"
#include "server/queue/device_fleet.h"
#include "server/queue/housekeeper.h"
#include "server/store/store.h"
#include "server/webhook/webhook.h"

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

    // At once. Throws geometry::Error for pieces that can't be cut again.
    std::function<void(const RecutCall&)> check_recut;

    // At once. Throws geometry::Error.
    std::function<ComputeOutput(const std::string& wish_json,
                                const std::vector<std::string>& material_records)>
        test_card;
};

class App {
public:
    // Everything runs when this returns. Throws StateDirUnusable, DatabaseUnusable, CannotListen,
    // and BadConfig for an address that others reach while nobody has an account.
    App(const Config& config, AppParts parts);

    // Ends as the configuration's stop_policy says; running jobs go back to the queue.
    ~App();
    App(const App&) = delete;
    App& operator=(const App&) = delete;

    Store& store() { return *store_; }
    ComputeRunner& compute() { return *compute_; }
    Accounts& accounts() { return *accounts_; }
    LoginLimit& login_limit() { return login_limit_; }
    AuditLog& audit() { return *audit_; }
    HttpMetrics& http_metrics() { return http_metrics_; }
    const std::vector<std::unique_ptr<Webhook>>& webhooks() const { return webhooks_; }
    DeviceFleet& fleet() { return *fleet_; }
    Housekeeper& housekeeper() { return *housekeeper_; }
    EventHub& hub() { return hub_; }
    const AppParts& parts() const { return parts_; }
    const Peers& peers() const { return peers_; }
    const RemoteViews& remote() const { return remote_; }

    // Another node may have let somebody in just now. False: nothing can have changed.
    bool look_again_for_accounts(const Request& request);

    // Null: a daemon alone.
    const FleetSelf* self() const { return self_.id.empty() ? nullptr : &self_; }
    const std::filesystem::path& burn_logs() const { return burn_logs_; }
    int port() const { return edge_->port(); }

private:
    EventSource event_source();
    void begin_webhooks(const Config& config);
    void after_commit();
    StoreChoice store_choice(const Config& config);
    void begin_fleet(const Config& config);
    void hear(const std::string& text);
    void post(const std::string& type, const std::string& id);

    const AppParts parts_;
    const std::filesystem::path burn_logs_;  // Folder of simulated machines' beam logs.
    FleetSelf self_;
    Duties duties_;
    Peers peers_;
    RemoteViews remote_;
    EventHub hub_;
    std::unique_ptr<Store> store_;
    std::unique_ptr<Accounts> accounts_;
    std::atomic<std::int64_t> accounts_seen_s_{0};  // By the steady clock.
    LoginLimit login_limit_;
    std::unique_ptr<AuditLog> audit_;
    std::unique_ptr<ComputeRunner> compute_;
    std::unique_ptr<DeviceFleet> fleet_;
    const StopPolicy stop_policy_;
    HttpMetrics http_metrics_;
    std::mutex webhooks_mutex_;  // Guards the list and node_ while they are built and taken down.
    std::vector<std::unique_ptr<Webhook>> webhooks_;
    std::unique_ptr<Housekeeper> housekeeper_;
    std::unique_ptr<FleetNode> node_;  // Null for a daemon alone.
    std::unique_ptr<Edge> edge_;
};

}  // namespace leafcutter::server
