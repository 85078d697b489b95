// The part of DeviceRunner that opens a machine's link and deals with its loss.

#include <utility>

#include <spdlog/spdlog.h>

#include "drivers/transport.h"
#include "server/queue/device_runner.h"

namespace leafcutter::server {

using namespace std::chrono_literals;
using drivers::JobOutcome;

void DeviceRunner::connect(const std::stop_token& stop) {
    constexpr auto kPause = 2s;
    {
        std::unique_lock lock(mutex_);
        if (!may_connect_) {
            nudged_.wait_for(lock, stop, kPause, [this] { return may_connect_; });
            return;
        }
        plugged_in_ = false;
    }
    try {
        disarm();
        std::shared_ptr<drivers::Device> opened = hooks_.open(record_.uri);
        opened->on_line = [this](std::string_view line) { keep_line(line); };
        disarm();
        say("");
        spdlog::info("device {}: opened {}", record_.id, record_.uri);
        look_at_place(opened->status());
        const std::scoped_lock lock(mutex_);
        device_ = std::move(opened);
    } catch (const std::exception& error) {
        if (status().message != error.what()) {
            spdlog::warn("device {}: {}", record_.id, error.what());
        }
        say(error.what());
        std::unique_lock lock(mutex_);
        nudged_.wait_for(lock, stop, kPause, [this] { return plugged_in_; });
    }
}

// Before anything moves the machine: where it stands tells what became of a cut that lost it.
void DeviceRunner::look_at_place(const drivers::DeviceStatus& status) {
    try {
        note_found(store_, record_.id, status);
    } catch (const std::exception& error) {
        spdlog::warn("device {}: {}", record_.id, error.what());
    }
}

// An armed cut must not fire when its machine comes back, with hands in the bed.
void DeviceRunner::disarm() {
    for (const CutRecord& cut : store_.cuts.open_on(record_.id)) {
        if (cut.state == CutState::Armed) {
            store_.cuts.move(cut.id, CutState::Armed, cut.before_arming(),
                             "the machine was not connected");
        }
    }
}

void DeviceRunner::lose_link(const std::string& why) {
    spdlog::warn("device {}: {}", record_.id, why);
    drivers::JobProgress last = device()->progress();
    bool was_cutting = false;
    {
        const std::scoped_lock lock(mutex_);
        device_.reset();
        was_cutting = current_.has_value();
        may_connect_ = !was_cutting;
        message_ = was_cutting ? why + "; look at the machine, then reset" : why;
    }
    framing_ = false;
    if (was_cutting) {
        last.outcome = JobOutcome::LinkLost;
        last.reason = why;
        lost_ = last;
    }
}

void DeviceRunner::settle_lost(const std::stop_token& stop) {
    {
        std::unique_lock lock(mutex_);
        nudged_.wait_until(lock, stop, next_store_try_, [] { return false; });
    }
    settle(*lost_);
    lost_.reset();
}

}  // namespace leafcutter::server
