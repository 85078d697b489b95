#include "server/app.h"

#include <algorithm>
#include <thread>
#include <utility>

#include "server/http/api/views.h"
#include "server/http/router.h"

namespace leafcutter::server {

namespace {

EdgeOptions edge_options(const Config& config) {
    EdgeOptions options;
    options.address = config.listen.address;
    options.port = config.listen.port;
    options.workers = config.http_workers;
    options.rules.hosts.insert(options.rules.hosts.end(), config.hosts.begin(), config.hosts.end());
    return options;
}

ComputeOptions compute_options(const Config& config) {
    const unsigned cores = std::max(1U, std::thread::hardware_concurrency());
    return {config.compute_workers, config.threads_per_job == 0 ? cores : config.threads_per_job};
}

}  // namespace

App::App(const Config& config, AppParts parts)
    : parts_(std::move(parts)),
      burn_logs_(std::filesystem::absolute(config.state) / "burns"),
      hub_(event_source()) {
    store_ = std::make_unique<Store>(config.state, [this] { hub_.wake(); });
    std::filesystem::create_directories(burn_logs_);
    // Before any machine is touched: another daemon may have them.
    edge_ = std::make_unique<Edge>(
        edge_options(config), [this](Request& request) { return route(*this, request); }, hub_);
    if (store_->trouble().empty()) {
        for (const DeviceRecord& device : config.devices) {
            store_->devices.put(device);
        }
    }
    compute_ =
        std::make_unique<ComputeRunner>(*store_, parts_.compute, compute_options(config),
                                        [this](const std::string& job) { hub_.post("job", job); });
    fleet_ = std::make_unique<DeviceFleet>(
        *store_, DeviceHooks{parts_.open_device,
                             [this](const std::string& device) { hub_.post("device", device); },
                             [this](const std::string& cut) { hub_.post("cut", cut); }});
    housekeeper_ = std::make_unique<Housekeeper>(*store_);
    hub_.start();
    edge_->start();
}

App::~App() {
    edge_.reset();
    fleet_->stop_all();
    hub_.stop();
}

EventSource App::event_source() {
    EventSource source;
    source.last_seq = [this] { return store_->events.last_seq(); };
    source.stored_after = [this](std::int64_t seq, int limit) {
        return stored_events(*this, seq, limit);
    };
    source.passing = [this](const std::string& type, const std::string& id) {
        return passing_event(*this, type, id);
    };
    source.snapshot = [this](std::int64_t seq, const std::optional<std::string>& job) {
        return snapshot_event(*this, seq, job);
    };
    return source;
}

}  // namespace leafcutter::server
