// The part of DeviceRunner that lets a cut loose, follows it and writes down its end.

#include <stdexcept>
#include <system_error>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "server/queue/device_runner.h"

namespace leafcutter::server {

using namespace std::chrono_literals;
using drivers::JobOutcome;
using drivers::MachineState;

namespace {

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

}  // namespace

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
    {
        const std::scoped_lock settling(settling_);
        write_outcome(cut, progress);
        const std::scoped_lock lock(mutex_);
        current_.reset();
        abort_wanted_ = false;
    }
    ended_beam_.reset();
    trouble_.clear();
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
    store_.cuts.reclaim(cut);  // Where the fleet had lost sight of this station.
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

}  // namespace leafcutter::server
