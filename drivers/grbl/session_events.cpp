// What a session does about what the controller says, and about what it doesn't.

#include <algorithm>
#include <cstdlib>

#include <fmt/format.h>

#include "drivers/grbl/firmware_tables.h"
#include "drivers/grbl/session.h"
#include "drivers/transport.h"

namespace leafcutter::drivers {

namespace {

using std::chrono::duration;
using std::chrono::milliseconds;

constexpr milliseconds kBannerWait{2000};  // An Uno's boot loader takes 1.5 s.
constexpr milliseconds kResetWait{1000};
constexpr milliseconds kSilenceInJob{2000};
constexpr milliseconds kSilence{5000};
constexpr int kUnansweredPolls = 5;
constexpr milliseconds kStandingWait{
    1000};  // Idle this long with lines unanswered: an answer is lost.
constexpr milliseconds kBeamWait{300};
constexpr milliseconds kStaleReport{300};
constexpr double kHoldMargin = 1.0;  // Seconds on top of the braking time.

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
        const std::string text = error_text_of_grbl(event.code);
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
        poll_soon();
    } else if (job_runs() && !cancelling_ && job_.empty() && pending_.empty()) {
        finishing_ = true;
        poll_soon();
    }
}

void GrblSession::handle_alarm(const GrblEvent& event) {
    status_.state = MachineState::Alarm;
    status_.alarm_code = event.code;
    status_.message = alarm_text(event.code);
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
    status_.firmware = event.text.substr(0, event.text.find(" ["));
    critical_alarm_ = false;
    resume_wanted_ = false;
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
    if (text.substr(0, 5) == "[OPT:") {
        const std::size_t first = text.find(',');
        const std::size_t second = first == std::string::npos ? first : text.find(',', first + 1);
        build_options_ = text.substr(5, first == std::string::npos ? first : first - 5);
        if (second != std::string::npos) {
            status_.planner_blocks =
                static_cast<std::size_t>(std::strtoul(text.c_str() + first + 1, nullptr, 10)) + 1;
            const auto rx =
                static_cast<std::size_t>(std::strtoul(text.c_str() + second + 1, nullptr, 10));
            // One byte below what it claims, and never below what every Grbl has.
            protocol_.set_rx_buffer_bytes(
                rx > GrblProtocol::kSafeRxBytes ? rx - 1 : GrblProtocol::kSafeRxBytes);
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
    if (phase_ == Phase::Greeting) {
        attach_by(report);
        return;
    }
    halt_by(report);
    const bool stopped = report.state == MachineState::Hold || report.state == MachineState::Door;
    if (resume_wanted_ && stopped && report.sub_state.value_or(0) == 0) {
        send_realtime('~');
    } else if (report.state == MachineState::Run || report.state == MachineState::Idle) {
        resume_wanted_ = false;
    }
    watch_standing_beam(report);
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

double GrblSession::pending_dwell_s() const {
    double sum = 0.0;
    for (const Pending& line : pending_) {
        sum += line.dwell_s;
    }
    return sum;
}

// A swallowed or garbled "ok" shows as a machine that stands idle while we still wait for answers.
void GrblSession::watch_lost_answer(const StatusReport& report) {
    const bool idle = report.state == MachineState::Idle || report.state == MachineState::Check;
    if (!idle || pending_.empty() || halt_ != Halt::None) {
        standing_since_.reset();
        return;
    }
    if (!standing_since_) {
        standing_since_ = now_;
    }
    if (duration<double>(now_ - *standing_since_ - kStandingWait).count() <= pending_dwell_s()) {
        return;
    }
    const std::string what = fmt::format(
        "the machine stands, but {} lines are unanswered, the oldest is line {} ({}): "
        "the link loses bytes",
        pending_.size(), pending_.front().number, pending_.front().text);
    if (phase_ == Phase::Ready) {
        status_.message = what;
        end_job(JobOutcome::Failed, what);
        begin_halt();
    } else {
        begin_reset();
    }
}

void GrblSession::watch_standing_beam(const StatusReport& report) {
    const bool stands = report.state == MachineState::Idle ||
                        (report.state == MachineState::Hold && report.sub_state.value_or(0) == 0);
    if (!stands || report.power_s.value_or(0.0) <= 0.0 || halt_ == Halt::Resetting) {
        beam_stands_since_.reset();
        return;
    }
    if (!beam_stands_since_) {
        beam_stands_since_ = now_;
    }
    if (duration<double>(now_ - *beam_stands_since_ - kBeamWait).count() > pending_dwell_s()) {
        beam_stands_since_.reset();
        status_.message = "the beam was lit while the machine stood; it was reset";
        end_job(JobOutcome::Failed, status_.message);
        begin_reset();
    }
}

void GrblSession::watch_silence() const {
    const bool homing = !pending_.empty() && pending_.front().text == "$H";
    if (homing || critical_alarm_ || status_.state == MachineState::Home ||
        unanswered_polls_ < kUnansweredPolls) {
        return;
    }
    if (now_ - heard_ > (job_runs() ? kSilenceInJob : kSilence)) {
        throw LinkLost(
            phase_ == Phase::Ready
                ? "the controller has fallen silent: it answers no status query"
                : "no answer: is it a Grbl controller, is it switched on, is the baud rate right?");
    }
}

void GrblSession::watch_attach() {
    const bool greeting = phase_ == Phase::Greeting && status_.state == MachineState::Unknown;
    if ((greeting && now_ - phase_since_ > kBannerWait) ||
        (phase_ == Phase::Resetting && now_ - phase_since_ > kResetWait)) {
        begin_reset();
    }
}

void GrblSession::watch_halt() {
    if (halt_ == Halt::Holding) {
        const double speed = std::max(settings_value(110, 0.0), settings_value(111, 0.0)) / 60.0;
        const double acceleration =
            std::max(1.0, std::min(settings_value(120, 10.0), settings_value(121, 10.0)));
        if (duration<double>(now_ - halt_since_).count() > speed / acceleration + kHoldMargin) {
            begin_reset();
        }
    } else if (halt_ == Halt::Resetting && now_ - halt_since_ > kResetWait) {
        begin_reset();
    }
}

}  // namespace leafcutter::drivers
