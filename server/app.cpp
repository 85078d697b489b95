#include "server/app.h"

#include <algorithm>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "server/http/api/views.h"
#include "server/http/host_names.h"
#include "server/http/router.h"

namespace leafcutter::server {

namespace {

EdgeOptions edge_options(const Config& config) {
    EdgeOptions options;
    options.address = config.listen.address;
    options.port = config.listen.port;
    options.workers = config.http_workers;
    std::vector<std::string>& hosts = options.rules.hosts;
    const std::vector<std::string> own = own_host_names(config.listen.address);
    hosts.insert(hosts.end(), own.begin(), own.end());
    hosts.insert(hosts.end(), config.hosts.begin(), config.hosts.end());
    options.rules.trusted_proxies = config.trusted_proxies;
    return options;
}

void check_exposure(const Config& config, const Accounts& accounts) {
    if (!accounts.empty()) {
        return;
    }
    const std::string cure =
        "add the first with `leafcutter user add NAME`, or listen on 127.0.0.1";
    if (!is_loopback(config.listen.address)) {
        throw BadConfig(fmt::format(
            "listen: {} is not on the loopback interface, and nobody has an account: {}",
            config.listen.address, cure));
    }
    if (!config.trusted_proxies.empty()) {
        throw BadConfig(fmt::format(
            "trusted_proxies: a proxy lets others in, and nobody has an account: {}", cure));
    }
}

ComputeOptions compute_options(const Config& config) {
    const unsigned cores = std::max(1U, std::thread::hardware_concurrency());
    return {config.compute_workers, config.threads_per_job == 0 ? cores : config.threads_per_job};
}

}  // namespace

App::App(const Config& config, AppParts parts)
    : parts_(std::move(parts)),
      burn_logs_(std::filesystem::absolute(config.state) / "burns"),
      hub_(event_source()),
      stop_policy_(config.stop_policy) {
    store_ = std::make_unique<Store>(config.state, [this] { after_commit(); });
    std::filesystem::create_directories(burn_logs_);
    accounts_ = std::make_unique<Accounts>(store_->accounts);
    check_exposure(config, *accounts_);
    audit_ = std::make_unique<AuditLog>(store_->accounts);
    // Before any machine is touched: another daemon may have them.
    edge_ = std::make_unique<Edge>(
        edge_options(config), [this](Request& request) { return answer(*this, request); }, hub_);
    if (store_->trouble().empty()) {
        for (const DeviceRecord& device : config.devices) {
            store_->devices.put(device);
        }
    }
    compute_ =
        std::make_unique<ComputeRunner>(*store_, parts_.compute, compute_options(config),
                                        [this](const std::string& job) { hub_.post("job", job); });
    fleet_ = std::make_unique<DeviceFleet>(
        *store_,
        DeviceHooks{parts_.open_device,
                    [this](const std::string& device) { hub_.post("device", device); },
                    [this](const std::string& cut) { hub_.post("cut", cut); }, config.stop_policy});
    begin_webhooks(config);
    housekeeper_ = std::make_unique<Housekeeper>(*store_);
    hub_.start();
    edge_->start();
}

App::~App() {
    if (stop_policy_ == StopPolicy::Finish) {
        fleet_->finish_sheets();  // With the edge open: somebody may have to press stop.
    }
    edge_.reset();
    fleet_->stop_all();
    hub_.stop();
    housekeeper_.reset();  // From here to the webhooks: all that still writes to the store.
    compute_.reset();
    audit_.reset();
    std::vector<std::unique_ptr<Webhook>> webhooks;
    const std::scoped_lock lock(webhooks_mutex_);
    webhooks.swap(webhooks_);
}

void App::begin_webhooks(const Config& config) {
    if (!store_->trouble().empty()) {
        return;  // Nothing happens that could be told, and no place in the log could be kept.
    }
    for (const WebhookConfig& webhook : config.webhooks) {
        auto begun = std::make_unique<Webhook>(webhook, store_->events, store_->settings);
        const std::scoped_lock lock(webhooks_mutex_);
        webhooks_.push_back(std::move(begun));
    }
}

void App::after_commit() {
    hub_.wake();
    const std::scoped_lock lock(webhooks_mutex_);
    for (const auto& webhook : webhooks_) {
        webhook->wake();
    }
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
    source.may_listen = [this](const Caller& caller) { return accounts_->still_admits(caller); };
    source.snapshot = [this](std::int64_t seq, const std::optional<std::string>& job) {
        return snapshot_event(*this, seq, job);
    };
    return source;
}

}  // namespace leafcutter::server
