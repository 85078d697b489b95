// What a session does about what the controller says, and about what it doesn't.

#include <algorithm>
#include <cstdlib>

#include <fmt/format.h>

#include "drivers/grbl/firmware_tables.h"
#include "drivers/grbl/session.h"
#include "drivers/transport.h"

namespace leafcutter::drivers {

namespace {

using std::chrono::milliseconds;

constexpr milliseconds kStaleReport{300};

}  // namespace

void GrblSession::handle(const GrblEvent& event) {
    switch (event.kind) {
        case GrblEvent::Kind::Ack:
        case GrblEvent::Kind::Error:
            handle_answer(event);
            break;
        case GrblEvent::Kind::Alarm:
            handle_alarm(event);
            break;
        case GrblEvent::Kind::Banner:
            handle_banner(event);
            break;
        case GrblEvent::Kind::Setting:
            handle_setting(event.text);
            break;
        case GrblEvent::Kind::Message:
            handle_message(event);
            break;
        case GrblEvent::Kind::Status:
            if (const auto report = parse_status_report(event.text)) {
                handle_status(*report);
            }
            break;
        case GrblEvent::Kind::Garbled:
        case GrblEvent::Kind::GarbledError:
            handle_garbled(event);
            break;
        case GrblEvent::Kind::Other:
            break;
    }
}

void GrblSession::handle_answer(const GrblEvent& event) {
    standing_since_.reset();
    if (pending_.empty()) {
        return;
    }
    const Pending line = pending_.front();
    pending_.pop_front();
    if (line.origin == Origin::Job) {
        ++progress_.lines_acknowledged;
    }
    if (event.kind == GrblEvent::Kind::Ack && line.text[0] == '$') {
        handle_setting(line.text);  // Written by hand.
    }
    if (event.kind == GrblEvent::Kind::Error) {
        const std::string text = error_text(firmware_.kind(), event.code);
        if (line.origin == Origin::Command) {
            status_.message = line.text + ": " + text;
        } else if (job_runs() && !cancelling_) {
            end_job(JobOutcome::Failed,
                    fmt::format("line {} ({}): {}", line.number, line.text, text));
            begin_halt();
        }
    }
    if (phase_ == Phase::AskingVersion) {
        phase_ = Phase::AskingSettings;
        send_line({Origin::Command, "$$", 0, true, 0.0});
    } else if (phase_ == Phase::AskingSettings) {
        phase_ = Phase::Ready;
        reported_ = false;
        poll_soon();
    } else if (job_runs() && !cancelling_ && job_.empty() && pending_.empty()) {
        finishing_ = true;
        poll_soon();
    }
}

// An "ok" with a flipped or lost byte is kept as evidence, and counted once the controller shows
// that it has nothing left to answer. What may have been an error stops the job.
void GrblSession::handle_garbled(const GrblEvent& event) {
    if (pending_.empty() || !job_runs()) {
        return;
    }
    if (event.kind == GrblEvent::Kind::Garbled) {
        ++garbled_oks_;
        poll_soon();
        return;
    }
    end_job(JobOutcome::Failed,
            fmt::format("the answer \"{}\" near line {} ({}) is garbled and may have been an "
                        "error: the link loses bytes",
                        event.text, pending_.front().number, pending_.front().text));
    begin_halt();
}

// As if the oldest line's "ok" had been heard.
void GrblSession::resolve_oldest() {
    ++answers_healed_;
    protocol_.resolve_oldest();
    GrblEvent answer;
    answer.kind = GrblEvent::Kind::Ack;
    answer.text = "ok";
    handle_answer(answer);
}

void GrblSession::handle_alarm(const GrblEvent& event) {
    status_.state = MachineState::Alarm;
    status_.alarm_code = event.code;
    status_.message = alarm_text(firmware_.kind(), event.code);
    critical_alarm_ = event.code == 1 || event.code == 2;
    const std::string place =
        pending_.empty()
            ? ""
            : fmt::format(", near line {} ({})", pending_.front().number, pending_.front().text);
    end_job(JobOutcome::Failed, status_.message + place);
    commands_.clear();
    if (halt_ != Halt::Resetting && phase_ != Phase::Resetting) {
        begin_reset();  // Alarms 1 and 2 serve nothing else; any other leaves its buffer behind.
    }
}

void GrblSession::handle_banner(const GrblEvent& event) {
    firmware_.take(event.text);
    status_.firmware = firmware_.name();
    critical_alarm_ = false;
    resume_wanted_ = false;
    wanted_overrides_.reset();
    status_.override_percent = {100, 100, 100};
    forget_lines();
    const bool expected = halt_ != Halt::None || phase_ != Phase::Ready;
    status_.restarts += expected ? 0 : 1;
    halt_ = Halt::None;
    poll_soon();
    if (cancelling_) {
        end_job(JobOutcome::Aborted, "cancelled");
    } else if (job_runs()) {
        end_job(JobOutcome::Failed,
                "the controller restarted during the program; its position is lost, home it");
    }
    if (expected && phase_ == Phase::Ready) {
        return;
    }
    phase_ = Phase::AskingVersion;
    phase_since_ = now_;
    commands_.clear();
    send_line({Origin::Command, "$I", 0, true, 0.0});
}

// "$n=value"; anything else is left alone.
void GrblSession::handle_setting(const std::string& text) {
    const std::size_t equals = text.find('=');
    char* end = nullptr;
    const long number = std::strtol(text.c_str() + 1, &end, 10);
    if (equals != std::string::npos && equals > 1 && end == text.c_str() + equals) {
        settings_[static_cast<int>(number)] = std::strtod(text.c_str() + equals + 1, nullptr);
    }
}

void GrblSession::handle_message(const GrblEvent& event) {
    const std::string& text = event.text;
    if (phase_ == Phase::AskingVersion) {
        firmware_.take(text);
        status_.firmware = firmware_.name();
        protocol_.set_rx_buffer_bytes(firmware_.receive_budget());
        protocol_.set_longest_line(firmware_.longest_line());
        if (firmware_.planner_blocks() > 0) {
            // The line being read, and one that a doubled "ok" may have counted too early.
            status_.planner_blocks = firmware_.planner_blocks() + 2;
        }
    } else if (text.substr(0, 5) == "[MSG:" && !job_runs()) {
        status_.message = text.substr(5, text.size() - 6);
    }
}

void GrblSession::handle_status(const StatusReport& report) {
    status_.state = report.state;
    ++status_.reports;
    sub_state_ = report.sub_state;
    if (report.state != MachineState::Alarm && status_.alarm_code != 0) {
        status_.alarm_code = 0;
    }
    status_.feed_mm_per_min = report.feed.value_or(status_.feed_mm_per_min);
    status_.power_s = report.power_s.value_or(status_.power_s);
    status_.override_percent = report.override_percent.value_or(status_.override_percent);
    take_positions(report);
    constexpr milliseconds kOverrideWait{1500};  // It is reported by then, or it was lost.
    if (report.override_percent == expected_overrides_ ||
        now_ - overrides_stepped_ > kOverrideWait) {
        step_overrides();
    }
    if (phase_ == Phase::Greeting) {
        attach_by(report);
        return;
    }
    reported_ = reported_ || phase_ == Phase::Ready;
    halt_by(report);
    const bool stopped = report.state == MachineState::Hold || report.state == MachineState::Door;
    if (resume_wanted_ && stopped && report.sub_state.value_or(0) == 0) {
        send_realtime('~');
    } else if (report.state == MachineState::Run || report.state == MachineState::Idle) {
        resume_wanted_ = false;
    }
    watch_standing_beam(report);
    watch_buffer(report);
    watch_lost_answer(report);
    if (job_runs() && finishing_ && report.state == MachineState::Idle) {
        end_job(JobOutcome::Done, {});
    }
}

void GrblSession::take_positions(const StatusReport& report) {
    const double unit = settings_value(13, 0.0) != 0.0 ? 25.4 : 1.0;
    status_.feed_mm_per_min *= report.feed ? unit : 1.0;
    if (report.work_offset) {
        work_offset_ = *report.work_offset;
        for (double& part : *work_offset_) {
            part *= unit;
        }
    }
    const std::array<double, 3> offset = work_offset_.value_or(std::array<double, 3>{});
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (report.machine_position) {
            status_.machine_position_mm[axis] = (*report.machine_position)[axis] * unit;
            status_.work_position_mm[axis] = status_.machine_position_mm[axis] - offset[axis];
        } else if (report.work_position) {
            status_.work_position_mm[axis] = (*report.work_position)[axis] * unit;
            status_.machine_position_mm[axis] = status_.work_position_mm[axis] + offset[axis];
        }
    }
}

// A controller that didn't restart when the port was opened may still be at someone's job: brought
// to a stand first, so that the reset costs no position.
void GrblSession::attach_by(const StatusReport& report) {
    const bool slowing =
        (report.state == MachineState::Hold || report.state == MachineState::Door) &&
        report.sub_state.value_or(0) != 0;
    if (report.state == MachineState::Run || report.state == MachineState::Jog) {
        send_realtime('!');
    } else if (!slowing && report.state != MachineState::Home) {
        begin_reset();
    }
}

void GrblSession::halt_by(const StatusReport& report) {
    if (halt_ != Halt::Holding) {
        return;
    }
    const bool held = report.state == MachineState::Hold || report.state == MachineState::Door;
    const bool stands_otherwise =
        report.state == MachineState::Alarm || report.state == MachineState::Sleep;
    // An Idle may have been said before the hold arrived.
    const bool rests =
        (report.state == MachineState::Idle || report.state == MachineState::Check) &&
        now_ - halt_since_ > kStaleReport;
    if ((held && report.sub_state == 0) || stands_otherwise || rests) {
        begin_reset();
    }
}

}  // namespace leafcutter::drivers
