#include "drivers/marlin/session.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "drivers/gcode_words.h"

namespace leafcutter::drivers {

namespace {

constexpr char kReset = 0x18;

// Smoothieware's own shell hears a line only without a number, and answers without an ok.
bool is_shell_line(std::string_view line) {
    return line[0] == '$' || (line[0] >= 'a' && line[0] <= 'z');
}

}  // namespace

MarlinSession::MarlinSession(Firmware firmware, Time now, const MarlinOptions& options)
    : firmware_(firmware),
      options_(options),
      now_(now),
      phase_since_(now),
      heard_(now),
      answered_(now) {
    progress_.outcome = JobOutcome::Done;
    status_.state = MachineState::Unknown;
}

void MarlinSession::receive(std::string_view bytes, Time now) {
    now_ = now;
    if (!bytes.empty()) {
        heard_ = now;
    }
    for (const MarlinEvent& event : protocol_.receive(bytes)) {
        lines_.push_back(event.text);
        handle(event);
    }
}

void MarlinSession::tick(Time now) {
    now_ = now;
    if (phase_ == Phase::Gone) {
        return;
    }
    watch_silence();
    watch_attach();
    quick_stop();
    nudge();
    poll();
    fill();
}

std::string MarlinSession::take_output() {
    return std::exchange(output_, {});
}

std::vector<std::string> MarlinSession::take_lines() {
    return std::exchange(lines_, {});
}

bool MarlinSession::may_close() const {
    if (phase_ == Phase::Gone || phase_ == Phase::Killed) {
        return true;
    }
    const auto of_poll = [](const Pending& line) { return line.origin == Origin::Poll; };
    return !job_runs() && !cancelling_ && commands_.empty() && again_.empty() &&
           std::all_of(pending_.begin(), pending_.end(), of_poll);
}

std::string_view MarlinSession::last_words() const {
    return smoothie() ? "\x18" : "M112\n";
}

// ---- Commands ----

void MarlinSession::require_ready(std::string_view what) const {
    if (phase_ == Phase::Gone) {
        throw Refused(fmt::format("{}: the machine is disconnected", what));
    }
    if (phase_ == Phase::Killed) {
        throw Refused(fmt::format("{}: the controller was halted; {}", what,
                                  smoothie() ? "unlock it first" : "reset the board first"));
    }
    if (phase_ != Phase::Ready) {
        throw Refused(fmt::format("{}: the machine has not answered yet", what));
    }
    if (job_runs() || cancelling_) {
        throw Refused(fmt::format("{}: a program runs; cancel it first", what));
    }
}

void MarlinSession::start(std::string_view text) {
    require_ready("start");
    const auto by_hand = [](const Pending& line) { return line.origin == Origin::Command; };
    if (std::any_of(commands_.begin(), commands_.end(), by_hand) ||
        status_.state != MachineState::Idle) {
        throw Refused(fmt::format("start: the machine is busy ({}); it must be idle",
                                  to_string(status_.state)));
    }
    Program program = read_program(text);
    preflight(program, facts());
    progress_ = {JobOutcome::Running, program.lines.size(), 0, 0, {}};
    status_.message.clear();
    status_.state = MachineState::Run;
    holding_ = false;
    // The modes a program may take for granted, whatever was typed by hand before it.
    job_.push_back({Origin::Frame, "G21", 0, 0});
    job_.push_back({Origin::Frame, "G90", 0, 0});
    for (ProgramLine& line : program.lines) {
        job_.push_back({Origin::Job, std::move(line.text), line.number, 0});
    }
    // Answered once every move has ended.
    job_.push_back({Origin::Frame, "M400", 0, 0});
    fill();
}

MachineFacts MarlinSession::facts() const {
    constexpr double kMarlinFull = 255.0;
    MachineFacts facts;
    facts.beam = smoothie() ? BeamCommand::None : BeamCommand::InlineM4;
    facts.s_max = options_.s_max.value_or(smoothie() ? 1.0 : kMarlinFull);
    facts.power_cap_percent = options_.power_cap_percent;
    const Area area = area_.value_or(Area{{}, options_.bed_mm});
    facts.travel_mm = area.size_mm;
    facts.work_position_mm = {status_.work_position_mm[0], status_.work_position_mm[1]};
    if (!origin_moved_) {
        facts.origin_in_travel_mm = {-area.least_mm[0], -area.least_mm[1]};
    }
    return facts;
}

void MarlinSession::hold() {
    if (!job_runs() || holding_ || cancelling_) {
        return;
    }
    holding_ = true;
    status_.state = MachineState::Hold;
    status_.message = "holds once the moves under way have ended";
    put_beam_out();
    fill();
}

void MarlinSession::resume() {
    if (!holding_) {
        return;
    }
    holding_ = false;
    status_.message.clear();
    status_.state = MachineState::Run;
    restore_beam();
    fill();
}

void MarlinSession::cancel() {
    if (phase_ != Phase::Ready || (!job_runs() && commands_.empty() && pending_.empty())) {
        return;
    }
    job_.clear();
    commands_.clear();
    if (smoothie()) {
        stop();
        return;
    }
    cancelling_ = job_runs();
    holding_ = false;
    quick_stop_due_ = emergency_parser_;
    put_beam_out();
    fill();
}

void MarlinSession::stop() {
    if (phase_ == Phase::Gone) {
        return;
    }
    output_.clear();  // What is not yet on the wire stays off it.
    output_ += smoothie() ? std::string(1, kReset) : "M112\n";
    phase_ = Phase::Killed;
    forget_lines();
    end_job(JobOutcome::Aborted, "stopped");
    status_.state = MachineState::Alarm;
    status_.message =
        smoothie() ? "halted: unlock it, then home" : "halted by M112: reset the board, then home";
}

void MarlinSession::home() {
    require_ready("home");
    status_.state = MachineState::Home;
    const bool park = smoothie() && grbl_mode_;  // There a plain G28 only parks.
    submit(smoothie() ? (park ? "G28.2 X0 Y0" : "G28 X0 Y0") : "G28 X Y");
    submit("M400");
}

void MarlinSession::unlock() {
    if (phase_ == Phase::Killed && smoothie()) {
        phase_ = Phase::Unlocking;
        phase_since_ = now_;
        output_ += "M999\n";
        return;
    }
    require_ready("unlock");
    submit("M999");
}

void MarlinSession::jog(const Jog& jog) {
    require_ready("jog");
    if (status_.state != MachineState::Idle && status_.state != MachineState::Jog) {
        throw Refused(fmt::format("jog: the machine is not idle ({})", to_string(status_.state)));
    }
    if (!(jog.feed_mm_per_min > 0.0)) {
        throw Refused("jog: the feed must be above 0");
    }
    status_.state = MachineState::Jog;
    submit("M5");
    submit("G91");
    submit(fmt::format("G0 X{:.3f} Y{:.3f} F{:.1f}", jog.dx_mm, jog.dy_mm, jog.feed_mm_per_min));
    submit("G90");
    submit("M400");
}

void MarlinSession::jog_cancel() {
    if (status_.state != MachineState::Jog) {
        return;
    }
    const auto is_move = [](const Pending& line) { return line.text.substr(0, 2) == "G0"; };
    commands_.erase(std::remove_if(commands_.begin(), commands_.end(), is_move), commands_.end());
    if (emergency_parser_) {
        send_unnumbered("M410");
    }
}

void MarlinSession::console(std::string_view line) {
    const std::size_t first = line.find_first_not_of(" \t\r\n");
    const std::size_t last = line.find_last_not_of(" \t\r\n");
    line =
        first == std::string_view::npos ? std::string_view{} : line.substr(first, last - first + 1);
    if (line.empty()) {
        return;
    }
    if (line == "M112" || line == "\x18") {
        stop();
        return;
    }
    require_ready("console");
    if (smoothie() && is_shell_line(line)) {
        console_shell(line);
        return;
    }
    try {
        numbered_line(next_number_ + commands_.size(), line);
    } catch (const std::invalid_argument& wrong) {
        throw Refused(fmt::format("console: {}", wrong.what()));
    }
    constexpr std::string_view kMoveOrigin[] = {"G92", "M206", "M428", "G54", "G55",
                                                "G56", "G57",  "G58",  "G59", "G10"};
    const std::string stripped = strip_gcode(line);
    origin_moved_ =
        origin_moved_ ||
        std::any_of(std::begin(kMoveOrigin), std::end(kMoveOrigin), [&](std::string_view word) {
            return stripped.find(word) != std::string::npos;
        });
    submit(std::string(line));
}

void MarlinSession::console_shell(std::string_view line) {
    constexpr std::string_view kFire = "fire";
    const bool fires = line.substr(0, kFire.size()) == kFire;
    const std::string_view rest = line.substr(std::min(kFire.size() + 1, line.size()));
    if (fires && rest != "off" && rest != "status" && rest.find(' ') == std::string_view::npos) {
        throw Refused("console: fire needs a time (\"fire 10 200\": 10 % for 200 ms), or off");
    }
    output_ += fmt::format("{}\n", line);
}

void MarlinSession::lose_link(const std::string& reason) {
    end_job(JobOutcome::LinkLost, reason);
    forget_lines();
    output_.clear();
    phase_ = Phase::Gone;
    status_.state = MachineState::Disconnected;
    status_.message = reason;
}

void MarlinSession::submit(std::string line) {
    commands_.push_back({Origin::Command, std::move(line), 0, 0});
    fill();
}

// ---- Ending ----

void MarlinSession::end_job(JobOutcome outcome, std::string reason) {
    job_.clear();
    holding_ = cancelling_ = false;
    beam_line_.clear();
    power_word_.clear();
    if (job_runs()) {
        progress_.outcome = outcome;
        progress_.reason = std::move(reason);
        if (outcome != JobOutcome::Done) {
            status_.message = progress_.reason;
        }
    }
}

void MarlinSession::forget_lines() {
    pending_.clear();
    history_.clear();
    again_.clear();
    commands_.clear();
    quick_stop_due_ = idle_told_ = false;
    positions_owed_ = positions_heard_ = counted_to_ = 0;
}

}  // namespace leafcutter::drivers
