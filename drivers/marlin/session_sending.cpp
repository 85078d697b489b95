// The half of MarlinSession that puts lines on the wire.

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "drivers/gcode_words.h"
#include "drivers/marlin/session.h"

namespace leafcutter::drivers {

namespace {

using std::chrono::milliseconds;

constexpr milliseconds kPollInterval{1000};
constexpr milliseconds kReportInterval{200};
// Marlin is told to say "busy" every second while a line takes long; nothing for longer means that
// an answer was lost.
constexpr milliseconds kNudgeAfter{1500};
constexpr std::ptrdiff_t kMostNudges = 3;
constexpr std::size_t kKept = 64;  // Sent lines that may be asked for again.

// "M3", "M4" or "M5" of a line, without its S; empty if it has none.
std::string beam_words(std::string_view line) {
    std::string words;
    bool beam = false;
    for (const GcodeWord& word : split_words(line).words) {
        const bool command = word.letter == 'M' && word.value >= 3.0 && word.value <= 5.0;
        beam = beam || command;
        if (command || word.letter == 'I') {
            words += fmt::format("{}{:g}", word.letter, word.value);
        }
    }
    return beam ? words : std::string();
}

}  // namespace

bool MarlinSession::may_send() const {
    return phase_ == Phase::Ready && now_ >= quiet_until_ && pending_.size() < window_ &&
           !quick_stop_due_;
}

void MarlinSession::fill() {
    while (may_send()) {
        std::deque<Pending>* source = &again_;
        if (again_.empty()) {
            const bool job =
                job_runs() && !cancelling_ && !holding_ && !job_.empty() &&
                (job_.front().origin != Origin::Job || may_send_line(progress_.lines_sent));
            source = commands_.empty() && job ? &job_ : &commands_;
        }
        if (source->empty()) {
            return;
        }
        Pending line = std::move(source->front());
        source->pop_front();
        send(std::move(line));
    }
}

void MarlinSession::send(Pending line) {
    const bool first = line.number == 0;
    if (first) {
        line.number = next_number_++;
        progress_.lines_sent += line.origin == Origin::Job ? 1 : 0;
    }
    if (first && line.origin == Origin::Job) {
        remember_beam(line.text);
    }
    output_ += numbered_line(line.number, line.text);
    put_under_way(line);
    if (first) {
        history_.push_back(std::move(line));
        if (history_.size() > kKept) {
            history_.pop_front();
        }
    }
}

// What a hold must bring back.
void MarlinSession::remember_beam(std::string_view line) {
    for (const GcodeWord& word : split_words(line).words) {
        if (word.letter == 'S') {
            power_word_ = fmt::format("S{:g}", word.value);
        }
    }
    const std::string words = beam_words(line);
    beam_line_ = words.empty() ? beam_line_ : words;
}

void MarlinSession::send_unnumbered(std::string text) {
    output_ += fmt::format("{}\n", text);
    put_under_way({Origin::Frame, std::move(text), 0, 0});
}

void MarlinSession::put_under_way(Pending line) {
    sent_at_ = now_;
    waits_since_ = pending_.empty() ? now_ : waits_since_;
    pending_.push_back(std::move(line));
}

void MarlinSession::poll() {
    if (smoothie() && phase_ != Phase::Greeting && now_ - asked_report_ >= kReportInterval) {
        asked_report_ = now_;
        output_ += '?';
    }
    if (phase_ != Phase::Ready || now_ - polled_ < kPollInterval || quick_stop_due_) {
        return;
    }
    const auto of_poll = [](const Pending& line) { return line.asks_position(); };
    if (std::none_of(commands_.begin(), commands_.end(), of_poll) &&
        std::none_of(pending_.begin(), pending_.end(), of_poll)) {
        polled_ = now_;
        commands_.push_back({Origin::Poll, "M114", 0, 0});
    }
}

// Beyond the window: the controller has room for it, and its answer says what became of the lines
// before it.
void MarlinSession::nudge() {
    const auto of_nudge = [](const Pending& line) { return line.origin == Origin::Nudge; };
    const auto nudges = std::count_if(pending_.begin(), pending_.end(), of_nudge);
    const auto quiet_for = now_ - std::max(answered_, sent_at_);
    const bool due = idle_told_ ? nudges == 0 : quiet_for >= kNudgeAfter;
    if (phase_ == Phase::Ready && !pending_.empty() && now_ >= quiet_until_ && due &&
        nudges < kMostNudges) {
        idle_told_ = false;
        send({Origin::Nudge, nudge_text(), 0, 0});
    }
}

// Each is answered in a way of its own, so that nobody takes its answer for that of an older line:
// Marlin repeats the word, even where it doesn't know M118.
std::string MarlinSession::nudge_text() {
    nudges_sent_ = nudges_sent_ % kSmoothieNudges.size() + 1;
    return smoothie() ? fmt::format("M114.{}", nudges_sent_)
                      : fmt::format("M118 {}{}", kMarlinNudge, next_number_);
}

// Smoothieware's laser goes out by itself when nothing moves, and knows no M5.
void MarlinSession::put_beam_out() {
    if (!smoothie()) {
        commands_.push_back({Origin::Frame, "M5", 0, 0});
    }
    commands_.push_back({Origin::Frame, "M400", 0, 0});
}

void MarlinSession::restore_beam() {
    if (!smoothie() && !beam_line_.empty() && beam_line_.substr(0, 2) != "M5") {
        commands_.push_back({Origin::Frame, beam_line_ + power_word_, 0, 0});
    }
}

// Taken out of the stream as it arrives: the planner is emptied at once. A line that waits to be
// planned would burn afterwards.
void MarlinSession::quick_stop() {
    const auto of_job = [](const Pending& line) { return line.origin == Origin::Job; };
    if (quick_stop_due_ && phase_ == Phase::Ready && again_.empty() &&
        std::none_of(pending_.begin(), pending_.end(), of_job)) {
        quick_stop_due_ = false;
        send_unnumbered("M410");
    }
}

}  // namespace leafcutter::drivers
