// The part of DeviceRunner that other threads call.

#include <utility>

#include "server/queue/device_runner.h"
#include "server/queue/frame_program.h"

namespace leafcutter::server {

using drivers::MachineState;

drivers::DeviceStatus DeviceRunner::status() const {
    const std::shared_ptr<drivers::Device> machine = device();
    if (machine) {
        return machine->status();
    }
    drivers::DeviceStatus nothing;
    const std::scoped_lock lock(mutex_);
    nothing.message = message_;
    return nothing;
}

std::uint64_t DeviceRunner::lines_heard() const {
    const std::scoped_lock lock(mutex_);
    return lines_heard_;
}

std::vector<std::string> DeviceRunner::console_lines() const {
    const std::scoped_lock lock(mutex_);
    return {lines_.begin(), lines_.end()};
}

std::optional<std::string> DeviceRunner::current_cut() const {
    const std::scoped_lock lock(mutex_);
    return current_ ? std::optional(current_->id) : std::nullopt;
}

std::optional<CutRecord> DeviceRunner::cut_in_work() const {
    const std::scoped_lock lock(mutex_);
    const bool begun = current_ && current_->state != CutState::Armed;
    return begun ? current_ : std::nullopt;
}

std::optional<CutProgress> DeviceRunner::live_progress(const std::string& cut) const {
    const std::scoped_lock lock(mutex_);
    return current_ && current_->id == cut ? std::optional(progress_) : std::nullopt;
}

bool DeviceRunner::is_cutting() const {
    const std::scoped_lock settled(settling_);
    return current_cut().has_value();
}

bool DeviceRunner::is_ready() const {
    const std::scoped_lock settled(settling_);
    {
        const std::scoped_lock lock(mutex_);
        if (current_ || frame_program_ || framing_) {
            return false;
        }
    }
    return status().state == MachineState::Idle;
}

void DeviceRunner::wake() {
    look_at_queue_ = queue_changed_ = true;
}

bool DeviceRunner::pause(const std::string& cut) {
    if (current_cut() != cut) {
        return false;
    }
    hold();
    return true;
}

bool DeviceRunner::resume(const std::string& cut) {
    if (current_cut() != cut) {
        return false;
    }
    resume();
    return true;
}

bool DeviceRunner::abort(const std::string& cut) {
    {
        const std::scoped_lock lock(mutex_);
        if (!current_ || current_->id != cut) {
            return false;
        }
        abort_wanted_ = true;
    }
    if (const auto machine = device()) {
        machine->cancel();
    }
    return true;
}

void DeviceRunner::hold() {
    if (const auto machine = device()) {
        machine->hold();
    }
}

void DeviceRunner::resume() {
    if (const auto machine = device()) {
        machine->resume();
    }
}

void DeviceRunner::stop() {
    if (const auto machine = device()) {
        machine->stop();
    }
}

void DeviceRunner::reset() {
    stop();
    {
        const std::scoped_lock lock(mutex_);
        may_connect_ = true;
    }
    word_given_ = look_at_queue_ = true;
    nudged_.notify_all();
}

void DeviceRunner::look_for_machine() {
    {
        const std::scoped_lock lock(mutex_);
        plugged_in_ = true;
    }
    nudged_.notify_all();
}

void DeviceRunner::set_overrides(const std::array<std::optional<int>, 3>& percent) {
    const std::shared_ptr<drivers::Device> machine = connected_device();
    std::array<int, 3> wanted = machine->status().override_percent;
    for (std::size_t i = 0; i < wanted.size(); ++i) {
        wanted.at(i) = percent.at(i).value_or(wanted.at(i));
    }
    machine->set_overrides(wanted);
}

std::vector<drivers::MachineSetting> DeviceRunner::settings() const {
    return connected_device()->settings();
}

void DeviceRunner::set_setting(std::string_view key, double value) {
    device_for_hand_work()->set_setting(key, value);
}

void DeviceRunner::home() {
    device_for_hand_work()->home();
}

void DeviceRunner::unlock() {
    device_for_hand_work()->unlock();
}

void DeviceRunner::jog(const drivers::Jog& jog) {
    device_for_hand_work()->jog(jog);
}

void DeviceRunner::console(const std::string& line) {
    const std::shared_ptr<drivers::Device> machine = device_for_hand_work();
    keep_line("> " + line);
    machine->console(line);
}

void DeviceRunner::frame() {
    device_for_hand_work();
    for (const CutRecord& cut : store_.cuts.open_on(record_.id)) {
        std::string program = frame_program(store_.blobs.read(cut.program_sha256));
        if (!program.empty()) {
            const std::scoped_lock lock(mutex_);
            frame_program_ = std::move(program);
            framed_ = cut.program_sha256;
            queue_changed_ = true;  // The cut's steps show it.
            return;
        }
    }
    throw drivers::Refused("there is no sheet to frame: put a cut in this machine's queue first");
}

std::string DeviceRunner::framed() const {
    const std::scoped_lock lock(mutex_);
    return framed_;
}

std::shared_ptr<drivers::Device> DeviceRunner::device() const {
    const std::scoped_lock lock(mutex_);
    return device_;
}

std::shared_ptr<drivers::Device> DeviceRunner::device_for_hand_work() const {
    if (is_cutting()) {
        throw drivers::Refused("a cut is in work on this machine: wait for its end or abort it");
    }
    return connected_device();
}

std::shared_ptr<drivers::Device> DeviceRunner::connected_device() const {
    const std::scoped_lock lock(mutex_);
    if (!device_) {
        throw drivers::Refused("the machine is not connected" +
                               (message_.empty() ? std::string() : ": " + message_));
    }
    return device_;
}

void DeviceRunner::keep_line(std::string_view line) {
    constexpr std::size_t kKept = 100;
    if (line.empty() || line.front() == '<' || line == "ok") {
        return;  // Status reports and acknowledgements come by the hundred.
    }
    const std::scoped_lock lock(mutex_);
    lines_.emplace_back(line);
    ++lines_heard_;
    if (lines_.size() > kKept) {
        lines_.pop_front();
    }
}

void DeviceRunner::say(const std::string& message) {
    const std::scoped_lock lock(mutex_);
    message_ = message;
}

}  // namespace leafcutter::server
