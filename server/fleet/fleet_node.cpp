#include "server/fleet/fleet_node.h"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <spdlog/spdlog.h>

#include "server/store/store_error.h"

namespace leafcutter::server {

using namespace std::chrono_literals;

FleetNode::FleetNode(
    Store& store, ComputeRunner& compute, DeviceFleet& devices, FleetSelf self, FleetHooks hooks)
    : store_(store),
      compute_(compute),
      devices_(devices),
      self_(std::move(self)),
      hooks_(std::move(hooks)) {
    thread_ = std::jthread([this](const std::stop_token& stop) { loop(stop); });
}

FleetNode::~FleetNode() {
    thread_.request_stop();
    thread_.join();
}

void FleetNode::wake() {
    {
        const std::scoped_lock lock(mutex_);
        woken_ = true;
    }
    nudged_.notify_all();
}

void FleetNode::post(const std::string& type, const std::string& id) {
    const std::scoped_lock lock(mutex_);
    passing_.insert({type, id});
}

void FleetNode::loop(const std::stop_token& stop) {
    constexpr auto kTick = 250ms;  // What passes is told that often, and a cancel noticed.
    while (!stop.stop_requested()) {
        try {
            if (Clock::now() >= next_beat_) {
                beat();
                // Three may be lost before a lease is.
                next_beat_ = Clock::now() + std::min<Clock::duration>(self_.lease / 4, 5s);
            }
            bool woken = false;
            {
                const std::scoped_lock lock(mutex_);
                woken = std::exchange(woken_, false);
            }
            if (woken) {
                keep_jobs();
            }
            tell_others();
        } catch (const std::exception& error) {
            spdlog::warn("node {}: {}", self_.id, error.what());
            reachable_since_.reset();
            next_beat_ = Clock::now() + 500ms;
        }
        std::unique_lock lock(mutex_);
        nudged_.wait_for(lock, stop, kTick, [] { return false; });
    }
    try {
        store_.fleet.let_go_of_machines();
    } catch (const StoreError&) {  // Then they run out by themselves.
    }
}

NodeRecord FleetNode::record() const {
    NodeRecord node;
    node.id = self_.id;
    node.role = to_string(self_.role);
    node.url = self_.url;
    node.version = LEAFCUTTER_VERSION;
    nlohmann::json machines = nlohmann::json::array();
    int cutting = 0;
    for (const auto& runner : devices_.all()) {
        machines.push_back(runner->record().id);
        cutting += runner->current_cut() ? 1 : 0;
    }
    node.facts_json =
        nlohmann::json{{"machines", machines},          {"cutting", cutting},
                       {"mode", to_string(mode_)},      {"computing", compute_.running().size()},
                       {"workers", compute_.workers()}, {"database_ms", database_ms_}}
            .dump();
    return node;
}

void FleetNode::beat() {
    const Clock::time_point asked = Clock::now();
    const NodeMode mode = store_.fleet.beat(record());
    database_ms_ =
        std::chrono::duration_cast<std::chrono::milliseconds>(Clock::now() - asked).count();
    // A database, or a process, that stood still for a while is no contact either.
    if (!reachable_since_ || Clock::now() - last_contact_ > self_.lease / 2) {
        reachable_since_ = Clock::now();
    }
    last_contact_ = Clock::now();
    keep_jobs();
    mode_ = mode;
    if (cuts(self_.role)) {
        keep_machines(mode);
        reconcile_cuts();
    }
    if (serves(self_.role)) {
        reap_if_sure();
    }
    compute_.wake();  // Whoever was told of nothing looks all the same.
    for (const auto& runner : devices_.all()) {
        runner->wake();
        post("device", runner->record().id);
    }
    if (hooks_.on_beat) {
        hooks_.on_beat();
    }
}

// Also those that somebody cancelled: nobody's result is wanted any more.
void FleetNode::keep_jobs() {
    const std::vector<JobLease> running = compute_.running();
    if (running.empty()) {
        return;
    }
    for (const std::string& lost : store_.fleet.renew(running)) {
        spdlog::info("job {}: no longer ours", lost);
        compute_.stop_job(lost);
    }
}

void FleetNode::keep_machines(NodeMode mode) {
    std::set<std::string> held;
    for (const MachineLease& lease : store_.fleet.hold_machines()) {
        held.insert(lease.device);
    }
    const bool may_begin = mode == NodeMode::Active && !closing_;
    for (const auto& runner : devices_.all()) {
        const bool eats = may_begin && held.count(runner->record().id) != 0;
        runner->set_appetite(eats ? DeviceRunner::Appetite::TakesMore
                                  : DeviceRunner::Appetite::TakesNoMore);
        if (!eats) {
            disarm(runner->record().id);
        }
    }
}

// An armed cut must not fire when its station works again, with hands in the bed.
void FleetNode::disarm(const std::string& device) {
    for (const CutRecord& cut : store_.cuts.open_on(device)) {
        if (cut.state == CutState::Armed) {
            store_.cuts.move(cut.id, CutState::Armed, cut.before_arming(),
                             "its station takes up no work now");
        }
    }
}

// What the rows say of cuts here, and what is so.
void FleetNode::reconcile_cuts() {
    for (const auto& runner : devices_.all()) {
        const auto cut = runner->cut_in_work();
        if (cut && store_.cuts.reclaim(*cut)) {
            spdlog::info("cut {}: in work all the time, and said so again", cut->id);
        }
    }
    for (const CutRecord& cut : store_.cuts.in_hand()) {
        const auto runner = devices_.find(cut.device);
        if (runner && runner->current_cut() == cut.id) {
            continue;
        }
        // It may have ended just now; what has not was begun on paper alone.
        const auto now = store_.cuts.find(cut.id);
        const bool still = now && now->version == cut.version && now->state == cut.state;
        if (still && !(runner && runner->current_cut() == cut.id) &&
            store_.cuts.move(cut.id, cut.state, CutState::Interrupted,
                             "the database went away as the sheet was to begin: the beam did not "
                             "come on. Cut it again")) {
            spdlog::warn("cut {}: was begun on paper alone", cut.id);
        }
    }
}

// After an outage of the database nobody could renew anything: they get the time to.
void FleetNode::reap_if_sure() {
    if (Clock::now() - *reachable_since_ < self_.lease) {
        return;
    }
    const Reaped reaped = store_.fleet.reap();
    if (reaped.jobs + reaped.cuts > 0) {
        spdlog::warn("{} jobs and {} cuts were with nodes that are out of reach", reaped.jobs,
                     reaped.cuts);
    }
}

// Machines before their cuts: what may be done with these depends on those.
void FleetNode::tell_others() {
    std::set<std::pair<std::string, std::string>> passing;
    {
        const std::scoped_lock lock(mutex_);
        passing.swap(passing_);
    }
    for (const auto& [type, id] : passing) {
        if (const auto view = hooks_.view(type, id)) {
            const std::string key = fmt::format("{} {}", type == "device" ? 0 : 1, id);
            store_.pass_on(key, fmt::format(R"({{"from":"{}","type":"{}","id":"{}","view":{}}})",
                                            self_.id, type, id, *view));
        }
    }
}

}  // namespace leafcutter::server
