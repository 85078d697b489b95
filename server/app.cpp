#include "server/app.h"

#include <algorithm>
#include <sys/resource.h>
#include <thread>
#include <utility>

#include <climits>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "server/http/api/views.h"
#include "server/http/host_names.h"
#include "server/http/router.h"
#include "server/store/store_error.h"
#include "server/webhook/post.h"

namespace leafcutter::server {

namespace {

// Files are numbered from below: of those that may be open, the last ones are kept for the store,
// the machines and computations, however many connections come.
void share_files(EdgeOptions& options) {
    constexpr rlim_t kKept = 32;
    constexpr rlim_t kLeast = 16;
    rlimit files{};
    if (::getrlimit(RLIMIT_NOFILE, &files) != 0 || files.rlim_cur <= 2 * kKept) {
        return;
    }
    const rlim_t shared = files.rlim_cur - kKept;
    options.most_fd = static_cast<int>(std::min<rlim_t>(shared, INT_MAX));
    options.most_streams = std::max(kLeast, (shared - kKept) / 4);
    options.parking.connections =
        std::min<std::size_t>(options.parking.connections, std::max(kLeast, (shared - kKept) / 2));
}

EdgeOptions edge_options(const Config& config) {
    EdgeOptions options;
    share_files(options);
    options.address = config.listen.address;
    options.port = config.listen.port;
    options.workers = config.http_workers;
    std::vector<std::string>& hosts = options.rules.hosts;
    const std::vector<std::string> own = own_host_names(config.listen.address);
    hosts.insert(hosts.end(), own.begin(), own.end());
    hosts.insert(hosts.end(), config.hosts.begin(), config.hosts.end());
    if (const auto advertised = target_of(config.advertise)) {
        hosts.push_back(advertised->host);
    }
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

// Two releases next to each other share a database while a fleet is changed over, no more.
void check_releases(const FleetStore& fleet, const FleetSelf& self) {
    for (const NodeRecord& node : fleet.nodes()) {
        const bool lives = node.id != self.id && node.silent_ms < self.lease.count();
        if (lives && !may_work_together(LEAFCUTTER_VERSION, node.version)) {
            throw BadConfig(
                fmt::format("the node {} runs version {}, this is {}: only neighbouring releases "
                            "work together",
                            node.id, node.version, LEAFCUTTER_VERSION));
        }
    }
}

ComputeOptions compute_options(const Config& config) {
    if (!computes(config.role)) {
        return {0, 1};
    }
    const unsigned cores = std::max(1U, std::thread::hardware_concurrency());
    return {config.compute_workers, config.threads_per_job == 0 ? cores : config.threads_per_job};
}

}  // namespace

App::App(const Config& config, AppParts parts)
    : parts_(std::move(parts)),
      burn_logs_(std::filesystem::absolute(config.state) / "burns"),
      self_{config.store.empty() ? "" : config.node, config.role, config.advertise,
            std::chrono::seconds(config.lease_s)},
      duties_(self_.id.empty() ? std::chrono::milliseconds(0) : self_.lease),
      peers_(self_.id, config.fleet_key, self_.lease),
      hub_(event_source()),
      stop_policy_(config.stop_policy) {
    store_ = std::make_unique<Store>(
        config.state, [this] { after_commit(); }, store_choice(config));
    if (self() != nullptr) {
        check_releases(store_->fleet, self_);
        peers_.know(store_->fleet);
    }
    std::filesystem::create_directories(burn_logs_);
    accounts_ = std::make_unique<Accounts>(store_->accounts);
    check_exposure(config, *accounts_);
    audit_ = std::make_unique<AuditLog>(store_->accounts);
    // Before any machine is touched: another daemon may have them.
    edge_ = std::make_unique<Edge>(
        edge_options(config), [this](Request& request) { return answer(*this, request); }, hub_);
    if (store_->trouble().empty()) {
        for (DeviceRecord device : config.devices) {
            device.station = self_.id;
            store_->devices.put(device);
        }
    }
    compute_ =
        std::make_unique<ComputeRunner>(*store_, parts_.compute, compute_options(config),
                                        [this](const std::string& job) { post("job", job); });
    fleet_ = std::make_unique<DeviceFleet>(
        *store_,
        DeviceHooks{parts_.open_device,
                    [this](const std::string& device) { post("device", device); },
                    [this](const std::string& cut) { post("cut", cut); }, config.stop_policy});
    begin_webhooks(config);
    if (serves(config.role)) {
        duties_.want(kHousekeeping);
    }
    housekeeper_ = std::make_unique<Housekeeper>(*store_, duties_);
    if (self() != nullptr) {
        begin_fleet(config);
    }
    hub_.start();
    edge_->start();
}

App::~App() {
    if (node_) {
        node_->begin_nothing();
    }
    if (stop_policy_ == StopPolicy::Finish) {
        fleet_->finish_sheets();  // With the edge open: somebody may have to press stop.
    }
    edge_.reset();
    std::unique_ptr<FleetNode> node;
    {
        const std::scoped_lock lock(webhooks_mutex_);
        node.swap(node_);
    }
    fleet_->stop_all();
    node.reset();  // The leases of its machines end when these stand.
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
        auto begun = std::make_unique<Webhook>(webhook, store_->events, store_->settings, duties_);
        const std::scoped_lock lock(webhooks_mutex_);
        webhooks_.push_back(std::move(begun));
    }
}

void App::after_commit() {
    hub_.wake();
    const std::scoped_lock lock(webhooks_mutex_);
    if (node_) {
        node_->wake();
        compute_->wake();
        for (const auto& runner : fleet_->all()) {
            runner->wake();
        }
    }
    for (const auto& webhook : webhooks_) {
        webhook->wake();
    }
}

StoreChoice App::store_choice(const Config& config) {
    StoreChoice choice;
    if (self() == nullptr) {
        return choice;
    }
    choice.uri = config.store;
    choice.scope = {self_.id, self_.lease};
    choice.computes = computes(config.role);
    choice.has_machines = cuts(config.role);
    choice.adopts = config.role == NodeRole::All;
    choice.on_passing = [this](const std::string& text) { hear(text); };
    choice.others.fetch = [this](const std::string& sha256, const Blobs& blobs) {
        return peers_.fetch(sha256, blobs);
    };
    choice.others.share = [this](const std::string& sha256, const Blobs& blobs) {
        peers_.share(sha256, blobs);
    };
    return choice;
}

void App::begin_fleet(const Config& config) {
    if (self_.url.empty()) {
        const std::string& address = config.listen.address;
        const bool v6 = address.find(':') != std::string::npos;
        self_.url =
            fmt::format("http://{}:{}", v6 ? fmt::format("[{}]", address) : address, edge_->port());
    }
    FleetHooks hooks;
    hooks.view = [this](const std::string& type, const std::string& id) {
        return passing_view(*this, type, id);
    };
    hooks.on_beat = [this] {
        accounts_->reload();
        duties_.renew(store_->fleet);
        hub_.wake();  // Whatever was not announced.
    };
    auto node = std::make_unique<FleetNode>(*store_, *compute_, *fleet_, self_, std::move(hooks));
    const std::scoped_lock lock(webhooks_mutex_);
    node_ = std::move(node);
}

// At most once a second: anybody can send what nobody knows.
bool App::look_again_for_accounts(const Request& request) {
    const bool says_who =
        request.header("authorization") || request.header("x-api-key") || request.header("cookie");
    const auto now = std::chrono::steady_clock::now().time_since_epoch();
    const std::int64_t now_s = std::chrono::duration_cast<std::chrono::seconds>(now).count();
    if (self() == nullptr || !says_who || accounts_seen_s_.exchange(now_s) == now_s) {
        return false;
    }
    try {
        accounts_->reload();
    } catch (const StoreError&) {  // Then those that are known will have to do.
        return false;
    }
    return true;
}

void App::post(const std::string& type, const std::string& id) {
    hub_.post(type, id);
    const std::scoped_lock lock(webhooks_mutex_);
    if (node_) {
        node_->post(type, id);
    }
}

void App::hear(const std::string& text) {
    const nlohmann::json said = nlohmann::json::parse(text, nullptr, /*allow_exceptions=*/false);
    if (!said.is_object() || said.value("from", self_.id) == self_.id) {
        return;
    }
    const std::string type = said.value("type", "");
    const std::string id = said.value("id", "");
    remote_.put(type, id, said.value("view", nlohmann::json::object()));
    hub_.post(type, id);
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
