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

CutProgress counted(const drivers::JobProgress& progress) {
    return {static_cast<std::int64_t>(progress.lines_total),
            static_cast<std::int64_t>(progress.lines_sent),
            static_cast<std::int64_t>(progress.lines_acknowledged)};
}

std::string how_far(const CutRecord& cut,
                    const drivers::JobProgress& progress,
                    const std::optional<BeamRecord>& beam) {
    std::string text =
        fmt::format("sheet {}: {} of {} lines acknowledged, {} sent; ", cut.sheet(),
                    progress.lines_acknowledged, progress.lines_total, progress.lines_sent);
    if (beam && beam->total_mm > 0.0) {
        text += fmt::format("{:.1f} to {:.1f} of {:.1f} mm are burnt: finish the rest, or ",
                            beam->least_mm, beam->most_mm, beam->total_mm);
    }
    return text + "cut this sheet again on fresh material";
}

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

void DeviceRunner::follow_cut() {
    const std::shared_ptr<drivers::Device> machine = device();
    const drivers::JobProgress progress = machine->progress();
    CutRecord cut;
    {
        const std::scoped_lock lock(mutex_);
        cut = current_.value();
        progress_ = counted(progress);
        if (beam_) {
            progress_.burnt_mm = beam_->burnt_mm();
            progress_.burn_mm = beam_->total_mm();
        }
    }
    if (beam_ && trouble_.empty() && !(trouble_ = beam_->trouble()).empty()) {
        spdlog::error("cut {}: {}", cut.id, trouble_);
        machine->cancel();
    }
    if (Clock::now() < next_store_try_) {
        return;
    }
    if (progress.outcome != JobOutcome::Running) {
        const bool done = progress.outcome == JobOutcome::Done;
        if (done || !beam_ || beam_->has_settled(machine->status())) {
            settle(progress);
        }
        return;
    }
    const MachineState state = machine->status().state;
    const bool holds = state == MachineState::Hold || state == MachineState::Door;
    const CutState wanted = holds                        ? CutState::Paused
                            : state == MachineState::Run ? CutState::Cutting
                                                         : cut.state;
    if (wanted != cut.state && store_.cuts.move(cut.id, cut.state, wanted)) {
        spdlog::info("cut {}: {}", cut.id, to_string(wanted));
        const std::scoped_lock lock(mutex_);
        current_->state = wanted;
    }
    constexpr auto kRecordEvery = 1s;
    if (Clock::now() >= next_record_) {
        store_.cuts.record_progress(cut.id, counted(progress));
        next_record_ = Clock::now() + kRecordEvery;
    }
}

// Throws, and keeps the cut in work, if the store fails: the outcome is written when it is back.
void DeviceRunner::settle(const drivers::JobProgress& progress) {
    CutRecord cut;
    {
        const std::scoped_lock lock(mutex_);
        cut = current_.value();
    }
    close_beam(progress);
    write_outcome(cut, progress);
    ended_beam_.reset();
    trouble_.clear();
    {
        const std::scoped_lock lock(mutex_);
        current_.reset();
        abort_wanted_ = false;
    }
    look_at_queue_ = queue_changed_ = true;
    hooks_.on_cut(cut.id);
}

void DeviceRunner::close_beam(const drivers::JobProgress& progress) {
    const std::shared_ptr<drivers::Device> machine = device();
    if (machine) {
        machine->watch.reset();
    }
    if (beam_ && progress.outcome != JobOutcome::Done) {
        ended_beam_ = beam_->close(progress, machine ? machine->status() : drivers::DeviceStatus{});
    }
    beam_.reset();
}

void DeviceRunner::write_outcome(const CutRecord& cut, const drivers::JobProgress& progress) {
    if (progress.outcome == JobOutcome::Done) {
        store_.cuts.finish_sheet(cut, counted(progress));
        forget_beam(store_, cut);
        spdlog::info("cut {}: sheet {} done", cut.id, cut.sheet());
        return;
    }
    CutState state = CutState::Failed;
    std::string reason = progress.reason;
    if (!trouble_.empty()) {
        reason = trouble_;
    } else if (progress.outcome == JobOutcome::Aborted) {
        state = CutState::Aborted;
    } else if (progress.outcome == JobOutcome::LinkLost) {
        state = CutState::Interrupted;
        reason = fmt::format("{}; {}", progress.reason, how_far(cut, progress, ended_beam_));
    }
    store_.cuts.record_progress(cut.id, counted(progress));
    if (ended_beam_) {
        store_.cuts.record_beam(cut.id, *ended_beam_);
    }
    store_.cuts.move(cut.id, cut.state, state, reason);
    spdlog::info("cut {}: {} {}", cut.id, to_string(state), reason);
}

void DeviceRunner::take_up_next() {
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

void DeviceRunner::take_up(const CutRecord& cut) {
    const drivers::DeviceStatus now = device()->status();
    if (now.state != MachineState::Idle) {
        // An armed cut must not fire later, when someone clears an alarm with hands in the bed.
        store_.cuts.move(
            cut.id, CutState::Armed, cut.before_arming(),
            fmt::format("the machine is not idle but {}", drivers::to_string(now.state)));
        return;
    }
    fire(cut);
}

void DeviceRunner::fire(const CutRecord& cut) {
    const std::string program = store_.blobs.read(cut.program_sha256);
    {
        const std::scoped_lock lock(mutex_);
        current_ = cut;
        abort_wanted_ = false;
        progress_ = {};
    }
    bool begun = false;
    try {
        begun = store_.cuts.begin_sheet(cut);
    } catch (...) {
        const std::scoped_lock lock(mutex_);
        current_.reset();
        throw;
    }
    drivers::JobProgress refused;
    {
        const std::scoped_lock lock(mutex_);
        if (!begun) {
            current_.reset();
            return;
        }
        current_->state = CutState::Cutting;
        refused.outcome = abort_wanted_ ? JobOutcome::Aborted : JobOutcome::Running;
    }
    word_given_ = false;
    if (refused.outcome == JobOutcome::Running) {
        try {
            spdlog::info("cut {}: sheet {} starts on {}", cut.id, cut.sheet(), record_.id);
            start_program(cut, program);
        } catch (const drivers::Refused& error) {
            refused.outcome = JobOutcome::Failed;
            refused.reason = error.what();
        } catch (const std::system_error& error) {
            refused.outcome = JobOutcome::Failed;
            refused.reason = fmt::format("the cut's journal can't be written: {}", error.what());
        }
    }
    next_record_ = {};
    if (refused.outcome != JobOutcome::Running) {
        settle(refused);
        return;
    }
    bool abort_now = false;
    {
        const std::scoped_lock lock(mutex_);
        abort_now = abort_wanted_;
    }
    if (abort_now) {
        device()->cancel();
    }
}

// Nothing is sent before it is in the cut's journal. A program, or a machine, that can't be
// followed is cut without one.
void DeviceRunner::start_program(const CutRecord& cut, const std::string& program) {
    const std::shared_ptr<drivers::Device> machine = device();
    const drivers::DeviceStatus status = machine->status();
    try {
        if (record_.uri.find("lihuiyu") == std::string::npos) {
            beam_ = std::make_unique<CutBeam>(store_, cut, program, status);
            machine->watch = beam_->watch();
        }
    } catch (const drivers::NotTraceable& error) {
        spdlog::warn("cut {}: its beam can't be followed: {}", cut.id, error.what());
    }
    machine->start(program);
}

void DeviceRunner::publish() {
    constexpr auto kShortestGap = 200ms;
    const Clock::time_point now = Clock::now();
    if (now < next_publish_) {
        return;
    }
    const std::optional<std::string> cut = current_cut();
    const std::string freedom = fmt::format("{} {}", is_ready(), cut.value_or(""));
    const std::string seen =
        fmt::format("{} {} {}", fingerprint(status()), freedom, progress_.lines_acknowledged);
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
        last.outcome = JobOutcome::LinkLost;
        last.reason = "the daemon was stopped";
    }
    settle(last);
}

}  // namespace leafcutter::server
