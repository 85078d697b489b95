#include "drivers/sim/marlin_machine.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "drivers/gcode_words.h"
#include "drivers/sim/numbered_line.h"

namespace leafcutter::drivers {

namespace {

constexpr std::size_t kLongestLine = 95;  // MAX_CMD_SIZE 96 with its end.
constexpr double kCleaningS = 1.0;
constexpr double kStepsPerMm = 80.0;
constexpr std::string_view kGreeting = "start\necho:Marlin 2.1.2\n";

bool starts_with(std::string_view text, std::string_view start) {
    return text.substr(0, start.size()) == start;
}

bool is_beam_command(std::string_view stripped) {
    const bool word =
        stripped.size() > 1 && stripped[0] == 'M' && stripped[1] >= '3' && stripped[1] <= '5';
    return word && (stripped.size() == 2 || stripped[2] < '0' || stripped[2] > '9');
}

}  // namespace

MarlinMachine::MarlinMachine(const MarlinMachineOptions& options)
    : options_(options), out_(kGreeting) {}

bool MarlinMachine::at_rest() const {
    return killed_ || (queue_.empty() && rx_.empty() && runner_.at_rest() && !line_pending_);
}

double MarlinMachine::beam_power() const {
    return killed_ ? 0.0 : runner_.beam_power();
}

void MarlinMachine::power_cycle() {
    runner_.drop_planned();
    runner_.drop_line();
    rx_.clear();
    partial_.clear();
    queue_.clear();
    line_pending_ = killed_ = false;
    last_number_ = 0;
    out_ += kGreeting;
}

std::string MarlinMachine::feed(std::string_view bytes) {
    for (const char byte : bytes) {
        if (killed_) {
            break;
        }
        if (options_.emergency_parser) {
            watch_emergency(byte);
        }
        if (rx_.size() < kRxBytes) {
            rx_.push_back(byte);
        } else {
            ++bytes_dropped_;
        }
        work();
    }
    work();
    return std::exchange(out_, {});
}

// What arrives is heard at once, whatever waits before it.
void MarlinMachine::watch_emergency(char byte) {
    if (byte != '\n' && byte != '\r') {
        emergency_ += byte;
        return;
    }
    const std::string line = read_numbered_line(std::exchange(emergency_, {})).text;
    if (starts_with(line, "M112")) {
        kill();
    } else if (starts_with(line, "M410")) {
        quick_stop();
    }
}

void MarlinMachine::quick_stop() {
    runner_.drop_planned();
    cleaning_until_s_ = now_s() + kCleaningS;
}

void MarlinMachine::kill() {
    killed_ = true;
    runner_.drop_planned();
    runner_.drop_line();
    queue_.clear();
    rx_.clear();
    partial_.clear();
    out_ += "Error:Printer halted. kill() called!\n";
}

void MarlinMachine::read() {
    while (queue_.size() < kLines && !rx_.empty() && !killed_) {
        const char byte = rx_.front();
        rx_.pop_front();
        if (byte != '\n' && byte != '\r') {
            if (partial_.size() < kLongestLine) {
                partial_ += byte;
            }
        } else if (!partial_.empty()) {
            take_line(std::exchange(partial_, {}));
        }
    }
}

void MarlinMachine::ask_again(std::string_view why) {
    rx_.clear();
    out_ +=
        fmt::format("Error:{}, Last Line: {}\nResend: {}\n", why, last_number_, last_number_ + 1);
    if (options_.ok_after_resend) {
        out_ += "ok\n";
    }
}

void MarlinMachine::take_line(std::string_view line) {
    NumberedLine read = read_numbered_line(line);
    if (read.number) {
        if (*read.number != last_number_ + 1 && !read.sets_number) {
            ask_again("Line Number is not Last Line Number+1");
            return;
        }
        if (!read.sum_holds) {
            ask_again(read.has_sum ? "checksum mismatch" : "No Checksum with line number");
            return;
        }
        last_number_ = *read.number;
    }
    // Without the emergency parser these are heard when they are read, not when it is their turn.
    if (!options_.emergency_parser && !read.number && starts_with(read.text, "M112")) {
        kill();
        return;
    }
    if (!options_.emergency_parser && !read.number && starts_with(read.text, "M410")) {
        quick_stop();
    }
    queue_.push_back({std::move(read.text), last_number_});
}

void MarlinMachine::answer() {
    line_pending_ = false;
    out_ += options_.advanced_ok
                ? fmt::format("ok N{} P{} B{}\n", running_,
                              MotionQueue::kCapacity - runner_.planned(), kLines - queue_.size())
                : "ok\n";
}

// Commands of Marlin that Grbl doesn't have. Returns whether this is one.
bool MarlinMachine::run_own(const std::string& line, const std::string& stripped) {
    if (starts_with(stripped, "M115")) {
        out_ +=
            fmt::format("FIRMWARE_NAME:Marlin 2.1.2 SOURCE_CODE_URL:x\nCap:EMERGENCY_PARSER:{}\n",
                        options_.emergency_parser ? 1 : 0);
        if (options_.bed_mm[0] > 0.0) {
            out_ += fmt::format(
                "area:{{full:{{min:{{x:0.0000,y:0.0000,z:0.0000}},max:{{x:{0:.4f},y:{1:.4f},"
                "z:0.0000}}}},work:{{min:{{x:0.0000,y:0.0000,z:0.0000}},max:{{x:{0:.4f},"
                "y:{1:.4f},z:0.0000}}}}}}\n",
                options_.bed_mm[0], options_.bed_mm[1]);
        }
    } else if (starts_with(stripped, "M114")) {
        const Axes& planned = runner_.planned_mm();
        const Axes& at = runner_.position_mm();
        const auto steps = [&at](std::size_t axis) { return std::lround(at[axis] * kStepsPerMm); };
        out_ += fmt::format("X:{:.2f} Y:{:.2f} Z:{:.2f} E:0.00 Count X:{} Y:{} Z:{}\n", planned[0],
                            planned[1], planned[2], steps(0), steps(1), steps(2));
    } else if (starts_with(stripped, "M113S") && options_.keeps_alive) {
        busy_every_s_ = std::strtod(stripped.c_str() + 5, nullptr);
    } else if (starts_with(stripped, "M118") && options_.knows_m118) {
        out_ += fmt::format("{}\n", line.substr(std::min<std::size_t>(5, line.size())));
    } else if (starts_with(stripped, "M400")) {
        runner_.wait_for_stand();
    } else if (starts_with(stripped, "G28")) {
        runner_.home();
    } else {
        constexpr std::string_view kSilent[] = {"M110", "M112", "M410"};
        return std::any_of(std::begin(kSilent), std::end(kSilent),
                           [&](std::string_view word) { return starts_with(stripped, word); });
    }
    return true;
}

void MarlinMachine::run(const std::string& line) {
    line_pending_ = true;
    const std::string stripped = strip_gcode(line);
    if (run_own(line, stripped)) {
        return;
    }
    const bool beam = is_beam_command(stripped);
    if ((beam && !options_.knows_lasers) || runner_.begin(without_inline_word(stripped)) != 0) {
        out_ += fmt::format("echo:Unknown command: \"{}\"\n", line);
    } else if (beam && stripped.find('I') == std::string::npos) {
        runner_.wait_for_stand();
    }
}

void MarlinMachine::work() {
    while (!killed_) {
        read();
        if (now_s() < cleaning_until_s_ || !runner_.work()) {
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

void MarlinMachine::keep_alive() {
    if (killed_) {
        return;
    }
    if (options_.keeps_alive && line_pending_ && now_s() - busy_told_s_ >= busy_every_s_) {
        busy_told_s_ = now_s();
        out_ += "echo:busy: processing\n";
    }
    if (options_.temperature_every_s > 0.0 &&
        now_s() - temperature_told_s_ >= options_.temperature_every_s) {
        temperature_told_s_ = now_s();
        out_ += " T:21.56 /0.00 @:0\n";
    }
}

std::string MarlinMachine::advance(double seconds) {
    for (double left = seconds; left > 0.0;) {
        const bool cleans = cleaning_until_s_ > now_s();
        const double step = cleans ? std::min(left, cleaning_until_s_ - now_s()) : left;
        const double used = runner_.advance(step);
        left = used > 0.0 ? left - used : 0.0;
        work();
    }
    keep_alive();
    return std::exchange(out_, {});
}

}  // namespace leafcutter::drivers
