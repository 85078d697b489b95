// What a session does about what the controller says, and about what it doesn't.

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <utility>

#include <fmt/format.h>

#include "drivers/grbl/status_report.h"
#include "drivers/marlin/session.h"
#include "drivers/transport.h"

namespace leafcutter::drivers {

namespace {

using std::chrono::milliseconds;

constexpr milliseconds kBannerWait{3000};  // A board's boot loader.
constexpr milliseconds kAnswerWait{2000};
// Of one that doesn't say busy: it may be at a long move, and answers nothing before its end.
constexpr milliseconds kSilence{20000};
constexpr milliseconds kSilenceWhenAlive{1900};  // Of one that does, every second.
constexpr milliseconds kReportSilence{2000};     // Of one that answers '?' whatever it does.
constexpr milliseconds kQuiet{100};  // Some versions answer "ok" after "Resend", some don't.
constexpr std::size_t kMostResends = 12;

}  // namespace

void MarlinSession::handle(const MarlinEvent& event) {
    using Kind = MarlinEvent::Kind;
    if (event.kind != Kind::Status && event.kind != Kind::Other) {
        answered_ = now_;
    }
    switch (event.kind) {
        case Kind::Ack:
            handle_ack(event);
            break;
        case Kind::Resend:
            handle_resend(event.number);
            break;
        case Kind::Error:
            handle_error(event.text);
            break;
        case Kind::Halted:
            handle_halt(event.text);
            break;
        case Kind::Restart:
            handle_restart();
            break;
        case Kind::Position:
            take_position(event.text);
            break;
        case Kind::Status:
            take_status(event.text);
            break;
        case Kind::Firmware:
            take_firmware(event.text);
            break;
        case Kind::Capability:
            emergency_parser_ = emergency_parser_ || event.text == "Cap:EMERGENCY_PARSER:1";
            break;
        case Kind::Unknown:
            handle_unknown(event.text);
            break;
        case Kind::Busy:
            keeps_alive_ = true;
            break;
        case Kind::Waiting:
            idle_told_ = !pending_.empty() && now_ - sent_at_ > kQuiet;
            break;
        case Kind::Foreign:
            foreign_ = foreign_ || !smoothie();
            break;
        case Kind::Other:
            take_area(event.text);
            hear_nudge(event.text);
            break;
    }
}

// "lc17", the word of line 17, alone or in what is said about an unknown command.
void MarlinSession::hear_nudge(std::string_view text) {
    const std::size_t at = text.rfind(kMarlinNudge);
    if (at != std::string_view::npos) {
        std::from_chars(text.data() + at + kMarlinNudge.size(), text.data() + text.size(),
                        nudge_heard_);
    }
}

void MarlinSession::take_firmware(const std::string& text) {
    named_ = true;
    const std::size_t end = std::min(text.find(" SOURCE_CODE"), text.find(", FIRMWARE_URL"));
    status_.firmware = text.substr(14, end == std::string::npos ? end : end - 14);
    if (text.find("Smoothie") != std::string::npos) {
        firmware_ = Firmware::Smoothie;
        grbl_mode_ = text.find("X-GRBL_MODE:1") != std::string::npos;
    }
}

// Of the answer to M115: "area:{full:{min:{x:0.0000,y:0.0000,…},max:{x:235.0000,…}},work:{…}}".
void MarlinSession::take_area(std::string_view text) {
    constexpr std::string_view kStart = "area:{full:{min:{";
    constexpr std::string_view kHighest = "},max:{";
    const std::size_t most = text.find(kHighest);
    if (text.substr(0, kStart.size()) != kStart || most == std::string_view::npos) {
        return;
    }
    const auto least = parse_corner(text.substr(kStart.size(), most - kStart.size()));
    const auto highest = parse_corner(text.substr(most + kHighest.size()));
    if (least && highest) {
        area_ = {*least, {(*highest)[0] - (*least)[0], (*highest)[1] - (*least)[1]}};
    }
}

void MarlinSession::take_status(const std::string& text) {
    // Behind |F: stand other fields than Grbl's.
    const auto report = parse_status_report(fmt::format("{}>", text.substr(0, text.find("|F:"))));
    if (!report) {
        return;
    }
    reports_ = true;
    reported_ = now_;
    status_.machine_position_mm = report->machine_position.value_or(status_.machine_position_mm);
    status_.work_position_mm = report->work_position.value_or(status_.machine_position_mm);
    if (report->state == MachineState::Alarm && phase_ == Phase::Ready) {
        handle_halt("it reports an alarm");
    }
}

// It says ok all the same, and would go on without what it was told.
void MarlinSession::handle_unknown(const std::string& text) {
    named_ = true;  // Even M115 is unknown to some.
    unknown_heard_ = true;
    hear_nudge(text);
    if (nudge_heard_ == 0 && job_runs() && !cancelling_ && !pending_.empty() &&
        pending_.front().origin == Origin::Job) {
        end_job(JobOutcome::Failed, fmt::format("line {} ({}): {}", pending_.front().line,
                                                pending_.front().text, text));
        put_beam_out();
    }
}

void MarlinSession::handle_ack(const MarlinEvent& event) {
    if (event.text.find("X:") != std::string::npos) {
        take_position(event.text);
    }
    if (phase_ == Phase::Unlocking) {
        begin_asking();
        return;
    }
    if (phase_ == Phase::Asking && named_) {
        phase_ = Phase::Numbering;
        phase_since_ = now_;
        output_ += numbered_line(0, "M110 N0");
        next_number_ = 1;
        return;
    }
    if (phase_ == Phase::Numbering) {
        phase_ = Phase::Ready;
        status_.state = MachineState::Idle;
        polled_ = Time{};
        if (!smoothie()) {
            commands_.push_back({Origin::Frame, "M113 S1", 0, 0});
        }
        return;
    }
    if (phase_ != Phase::Ready || now_ < quiet_until_ || pending_.empty()) {
        return;
    }
    if (event.text.find(" B") != std::string::npos && event.text.find(" P") != std::string::npos) {
        window_ = 4;  // ADVANCED_OK: it counts its buffers, and has four at least.
    }
    asked_again_ = 0;
    const std::size_t count = answered_by(event.text);
    for (std::size_t i = 0; i < count; ++i) {
        const Pending line = std::move(pending_.front());
        pending_.pop_front();
        waits_since_ = now_;
        answered(line);
    }
}

// How many of the lines under way an answer that only a nudge has says to be taken.
std::size_t MarlinSession::answered_by_nudge(const std::string& ok) {
    const auto label = std::find_if(
        kSmoothieNudges.begin(), kSmoothieNudges.end(),
        [&ok](std::string_view start) { return ok.compare(0, start.size(), start) == 0; });
    const std::string text =
        fmt::format("M114.{}", std::distance(kSmoothieNudges.begin(), label) + 1);
    const auto found = std::find_if(pending_.begin(), pending_.end(), [&](const Pending& line) {
        return line.origin == Origin::Nudge && (line.number == nudge_heard_ || line.text == text);
    });
    if (found == pending_.end()) {
        return 0;
    }
    nudge_heard_ = 0;
    positions_heard_ = 0;
    return static_cast<std::size_t>(found - pending_.begin()) + 1;
}

// How many of the lines under way an "ok" says to be taken: those up to the one it names, or up to
// the M114 whose position came before it; else the oldest.
std::size_t MarlinSession::answered_by(const std::string& ok) {
    if (const std::size_t count = answered_by_nudge(ok); count > 0) {
        return count;
    }
    const std::size_t name = ok.find(" N");
    std::size_t positions = std::exchange(positions_heard_, 0);
    if (name != std::string::npos) {
        const std::size_t number = std::strtoul(ok.c_str() + name + 2, nullptr, 10);
        const auto later =
            std::find_if(pending_.begin(), pending_.end(),
                         [number](const Pending& line) { return line.number > number; });
        return static_cast<std::size_t>(later - pending_.begin());
    }
    for (std::size_t i = 0; i < pending_.size() && positions > 0; ++i) {
        positions -= pending_[i].asks_position() ? 1 : 0;
        if (positions == 0) {
            return i + 1;
        }
    }
    if (positions > 0 && positions_owed_ > 0) {
        --positions_owed_;  // Some ok came twice: this one belongs to a line already done with.
        return 0;
    }
    positions_owed_ += pending_.front().asks_position() ? 1 : 0;
    return 1;
}

void MarlinSession::answered(const Pending& line) {
    if (line.origin == Origin::Job && line.number > counted_to_) {  // Else it was asked for again.
        counted_to_ = line.number;
        ++progress_.lines_acknowledged;
    }
    const bool unknown = std::exchange(unknown_heard_, false);
    if (line.text.compare(0, 4, "M113") == 0) {
        keeps_alive_ = !unknown;
    }
    if (line.text != "M400") {
        return;
    }
    if (holding_ && line.origin == Origin::Frame) {
        status_.message.clear();  // It stands.
    }
    if (cancelling_ && line.origin == Origin::Frame) {
        end_job(JobOutcome::Aborted, "cancelled");
    } else if (job_runs() && line.origin == Origin::Frame && job_.empty()) {
        end_job(JobOutcome::Done, {});
    }
    set_resting_state();
}

void MarlinSession::set_resting_state() {
    const auto of_poll = [](const Pending& line) { return line.origin == Origin::Poll; };
    if (!job_runs() && std::all_of(commands_.begin(), commands_.end(), of_poll)) {
        status_.state = MachineState::Idle;
    }
}

void MarlinSession::handle_resend(std::size_t number) {
    if (phase_ != Phase::Ready) {
        return;
    }
    if (now_ >= quiet_until_) {  // Else one of several for lines that were under way together.
        ++resends_;
        asked_again_ = number == last_asked_ ? asked_again_ + 1 : 1;
    }
    quiet_until_ = now_ + kQuiet;
    last_asked_ = number;
    // Lines before it were taken, and their answers are still to come.
    const auto lost = std::find_if(pending_.begin(), pending_.end(),
                                   [number](const Pending& line) { return line.number >= number; });
    pending_.erase(lost, pending_.end());
    again_.clear();
    for (const Pending& line : history_) {
        if (line.number >= number && line.number < next_number_) {
            again_.push_back(line);
        }
    }
    const bool known =
        number == next_number_ || (!again_.empty() && again_.front().number == number);
    if (!known || asked_again_ > kMostResends) {
        end_job(JobOutcome::Failed,
                fmt::format("the controller asks for line {} of the link again, {}", number,
                            known ? "and again: the cable is disturbed" : "which is long past"));
        forget_lines();
        commands_.push_back({Origin::Frame, fmt::format("M110 N{}", next_number_), 0, 0});
        commands_.push_back({Origin::Frame, "M5", 0, 0});
    }
}

// A fault of the link comes with a Resend and costs nothing; any other is the program's.
void MarlinSession::handle_error(const std::string& text) {
    const auto of_link = [&text](std::string_view part) {
        return text.find(part) != std::string::npos;
    };
    if (of_link("hecksum") || of_link("Line Number") || of_link("line number") ||
        of_link("No Line")) {
        return;
    }
    status_.message = last_error_ = text;
    if (job_runs() && !cancelling_ && !pending_.empty()) {
        end_job(JobOutcome::Failed, fmt::format("line {} ({}): {}", pending_.front().line,
                                                pending_.front().text, text));
        commands_.push_back({Origin::Frame, "M5", 0, 0});
        commands_.push_back({Origin::Frame, "M400", 0, 0});
    }
}

void MarlinSession::handle_halt(const std::string& text) {
    if (phase_ == Phase::Killed) {
        return;
    }
    phase_ = Phase::Killed;
    const std::string why = last_error_.empty() ? text : std::exchange(last_error_, {});
    end_job(JobOutcome::Failed, fmt::format("the controller halted: {}", why));
    forget_lines();
    status_.state = MachineState::Alarm;
    status_.message = fmt::format(
        "halted ({}): {}", why, smoothie() ? "unlock it, then home" : "reset the board, then home");
}

void MarlinSession::handle_restart() {
    if (phase_ != Phase::Greeting) {
        end_job(JobOutcome::Failed,
                "the controller restarted during the program; its position is lost, home it");
    }
    begin_asking();
}

void MarlinSession::begin_asking() {
    forget_lines();
    phase_ = Phase::Asking;
    phase_since_ = now_;
    positioned_ = named_ = keeps_alive_ = false;
    window_ = 1;
    emergency_parser_ = origin_moved_ = false;
    area_.reset();
    output_ += "M115\n";
}

void MarlinSession::take_position(const std::string& text) {
    if (const auto position = parse_position(text)) {
        positioned_ = true;
        ++positions_heard_;
        status_.machine_position_mm = {position->x_mm, position->y_mm, position->z_mm};
        status_.work_position_mm = status_.machine_position_mm;
    }
}

void MarlinSession::watch_attach() {
    const auto waited = now_ - phase_since_;
    if (foreign_ && phase_ != Phase::Ready) {
        throw LinkLost("a Grbl answers there: name it grbl:…");
    }
    const bool greets = phase_ == Phase::Greeting;  // Or was running already, and says nothing.
    const bool answers =
        phase_ == Phase::Unlocking || phase_ == Phase::Asking || phase_ == Phase::Numbering;
    if ((greets && waited > kBannerWait) || (answers && waited > kAnswerWait)) {
        begin_asking();
    }
}

void MarlinSession::watch_silence() const {
    if (phase_ != Phase::Ready) {
        return;
    }
    if (reports_ && now_ - reported_ > kReportSilence) {
        throw LinkLost(
            fmt::format("the controller has said nothing for {} s", kReportSilence.count() / 1000));
    }
    const milliseconds most = keeps_alive_ ? kSilenceWhenAlive : kSilence;
    if (!pending_.empty() && now_ - std::max(heard_, waits_since_) > most) {
        throw LinkLost(
            fmt::format("no answer to {} for {} s", pending_.front().text, most.count() / 1000));
    }
}

}  // namespace leafcutter::drivers
