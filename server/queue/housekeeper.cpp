#include "server/queue/housekeeper.h"

#include <exception>

#include <spdlog/spdlog.h>

#include "server/retention.h"

namespace leafcutter::server {

using namespace std::chrono_literals;

namespace {

constexpr std::chrono::hours kDay{24};

// So many rows in one transaction: others wait for its end.
constexpr int kAtOnce = 50;
constexpr int kEventsAtOnce = 2000;

// Until there is nothing left to do.
template <typename Step>
void repeat(const std::stop_token& stop, Step step) {
    while (!stop.stop_requested() && step() > 0) {
    }
}

}  // namespace

Housekeeper::Housekeeper(Store& store, const Duties& duties)
    : store_(store), duties_(duties), last_backup_(Clock::now()), next_sweep_(Clock::now() + 1min) {
    thread_ = std::jthread([this](const std::stop_token& stop) { loop(stop); });
}

Housekeeper::~Housekeeper() {
    thread_.request_stop();
    thread_.join();
}

void Housekeeper::wake() {
    {
        const std::scoped_lock lock(mutex_);
        woken_ = true;
    }
    nudged_.notify_all();
}

void Housekeeper::loop(const std::stop_token& stop) {
    constexpr auto kLookEvery = 20s;
    while (!stop.stop_requested()) {
        try {
            work(stop);
        } catch (const std::exception& error) {
            spdlog::error("housekeeping: {}", error.what());
        }
        std::unique_lock lock(mutex_);
        nudged_.wait_for(lock, stop, kLookEvery, [this] { return woken_; });
        woken_ = false;
    }
}

void Housekeeper::work(const std::stop_token& stop) {
    if (!store_.trouble().empty()) {
        return;
    }
    if (!checked_) {
        checked_ = true;  // A large database is not looked through before the daemon serves.
        const std::string damage = store_.check();
        if (!damage.empty()) {
            spdlog::error("the database is damaged: {}", damage);
            return;
        }
    }
    if (duties_.has(kHousekeeping)) {
        back_up_if_due();
        let_go(stop);
    }
    sweep_if_due();
}

void Housekeeper::back_up_if_due() {
    const Retention retention = retention_of(store_.settings);
    if (retention.backup_every_min == 0 ||
        Clock::now() - last_backup_ < std::chrono::minutes(retention.backup_every_min)) {
        return;
    }
    last_backup_ = Clock::now();
    const std::string name = store_.back_up(static_cast<std::size_t>(retention.backups_kept));
    spdlog::info("backup {}", name);
}

void Housekeeper::let_go(const std::stop_token& stop) {
    const Retention retention = retention_of(store_.settings);
    if (retention.jobs_days > 0) {
        repeat(stop,
               [&] { return store_.jobs.remove_finished(retention.jobs_days * kDay, kAtOnce); });
    }
    if (retention.packages_days > 0) {
        repeat(stop,
               [&] { return store_.jobs.drop_packages(retention.packages_days * kDay, kAtOnce); });
    }
    if (retention.events_days > 0) {
        repeat(stop,
               [&] { return store_.events.forget(retention.events_days * kDay, kEventsAtOnce); });
    }
}

void Housekeeper::sweep_if_due() {
    if (Clock::now() >= next_sweep_) {
        next_sweep_ = Clock::now() + 1h;
        const std::size_t removed = store_.collect_garbage();
        if (removed > 0) {
            spdlog::info("{} files that nobody names are gone", removed);
        }
    }
}

}  // namespace leafcutter::server
