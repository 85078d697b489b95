#include "drivers/grbl/session.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "drivers/gcode_words.h"

namespace leafcutter::drivers {

namespace {

using std::chrono::milliseconds;

constexpr char kReset = 0x18;
constexpr char kJogCancel = static_cast<char>(0x85);
constexpr milliseconds kFastPollInterval{100};

constexpr bool moves(MachineState state) {
    return state == MachineState::Run || state == MachineState::Jog || state == MachineState::Home;
}

}  // namespace

GrblSession::GrblSession(Time now, const GrblOptions& options)
    : now_(now), phase_since_(now), halt_since_(now), heard_(now), options_(options) {
    progress_.outcome = JobOutcome::Done;
    status_.state = MachineState::Unknown;
}

void GrblSession::receive(std::string_view bytes, Time now) {
    now_ = now;
    if (!bytes.empty()) {
        heard_ = now;
        unanswered_polls_ = 0;
    }
    // Line by line: what a report says is held against the count of its own moment.
    while (!bytes.empty()) {
        const std::size_t end = std::min(bytes.find('\n'), bytes.size() - 1) + 1;
        for (const GrblEvent& event : protocol_.receive(bytes.substr(0, end))) {
            lines_.push_back(event.text);
            handle(event);
        }
        bytes.remove_prefix(end);
    }
}

void GrblSession::tick(Time now) {
    now_ = now;
    if (phase_ == Phase::Gone) {
        return;
    }
    watch_silence();
    watch_attach();
    watch_halt();
    poll();
    fill();
}

std::string GrblSession::take_output() {
    return std::exchange(output_, {});
}

std::vector<std::string> GrblSession::take_lines() {
    return std::exchange(lines_, {});
}

bool GrblSession::may_close() const {
    if (phase_ == Phase::Gone) {
        return true;
    }
    return !job_runs() && halt_ == Halt::None && !moves(status_.state) && pending_.empty();
}

// ---- Commands ----

void GrblSession::require_ready(std::string_view what) const {
    if (phase_ == Phase::Gone) {
        throw Refused(fmt::format("{}: the machine is disconnected", what));
    }
    if (phase_ != Phase::Ready) {
        throw Refused(fmt::format("{}: the machine has not answered yet", what));
    }
    if (job_runs()) {
        throw Refused(fmt::format("{}: a program runs; cancel it first", what));
    }
    if (halt_ != Halt::None) {
        throw Refused(fmt::format("{}: the machine is being stopped; try again in a moment", what));
    }
}

void GrblSession::start(std::string_view text) {
    require_ready("start");
    if (status_.state == MachineState::Alarm) {
        throw Refused("start: the machine is locked by an alarm; home or unlock it first");
    }
    if (status_.state != MachineState::Idle || !pending_.empty() || !commands_.empty()) {
        throw Refused(fmt::format("start: the machine is busy ({}); it must be idle",
                                  to_string(status_.state)));
    }
    Program program = read_program(text, protocol_.longest_line());
    preflight(program, facts());
    wanted_overrides_.reset();
    progress_ = {JobOutcome::Running, program.lines.size(), 0, 0, {}};
    status_.message.clear();
    finishing_ = cancelling_ = false;
    // The modes a program may take for granted, whatever was typed by hand before it.
    job_.push_back({Origin::Frame, "G17G21G40G90G94", 0, false, 0.0});
    job_.push_back({Origin::Frame, "M5S0", 0, false, 0.0});
    for (ProgramLine& line : program.lines) {
        job_.push_back({Origin::Job, std::move(line.text), line.number, line.alone, line.dwell_s});
    }
    // Its answer comes when the planner is empty (Grbl's own barrier).
    job_.push_back({Origin::Frame, "G4P0.01", 0, false, 0.01});
    fill();
}

void GrblSession::hold() {
    resume_wanted_ = false;
    if (job_runs() || moves(status_.state)) {
        send_realtime('!');
    }
}

void GrblSession::resume() {
    const bool held = status_.state == MachineState::Hold || status_.state == MachineState::Door;
    if (halt_ == Halt::None && (held || job_runs())) {
        resume_wanted_ = true;  // Grbl ignores '~' while it still slows down: sent once it stands.
        poll_soon();
    }
}

void GrblSession::cancel() {
    const bool held = status_.state == MachineState::Hold || status_.state == MachineState::Door;
    if (phase_ == Phase::Gone || (!job_runs() && !held && !moves(status_.state))) {
        return;
    }
    cancelling_ = job_runs();
    begin_halt();
}

void GrblSession::stop() {
    if (phase_ == Phase::Gone) {
        return;
    }
    output_.clear();  // What is not yet on the wire stays off it.
    begin_reset();
    end_job(JobOutcome::Aborted, "stopped");
}

void GrblSession::home() {
    require_ready("home");
    submit("$H");
}

void GrblSession::unlock() {
    require_ready("unlock");
    submit("$X");
}

void GrblSession::jog(const Jog& jog) {
    require_ready("jog");
    if (status_.state != MachineState::Idle && status_.state != MachineState::Jog) {
        throw Refused(fmt::format("jog: the machine is not idle ({})", to_string(status_.state)));
    }
    if (!(jog.feed_mm_per_min > 0.0)) {
        throw Refused("jog: the feed must be above 0");
    }
    if (status_.state == MachineState::Idle && commands_.empty() && pending_.empty()) {
        submit("M5S0");  // A jog inherits the beam.
    }
    submit(
        fmt::format("$J=G91G21X{:.3f}Y{:.3f}F{:.1f}", jog.dx_mm, jog.dy_mm, jog.feed_mm_per_min));
}

void GrblSession::jog_cancel() {
    const auto is_jog = [](const Pending& line) { return line.text.substr(0, 3) == "$J="; };
    commands_.erase(std::remove_if(commands_.begin(), commands_.end(), is_jog), commands_.end());
    if (phase_ != Phase::Gone) {
        send_realtime(kJogCancel);
    }
}

void GrblSession::console(std::string_view line) {
    const std::size_t first = line.find_first_not_of(" \t\r\n");
    const std::size_t last = line.find_last_not_of(" \t\r\n");
    line =
        first == std::string_view::npos ? std::string_view{} : line.substr(first, last - first + 1);
    if (line == "!") {
        hold();
    } else if (line == "~") {
        resume();
    } else if (line == "?") {
        poll_soon();
    } else if (line == "\x18") {
        stop();
    } else {
        require_ready("console");
        if (std::any_of(line.begin(), line.end(), is_realtime_byte) ||
            line.find('\n') != line.npos || line.size() > protocol_.longest_line()) {
            throw Refused(fmt::format(
                "console: one line of at most {} characters, without ? ! ~ and non-ASCII bytes",
                protocol_.longest_line()));
        }
        submit(std::string(line));
    }
}

void GrblSession::lose_link(const std::string& reason) {
    end_job(JobOutcome::LinkLost, reason);
    forget_lines();
    commands_.clear();
    output_.clear();
    halt_ = Halt::None;
    phase_ = Phase::Gone;
    status_.state = MachineState::Disconnected;
    status_.message = reason;
}

// ---- Sending ----

void GrblSession::submit(std::string line) {
    commands_.push_back({Origin::Command, std::move(line), 0, true, 0.0});
    fill();
}

bool GrblSession::send_line(const Pending& line) {
    const std::optional<std::string> bytes = protocol_.offer(line.text);
    if (!bytes) {
        return false;
    }
    output_ += *bytes;
    pending_.push_back(line);
    line_sent_ = now_;
    standing_since_.reset();
    progress_.lines_sent += line.origin == Origin::Job ? 1 : 0;
    return true;
}

void GrblSession::fill() {
    if (halt_ != Halt::None || phase_ == Phase::Greeting || phase_ == Phase::Resetting) {
        return;
    }
    std::deque<Pending>& source = job_runs() ? job_ : commands_;
    while (!source.empty()) {
        const bool wait =
            (!pending_.empty() && (source.front().alone || pending_.back().alone)) ||
            (source.front().origin == Origin::Job && !may_send_line(progress_.lines_sent));
        if (wait || !send_line(source.front())) {
            return;
        }
        source.pop_front();
    }
}

milliseconds GrblSession::poll_interval() const {
    const bool hurry = halt_ != Halt::None || finishing_ || resume_wanted_ || standing_since_ ||
                       beam_stands_since_;
    return hurry ? std::min(kFastPollInterval, options_.poll_interval) : options_.poll_interval;
}

void GrblSession::poll() {
    if (now_ - polled_ >= poll_interval()) {
        polled_ = now_;
        ++unanswered_polls_;
        send_realtime('?');
    }
}

// ---- Ending ----

void GrblSession::end_job(JobOutcome outcome, std::string reason) {
    job_.clear();
    finishing_ = cancelling_ = resume_wanted_ = false;
    if (job_runs()) {
        progress_.outcome = outcome;
        progress_.reason = std::move(reason);
        if (outcome != JobOutcome::Done) {
            status_.message = progress_.reason;
        }
    }
}

void GrblSession::begin_halt() {
    job_.clear();
    commands_.clear();
    resume_wanted_ = false;
    if (halt_ != Halt::None) {
        return;
    }
    send_realtime('!');
    halt_ = Halt::Holding;
    halt_since_ = now_;
    poll_soon();
}

void GrblSession::begin_reset() {
    send_realtime(kReset);
    forget_lines();
    commands_.clear();
    halt_since_ = phase_since_ = now_;
    if (phase_ == Phase::Ready) {
        halt_ = Halt::Resetting;
    } else {
        phase_ = Phase::Resetting;
    }
}

void GrblSession::forget_lines() {
    protocol_.forget_lines();
    pending_.clear();
    garbled_oks_ = 0;
    short_reports_ = 0;
    standing_since_.reset();
}

double GrblSession::settings_value(int number, double otherwise) const {
    const auto found = settings_.find(number);
    return found == settings_.end() ? otherwise : found->second;
}

MachineFacts GrblSession::facts() const {
    MachineFacts facts;
    facts.laser_mode = settings_value(32, 0.0) == 1.0;
    facts.reports_inches = settings_value(13, 0.0) != 0.0;
    if (settings_.count(30) != 0) {
        facts.s_max = settings_value(30, 0.0);
    }
    facts.power_cap_percent = options_.power_cap_percent;
    facts.travel_mm = {settings_value(130, 0.0), settings_value(131, 0.0)};
    facts.work_position_mm = {status_.work_position_mm[0], status_.work_position_mm[1]};
    // Soft limits need homing, so only with them is the place of the work origin known. The travel
    // lies on the negative side, unless the build forces the origin to the homing corner (Z) and
    // that is the low one ($23).
    if (settings_value(20, 0.0) != 0.0 && work_offset_) {
        std::array<double, 2> origin{};
        const int homes_low = whole_part(settings_value(23, 0.0));
        const bool forced = firmware_.build_options().find('Z') != std::string::npos;
        for (std::size_t axis = 0; axis < 2; ++axis) {
            const bool positive = forced && (homes_low & (1 << axis)) != 0;
            origin[axis] = (*work_offset_)[axis] + (positive ? 0.0 : facts.travel_mm[axis]);
        }
        facts.origin_in_travel_mm = origin;
    }
    return facts;
}

}  // namespace leafcutter::drivers
