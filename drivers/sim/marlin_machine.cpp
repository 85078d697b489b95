#include "drivers/sim/marlin_machine.h"

#include <algorithm>
#include <charconv>
#include <utility>

#include <fmt/format.h>

namespace leafcutter::drivers {

namespace {

constexpr double kBusyEvery = 2.0;
constexpr MotionLimits kLimits{{200.0, 200.0, 10.0}, {1000.0, 1000.0, 100.0}, 0.01};
const GcodeInterpreter::Rules kRules{true, 0.01, {80.0, 80.0, 80.0}};

bool starts_with(std::string_view text, std::string_view start) {
    return text.substr(0, start.size()) == start;
}

std::size_t number_at(std::string_view text) {
    std::size_t number = 0;
    std::from_chars(text.data(), text.data() + text.size(), number);
    return number;
}

}  // namespace

MarlinMachine::MarlinMachine(const MarlinMachineOptions& options) : options_(options) {
    out_ = "start\necho:Marlin 2.1.2\n";
    interpreter_.reset({});
}

double MarlinMachine::beam_power() const {
    return killed_ ? 0.0 : motion_.running_power().value_or(0.0);
}

std::string MarlinMachine::feed(std::string_view bytes) {
    for (const char byte : bytes) {
        if (byte != '\n') {
            partial_ += byte;
            continue;
        }
        std::string line = std::exchange(partial_, {});
        if (killed_ || line.empty()) {
            continue;
        }
        ++heard_;
        if (options_.drop_line == heard_) {
            continue;
        }
        if (options_.flip_bit == heard_) {
            line[line.size() / 2] = static_cast<char>(line[line.size() / 2] ^ 1);
        }
        emergency(line);
        take_line(std::move(line));
        work();
    }
    work();
    return std::exchange(out_, {});
}

// Taken out of the stream as they arrive, without waiting for their turn.
void MarlinMachine::emergency(std::string_view line) {
    if (!options_.emergency_parser) {
        return;
    }
    if (line == "M112") {
        kill();
    } else if (line == "M410") {
        motion_.clear(now_s_, log_);
        actions_.clear();
        interpreter_.set_position(motion_.position_mm());
    }
}

void MarlinMachine::kill() {
    killed_ = true;
    motion_.clear(now_s_, log_);
    queue_.clear();
    actions_.clear();
    out_ += "Error:Printer halted. kill() called!\n";
}

void MarlinMachine::ask_again(std::string_view why) {
    out_ +=
        fmt::format("Error:{}, Last Line: {}\nResend: {}\n", why, last_number_, last_number_ + 1);
    if (options_.ok_after_resend) {
        out_ += "ok\n";
    }
}

void MarlinMachine::take_line(std::string line) {
    if (killed_) {
        return;
    }
    if (line.front() == 'N') {
        const std::size_t star = line.rfind('*');
        if (star == std::string::npos) {
            ask_again("No Checksum with line number");
            return;
        }
        unsigned sum = 0;
        for (std::size_t i = 0; i < star; ++i) {
            sum ^= static_cast<unsigned char>(line[i]);
        }
        const std::size_t number = number_at(std::string_view(line).substr(1));
        const bool sets = line.find("M110") != std::string::npos;
        if (number_at(std::string_view(line).substr(star + 1)) != sum) {
            ask_again("checksum mismatch");
            return;
        }
        if (number != last_number_ + 1 && !sets) {
            ask_again("Line Number is not Last Line Number+1");
            return;
        }
        last_number_ = number;
        const std::size_t blank = line.find(' ');
        line = blank == std::string::npos ? "" : line.substr(blank + 1, star - blank - 1);
    }
    if (queue_.size() >= kLines) {
        ++overruns_;
        return;
    }
    queue_.push_back({std::move(line), last_number_});
}

void MarlinMachine::answer() {
    ++answered_;
    line_pending_ = false;
    if (options_.drop_ok == answered_) {
        return;
    }
    out_ += options_.advanced_ok
                ? fmt::format("ok N{} P{} B{}\n", running_, MotionQueue::kCapacity - motion_.size(),
                              kLines - queue_.size())
                : "ok\n";
}

bool MarlinMachine::perform(const Action& action) {
    using Kind = Action::Kind;
    if (action.kind == Kind::Move) {
        if (motion_.full()) {
            return false;
        }
        motion_.push(action.move, kLimits);
        return true;
    }
    // Inline power is for moves: M3, M4 and M5 wait for nothing and light nothing that stands.
    return action.kind == Kind::Beam || action.kind == Kind::Offset || motion_.empty();
}

void MarlinMachine::run_own(std::string_view line) {
    if (starts_with(line, "M115")) {
        out_ += fmt::format(
            "FIRMWARE_NAME:Marlin 2.1.2 SOURCE_CODE_URL:x\n"
            "Cap:EMERGENCY_PARSER:{}\n",
            options_.emergency_parser ? 1 : 0);
    } else if (starts_with(line, "M114")) {
        const Axes& at = motion_.end_mm();
        out_ += fmt::format("X:{:.2f} Y:{:.2f} Z:{:.2f} E:0.00 Count X:0 Y:0 Z:0\n", at[0], at[1],
                            at[2]);
    } else if (starts_with(line, "M400")) {
        waits_for_stand_ = true;
    } else if (starts_with(line, "M112")) {
        kill();
    } else if (starts_with(line, "G28")) {
        motion_.clear(now_s_, log_);
        motion_.set_position({});
        interpreter_.set_position({});
    }
}

void MarlinMachine::run(const std::string& line) {
    line_pending_ = true;
    const std::string stripped = strip_gcode(line);
    constexpr std::string_view kOwn[] = {"M115", "M114", "M400", "M112", "M110", "M410", "G28"};
    const bool own = std::any_of(std::begin(kOwn), std::end(kOwn), [&](std::string_view word) {
        return starts_with(stripped, word);
    });
    if (own) {
        run_own(stripped);
        return;
    }
    Interpretation read = interpreter_.run(without_inline_word(stripped), kRules);
    if (read.error != 0) {
        out_ += fmt::format("echo:Unknown command: \"{}\"\n", line);
    }
    actions_.assign(read.actions.begin(), read.actions.end());
}

void MarlinMachine::work() {
    while (!killed_) {
        while (!actions_.empty() && perform(actions_.front())) {
            actions_.pop_front();
        }
        waits_for_stand_ = waits_for_stand_ && !motion_.empty();
        if (!actions_.empty() || waits_for_stand_) {
            return;
        }
        if (line_pending_) {
            answer();
        }
        if (queue_.empty()) {
            return;
        }
        const Line line = std::move(queue_.front());
        queue_.pop_front();
        running_ = line.number;
        run(line.text);
    }
}

std::string MarlinMachine::advance(double seconds) {
    const double end = now_s_ + seconds;
    while (now_s_ < end && !killed_) {
        const double used =
            motion_.empty() ? end - now_s_ : motion_.advance(end - now_s_, now_s_, log_);
        now_s_ += used > 0.0 ? used : end - now_s_;
        work();
    }
    now_s_ = end;
    if (line_pending_ && now_s_ - busy_told_s_ >= kBusyEvery) {
        busy_told_s_ = now_s_;
        out_ += "echo:busy: processing\n";
    }
    return std::exchange(out_, {});
}

}  // namespace leafcutter::drivers
