#include "server/queue/device_fleet.h"

#include <algorithm>
#include <chrono>
#include <thread>
#include <utility>

#include "drivers/lihuiyu/address.h"
#include "server/queue/cut_beam.h"

namespace leafcutter::server {

DeviceFleet::DeviceFleet(Store& store, DeviceHooks hooks)
    : store_(store), hooks_(std::move(hooks)) {
    assess_interrupted(store_);
    for (const DeviceRecord& device : store_.devices.list()) {
        if (!store_.has_machine(device)) {
            continue;
        }
        const auto& doubtful = store_.interrupted_devices;
        const bool inspect =
            std::find(doubtful.begin(), doubtful.end(), device.id) != doubtful.end();
        // A simulated machine died with the daemon: there is nothing to look at.
        const bool simulated = device.uri.starts_with("sim:");
        const FirstContact contact =
            inspect && !simulated ? FirstContact::AfterReset : FirstContact::AtOnce;
        runners_[device.id] = std::make_shared<DeviceRunner>(device, store_, hooks_, contact);
    }
    usb_watch_ = drivers::watch_usb(drivers::kLihuiyuVendor, drivers::kLihuiyuProduct, [this] {
        for (const std::shared_ptr<DeviceRunner>& runner : all()) {
            runner->look_for_machine();
        }
    });
}

std::shared_ptr<DeviceRunner> DeviceFleet::find(const std::string& id) const {
    const std::scoped_lock lock(mutex_);
    const auto found = runners_.find(id);
    return found == runners_.end() ? nullptr : found->second;
}

std::vector<std::shared_ptr<DeviceRunner>> DeviceFleet::all() const {
    const std::scoped_lock lock(mutex_);
    std::vector<std::shared_ptr<DeviceRunner>> runners;
    for (const auto& [id, runner] : runners_) {
        if (runner) {  // Null while put() changes it.
            runners.push_back(runner);
        }
    }
    return runners;
}

void DeviceFleet::check_idle(const std::string& id) const {
    const std::shared_ptr<DeviceRunner> runner = find(id);
    if (runner && runner->is_cutting()) {
        throw drivers::Refused("a cut is in work on this machine: wait for its end or abort it");
    }
}

void DeviceFleet::put(const DeviceRecord& device) {
    const std::scoped_lock one_at_a_time(changing_);
    check_idle(device.id);
    store_.devices.put(device);
    std::shared_ptr<DeviceRunner> old;
    {
        const std::scoped_lock lock(mutex_);
        old = std::exchange(runners_[device.id], nullptr);
    }
    old.reset();  // Its port must be free before the next one opens it.
    auto runner = std::make_shared<DeviceRunner>(device, store_, hooks_, FirstContact::AtOnce);
    const std::scoped_lock lock(mutex_);
    runners_[device.id] = std::move(runner);
}

void DeviceFleet::remove(const std::string& id) {
    const std::scoped_lock one_at_a_time(changing_);
    check_idle(id);
    store_.devices.remove(id);
    std::shared_ptr<DeviceRunner> old;
    const std::scoped_lock lock(mutex_);
    const auto found = runners_.find(id);
    if (found != runners_.end()) {
        old = std::move(found->second);
        runners_.erase(found);
    }
}

void DeviceFleet::finish_sheets() {
    const std::vector<std::shared_ptr<DeviceRunner>> runners = all();
    for (const auto& runner : runners) {
        runner->set_appetite(DeviceRunner::Appetite::TakesNoMore);
    }
    constexpr std::chrono::milliseconds kLookEvery{100};
    for (const auto& runner : runners) {
        while (runner->current_cut()) {
            std::this_thread::sleep_for(kLookEvery);  // Minutes, often: nobody waits for this.
        }
    }
}

void DeviceFleet::stop_all() {
    std::map<std::string, std::shared_ptr<DeviceRunner>> runners;
    {
        const std::scoped_lock lock(mutex_);
        runners.swap(runners_);
    }
    std::vector<std::jthread> stopping;  // Side by side: each may take seconds to stand still.
    stopping.reserve(runners.size());
    for (auto& [id, runner] : runners) {
        stopping.emplace_back([&runner = runner] { runner.reset(); });
    }
}

}  // namespace leafcutter::server
