#include "server/queue/device_runner.h"

#include <algorithm>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "drivers/transport.h"
#include "server/queue/frame_program.h"

namespace leafcutter::server {

namespace {

using drivers::JobOutcome;
using drivers::MachineState;
using namespace std::chrono_literals;

constexpr auto kSlice = 20ms;

// Everything a client sees of a status; equal text, nothing to tell.
std::string fingerprint(const drivers::DeviceStatus& status) {
    return fmt::format("{} {} {} {} {} {} {} {} {}", drivers::to_string(status.state),
                       fmt::join(status.machine_position_mm, " "),
                       fmt::join(status.work_position_mm, " "), status.feed_mm_per_min,
                       status.power_s, fmt::join(status.override_percent, " "), status.alarm_code,
                       status.message, status.firmware);
}

}  // namespace

DeviceRunner::DeviceRunner(DeviceRecord record,
                           Store& store,
                           DeviceHooks hooks,
                           FirstContact contact)
    : record_(std::move(record)),
      store_(store),
      hooks_(std::move(hooks)),
      may_connect_(contact == FirstContact::AtOnce) {
    if (!may_connect_) {
        message_ = "a cut was interrupted on this machine: look at it, then reset";
    }
    thread_ = std::jthread([this](const std::stop_token& stop) { loop(stop); });
}

DeviceRunner::~DeviceRunner() {
    thread_.request_stop();
    thread_.join();
}

void DeviceRunner::loop(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
        try {
            if (lost_) {
                settle_lost(stop);
            } else if (device()) {
                step();
            } else {
                connect(stop);
            }
            publish();
        } catch (const drivers::LinkLost& error) {
            lose_link(error.what());
        } catch (const std::exception& error) {  // The store failed; the machine goes on.
            spdlog::error("device {}: {}", record_.id, error.what());
            next_store_try_ = next_queue_look_ = Clock::now() + 1s;
            look_at_queue_ = queue_changed_ = true;
        }
    }
    try {
        wind_down();
    } catch (const std::exception& error) {
        spdlog::error("device {}: {}", record_.id, error.what());
    }
}

void DeviceRunner::step() {
    const std::shared_ptr<drivers::Device> machine = device();
    machine->run_once(kSlice);
    if (current_cut()) {
        follow_cut();
    } else if (framing_) {
        framing_ = machine->progress().outcome == JobOutcome::Running;
    } else {
        take_up_next();
    }
}

void DeviceRunner::take_up_next() {
    if (closing_) {
        return;
    }
    std::optional<std::string> frame;
    {
        const std::scoped_lock lock(mutex_);
        frame = std::exchange(frame_program_, std::nullopt);
        framing_ = frame.has_value();
    }
    if (frame) {
        start_frame(*frame);
        return;
    }
    constexpr auto kLookEvery = 2s;  // Besides every wake().
    const Clock::time_point now = Clock::now();
    const bool due = look_at_queue_.load() || now >= next_queue_look_;
    if (!due) {
        return;
    }
    look_at_queue_ = false;
    next_queue_look_ = now + kLookEvery;
    const std::vector<CutRecord> open = store_.cuts.open_on(record_.id);
    const auto armed = std::find_if(open.begin(), open.end(), [](const CutRecord& cut) {
        return cut.state == CutState::Armed;
    });
    if (armed != open.end()) {
        take_up(*armed);
    } else if (record_.auto_start && is_ready() && !waits_for_word()) {
        start_next_of(open);
    }
}

// The configuration speaks for the operator here; a cut between two sheets goes on first. The rest
// of a cut that ended early never goes by itself.
void DeviceRunner::start_next_of(const std::vector<CutRecord>& open) {
    if (open.empty() || store_.jobs.queue_pause()) {
        return;
    }
    const auto begun = std::find_if(
        open.begin(), open.end(), [](const CutRecord& cut) { return occupies_device(cut.state); });
    const auto fresh =
        std::find_if(open.begin(), open.end(), [](const CutRecord& cut) { return !cut.is_rest(); });
    const auto next = begun != open.end() ? begun : fresh;
    if (next != open.end() && store_.cuts.arm(*next)) {
        look_at_queue_ = true;
    }
}

// Whoever stopped the last cut, or whatever did, has to be looked at before a beam comes on again.
bool DeviceRunner::waits_for_word() const {
    if (word_given_) {
        return false;
    }
    const std::optional<CutRecord> last = store_.cuts.last_begun_on(record_.id);
    return last && is_final(last->state) && last->state != CutState::Done;
}

void DeviceRunner::start_frame(const std::string& program) {
    try {
        device()->start(program);
    } catch (const drivers::Refused& error) {
        framing_ = false;
        keep_line(error.what());
    }
}

void DeviceRunner::publish() {
    constexpr auto kShortestGap = 200ms;
    const Clock::time_point now = Clock::now();
    if (now < next_publish_) {
        return;
    }
    const std::optional<std::string> cut = current_cut();
    const std::string freedom = fmt::format("{} {}", is_ready(), cut.value_or(""));
    const std::string seen = fmt::format("{} {} {} {}", fingerprint(status()), freedom,
                                         progress_.lines_acknowledged, lines_heard());
    const bool queue_changed = queue_changed_.exchange(false);
    if (seen == published_ && !queue_changed) {
        return;
    }
    published_ = seen;
    next_publish_ = now + kShortestGap;
    hooks_.on_device(record_.id);
    if (freedom == published_freedom_ && !queue_changed) {
        if (cut) {
            hooks_.on_cut(*cut);
        }
        return;
    }
    // Whether a cut may start depends on this machine and on the other cuts in its queue.
    published_freedom_ = freedom;
    for (const CutRecord& open : store_.cuts.open_on(record_.id)) {
        hooks_.on_cut(open.id);
    }
}

void DeviceRunner::wind_down() {
    const std::shared_ptr<drivers::Device> machine = device();
    if (lost_) {
        settle(*lost_);
    }
    if (!machine || !current_cut()) {
        return;
    }
    spdlog::info("device {}: the daemon stops, holding the cut", record_.id);
    constexpr auto kPatience = 5s;
    const Clock::time_point end = Clock::now() + kPatience;
    machine->cancel();
    try {
        while (machine->progress().outcome == JobOutcome::Running && Clock::now() < end) {
            machine->run_once(kSlice);
        }
        if (machine->progress().outcome == JobOutcome::Running) {
            machine->stop();
            machine->run_once(kSlice);
        }
        while (beam_ && machine->progress().outcome != JobOutcome::Done &&
               !beam_->has_settled(machine->status())) {
            machine->run_once(kSlice);
        }
    } catch (const drivers::LinkLost& error) {
        spdlog::warn("device {}: {}", record_.id, error.what());
    }
    drivers::JobProgress last = machine->progress();
    close_beam(last);
    if (last.outcome != JobOutcome::Done) {
        const bool aborts = hooks_.stop_policy == StopPolicy::Abort;
        last.outcome = aborts ? JobOutcome::Aborted : JobOutcome::LinkLost;
        last.reason = "the daemon was stopped";
    }
    settle(last);
}

}  // namespace leafcutter::server
