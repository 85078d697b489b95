// What a session does about what the controller doesn't say, and about answers that noise has
// changed.

#include <algorithm>

#include <fmt/format.h>

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
// Idle this long with lines unanswered: an answer is lost. The shorter time if we heard a garbled
// one.
constexpr milliseconds kStandingWait{1000};
constexpr milliseconds kHealWait{250};
constexpr milliseconds kQuietLink{250};  // After it, what was sent has arrived.
constexpr int kShortReports = 3;
constexpr milliseconds kBeamWait{300};
constexpr double kHoldMargin = 1.0;  // Seconds on top of the braking time.

}  // namespace

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
    if (duration<double>(now_ - *standing_since_ - (garbled_oks_ > 0 ? kHealWait : kStandingWait))
            .count() <= pending_dwell_s()) {
        return;
    }
    if (phase_ == Phase::Ready) {
        heal_or_fail("the machine stands");
    } else {
        begin_reset();
    }
}

// Grbl has neither line numbers nor checksums. A line that never arrived and an "ok" that never
// arrived look the same, so only what is known to have been an "ok" is made good: then nothing is
// skipped. Anything else ends the job.
void GrblSession::heal_or_fail(const std::string& what) {
    standing_since_.reset();
    short_reports_ = 0;
    if (garbled_oks_ >= pending_.size() || (garbled_oks_ > 0 && what.empty())) {
        for (; garbled_oks_ > 0 && !pending_.empty(); --garbled_oks_) {
            resolve_oldest();
        }
        garbled_oks_ = 0;
        return;
    }
    const std::string reason = fmt::format(
        "{}, but {} lines are unanswered, the oldest is line {} ({}): the link loses bytes", what,
        pending_.size(), pending_.front().number, pending_.front().text);
    status_.message = reason;
    end_job(JobOutcome::Failed, reason);
    begin_halt();
}

// Holds the count of bytes under way against what the controller says it has received and not yet
// read. While nothing is sent it has everything but the line that it works on.
void GrblSession::watch_buffer(const StatusReport& report) {
    if (!report.free_buffers || halt_ != Halt::None || phase_ != Phase::Ready) {
        return;
    }
    const auto free = static_cast<std::size_t>(std::max(0, (*report.free_buffers)[1]));
    if (pending_.empty()) {
        rx_capacity_ = std::max(rx_capacity_, free);
        garbled_oks_ = 0;
    }
    if (!job_runs() || rx_capacity_ < free || !reads_line_by_line()) {
        return;
    }
    const std::size_t held = rx_capacity_ - free;
    const std::size_t counted = protocol_.bytes_in_flight();
    if (held > counted) {
        // Only an "ok" too many explains that; noise has doubled it.
        ++answers_healed_;
        protocol_.take_back_answer(held - counted);
        pending_.push_front({Origin::Frame, "(doubled ok)", 0, false, 0.0});
        return;
    }
    const bool quiet = now_ - line_sent_ > kQuietLink;
    const bool is_short = quiet && counted > held + protocol_.oldest_line_bytes();
    short_reports_ = is_short ? short_reports_ + 1 : 0;
    if (short_reports_ >= kShortReports) {
        heal_or_fail(garbled_oks_ > 0 ? "" : "the controller has read everything");
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
