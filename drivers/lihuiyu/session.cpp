#include "drivers/lihuiyu/session.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "drivers/lihuiyu/egv.h"
#include "drivers/transport.h"

namespace leafcutter::drivers {

namespace {

using std::chrono::seconds;

constexpr std::string_view kNotHomed =
    "nobody knows where the head stands (the board can't tell): home the machine first";

}  // namespace

LihuiyuSession::LihuiyuSession(const EncoderOptions& options, Time now)
    : options_(options),
      now_(now),
      asked_at_(now - seconds(1)),
      quiet_until_(now),
      status_since_(now),
      sent_at_(now),
      motion_end_(now),
      held_since_(now),
      stopping_since_(now) {
    status_.firmware =
        fmt::format("Lihuiyu {} (power: by the machine's knob)", to_string(options.speed.board));
    status_.message = kNotHomed;
    status_.state = MachineState::Unknown;
}

bool LihuiyuSession::may_close() const {
    return gone_ || (!job_runs() && !in_flight_ && packets_.empty() && !stopping_);
}

// ---- Commands ----

void LihuiyuSession::require_connected(std::string_view what) const {
    if (gone_ || !attached_) {
        throw Refused(fmt::format("{}: the machine is not connected", what));
    }
}

void LihuiyuSession::require_idle(std::string_view what) const {
    require_connected(what);
    if (job_runs()) {
        throw Refused(fmt::format("{}: a job is running", what));
    }
    if (stopping_ || moving_by_hand_) {
        throw Refused(fmt::format("{}: the machine is still moving; wait until it stands", what));
    }
}

void LihuiyuSession::require_homed(std::string_view what) const {
    require_connected(what);
    if (!homed_ && !homing_) {
        throw NotHomed(std::string(kNotHomed));
    }
}

void LihuiyuSession::queue(const Payload& payload, Purpose purpose) {
    packets_.push_back({payload, purpose, 0.0, std::nullopt});
}

void LihuiyuSession::start(std::string_view program) {
    require_homed("start");
    require_idle("start");
    const EncodedJob job = encode_job(read_program_moves(program, options_), place_, options_);
    for (const JobPacket& packet : job.packets) {
        packets_.push_back({packet.payload, Purpose::Job, packet.seconds, packet.end});
    }
    progress_ = {};
    progress_.outcome = JobOutcome::Running;
    progress_.lines_total = job.packets.size();
    finishing_ = finish_told_ = false;
    holding_ = held_ = board_holds_ = false;
    status_.message.clear();
    motion_end_ = now_;
    show_state();
}

void LihuiyuSession::hold() {
    if (!job_runs()) {
        throw Refused("hold: no job is running");
    }
    holding_ = true;
    show_state();
}

void LihuiyuSession::resume() {
    if (!job_runs() || !holding_) {
        throw Refused("resume: the machine isn't on hold");
    }
    holding_ = false;
    show_state();
}

void LihuiyuSession::cancel() {
    if (job_runs() || moving_by_hand_) {
        begin_stop("cancelled; the place of the head is lost, home the machine",
                   JobOutcome::Aborted);
    }
}

void LihuiyuSession::stop() {
    begin_stop("stopped; the place of the head is lost, home the machine", JobOutcome::Aborted);
}

void LihuiyuSession::home() {
    require_idle("home");
    homed_ = false;
    homing_ = moving_by_hand_ = true;
    homing_since_.reset();
    // What some host left half done would take the next bytes for its own: forget it first.
    queue(make_payload("I"), Purpose::Home);
    queue(make_payload("IPP"), Purpose::Home);
    show_state();
}

void LihuiyuSession::unlock() {
    require_idle("unlock");
    homed_ = false;
    queue(make_payload("IS2P"), Purpose::Rails);
    status_.message = kNotHomed;
    show_state();
}

void LihuiyuSession::jog(const Jog& jog) {
    require_homed("jog");
    require_idle("jog");
    const LihuiyuBed& bed = options_.bed;
    const StepPlace to{place_.x + std::lround(jog.dx_mm * bed.steps_per_mm),
                       place_.y - std::lround(jog.dy_mm * bed.steps_per_mm)};
    const bool inside = to.x >= 0 && to.y >= 0 &&
                        to.x <= std::lround(bed.width_mm * bed.steps_per_mm) &&
                        to.y <= std::lround(bed.height_mm * bed.steps_per_mm);
    if (!inside) {
        throw Refused("jog: that place is off the bed, and the board has no limit switches there");
    }
    for (const Payload& payload : encode_rapid(place_, to)) {
        queue(payload, Purpose::Jog);
    }
    const double way_mm = std::hypot(jog.dx_mm, jog.dy_mm);
    packets_.back().seconds = way_mm / options_.rapid_mm_per_s;
    packets_.back().end = to;
    moving_by_hand_ = true;
    show_state();
}

// The board can't end a rapid move without losing its place, and none takes long.
void LihuiyuSession::jog_cancel() {}

void LihuiyuSession::console(std::string_view line) {
    if (line == "IPP") {
        home();
    } else if (line == "IS2P") {
        unlock();
    } else if (line == "IS1P") {
        require_idle("console");
        queue(make_payload(line), Purpose::Rails);
    } else {
        throw Refused(fmt::format(
            "console: \"{}\" is not for typing; known are IPP (home), IS1P and IS2P (rails)",
            line));
    }
}

// ---- Ending ----

void LihuiyuSession::begin_stop(const std::string& reason, JobOutcome outcome) {
    if (gone_) {
        return;
    }
    end_job(outcome, reason);
    packets_.clear();
    in_flight_.reset();
    homed_ = homing_ = moving_by_hand_ = finishing_ = false;
    holding_ = held_ = board_holds_ = false;
    status_.message = reason;
    stopping_ = true;
    stopping_since_ = now_;
    write({make_payload("I"), Purpose::Stop, 0.0, std::nullopt});
    show_state();
}

void LihuiyuSession::end_job(JobOutcome outcome, const std::string& reason) {
    if (job_runs()) {
        progress_.outcome = outcome;
        progress_.reason = reason;
    }
}

void LihuiyuSession::lose_link(const std::string& reason) {
    end_job(JobOutcome::LinkLost, reason);
    gone_ = true;
    attached_ = homed_ = false;
    packets_.clear();
    in_flight_.reset();
    status_.message = reason;
    status_.state = MachineState::Disconnected;
}

std::string_view LihuiyuSession::last_words() const {
    static const std::string stop = wire_bytes(make_payload("I"));
    return stop;
}

std::string LihuiyuSession::take_output() {
    return std::exchange(output_, {});
}

std::vector<std::string> LihuiyuSession::take_lines() {
    return std::exchange(lines_, {});
}

void LihuiyuSession::show_state() {
    const PlaceMm place = to_program_mm(options_.bed, place_);
    status_.work_position_mm = {place.x_mm, place.y_mm, 0.0};
    status_.machine_position_mm = {static_cast<double>(place_.x) / options_.bed.steps_per_mm,
                                   static_cast<double>(place_.y) / options_.bed.steps_per_mm, 0.0};
    if (gone_) {
        status_.state = MachineState::Disconnected;
    } else if (!attached_) {
        status_.state = MachineState::Unknown;
    } else if (job_runs()) {
        status_.state = held_ ? MachineState::Hold : MachineState::Run;
    } else if (homing_) {
        status_.state = MachineState::Home;
    } else if (moving_by_hand_) {
        status_.state = MachineState::Jog;
    } else {
        status_.state = homed_ && !stopping_ ? MachineState::Idle : MachineState::Alarm;
    }
}

}  // namespace leafcutter::drivers
