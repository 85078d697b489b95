#include "drivers/sim/smoothie_machine.h"

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <sstream>
#include <utility>

#include <fmt/format.h>

#include "drivers/sim/numbered_line.h"

namespace leafcutter::drivers {

namespace {

constexpr std::string_view kGreeting = "Smoothie\r\nok\r\n";
constexpr char kHalt = 0x18;
constexpr int kNoFeed = 22;  // Grbl's number of it.

// What a halted board still takes.
bool is_allowed(int code) {
    constexpr int kAllowed[] = {2, 5, 9, 30, 105, 114, 115, 119, 80, 81, 911, 503, 106, 107};
    return std::find(std::begin(kAllowed), std::end(kAllowed), code) != std::end(kAllowed);
}

int code_of(const std::string& stripped) {
    return static_cast<int>(std::strtol(stripped.c_str() + 1, nullptr, 10));
}

double word_of(const std::string& stripped, char letter, double other) {
    const std::size_t at = stripped.find(letter, 1);
    return at == std::string::npos ? other : std::strtod(stripped.c_str() + at + 1, nullptr);
}

}  // namespace

SmoothieMachine::SmoothieMachine(const SmoothieMachineOptions& options)
    : options_(options), out_(kGreeting) {
    runner_.begin("M4");
}

bool SmoothieMachine::at_rest() const {
    return !line_pending_ && lines_in_rx_ == 0 && runner_.at_rest() && fire_power_ == 0.0;
}

double SmoothieMachine::beam_power() const {
    return fire_power_ > 0.0 ? fire_power_ : runner_.beam_power();
}

void SmoothieMachine::power_cycle() {
    halt();
    halted_ = false;
    rx_.clear();
    lines_in_rx_ = 0;
    last_number_ = -1;
    out_ += kGreeting;
}

std::string SmoothieMachine::feed(std::string_view bytes) {
    for (const char byte : bytes) {
        receive(byte);
        work();
    }
    work();
    return std::exchange(out_, {});
}

// USB has a flow control of its own: no byte is lost.
void SmoothieMachine::receive(char byte) {
    if (byte == '?') {
        report();
    } else if (byte == kHalt) {
        halt();
        rx_.clear();
        lines_in_rx_ = 0;
        out_ += options_.grbl_mode ? "ALARM: Abort during cycle\r\n"
                                   : "HALTED, M999 or $X to exit HALT state\r\n";
    } else if (options_.feed_hold && (byte == '!' || byte == '~')) {
        holds_ = byte == '!';
    } else {
        rx_.push_back(byte);
        lines_in_rx_ += byte == '\n' ? 1 : 0;
    }
}

void SmoothieMachine::halt() {
    halted_ = true;
    holds_ = false;
    runner_.drop_planned();
    runner_.drop_line();
    fire_power_ = 0.0;
    line_pending_ = false;
}

void SmoothieMachine::unhalt() {
    halted_ = holds_ = false;
}

std::string SmoothieMachine::position() const {
    const Axes& at = runner_.position_mm();
    return fmt::format("{:.4f},{:.4f},{:.4f}", at[0], at[1], at[2]);
}

void SmoothieMachine::report() {
    const std::string_view state = halted_            ? "Alarm"
                                   : holds_           ? "Hold"
                                   : runner_.moving() ? "Run"
                                                      : "Idle";
    out_ += fmt::format("<{0}|MPos:{1}|WPos:{1}|F:0.0,100.0>\n", state, position());
}

void SmoothieMachine::work() {
    while (!holds_ && runner_.work()) {
        if (std::exchange(line_pending_, false)) {
            out_ += fmt::format("ok{}\n", std::exchange(answer_, {}));
        }
        if (lines_in_rx_ == 0) {
            return;
        }
        const auto end = std::find(rx_.begin(), rx_.end(), '\n');
        std::string line(rx_.begin(), end);
        rx_.erase(rx_.begin(), end + 1);
        --lines_in_rx_;
        line.erase(std::remove(line.begin(), line.end(), '\r'), line.end());
        take_line(line);
    }
}

void SmoothieMachine::take_line(const std::string& line) {
    if (line.empty() || line[0] == ';' || line[0] == '(') {
        out_ += "ok\n";
        return;
    }
    if (line[0] == '$' || (line[0] >= 'a' && line[0] <= 'z')) {
        run_shell(line);
        return;
    }
    const NumberedLine read = read_numbered_line(line);
    if (read.number && read.sets_number) {
        last_number_ = static_cast<long>(*read.number);
        out_ += "ok\n";
        return;
    }
    if (read.number) {
        const bool next = static_cast<long>(*read.number) == last_number_ + 1;
        if (!next || (read.has_sum && !read.sum_holds)) {
            out_ += fmt::format("rs N{}\n", last_number_ + 1);
            return;
        }
        ++last_number_;
    }
    take_command(strip_gcode(read.text));
}

void SmoothieMachine::take_command(const std::string& text) {
    if (text.empty() || std::string_view("GMTSXYZF").find(text[0]) == std::string_view::npos) {
        out_ += text.empty() ? "ok\n" : "ok - ignored\n";
        return;
    }
    const int code = text[0] == 'M' ? code_of(text) : -1;
    if (halted_ && code == 999) {
        unhalt();
        out_ += "WARNING: After HALT you should HOME as position is currently unknown\nok\n";
    } else if (halted_ && !is_allowed(code)) {
        out_ += options_.grbl_mode ? "error:Alarm lock\n" : "!!\n";
    } else if (text[0] == 'M') {
        run_m(code, text);
    } else if (text.compare(0, 3, "G28") == 0) {
        const bool forced = text.compare(0, 5, "G28.2") == 0;
        line_pending_ = true;
        if (forced == options_.grbl_mode) {  // The other one goes to the park position.
            runner_.home();
        }
    } else {
        const bool early = text.compare(0, 2, "G1") == 0 && (text.size() == 2 || text[2] > '9');
        out_ += early ? "ok\n" : "";
        const int error = runner_.begin(text);
        if (error == kNoFeed) {
            fail("Undefined feed rate");
        } else {
            line_pending_ = !early;
        }
    }
}

void SmoothieMachine::fail(std::string_view what) {
    out_ += fmt::format("{}{}\nEntering Alarm/Halt state\n",
                        options_.grbl_mode ? "error:" : "Error: ", what);
    halt();
}

void SmoothieMachine::run_m(int code, const std::string& stripped) {
    line_pending_ = true;
    switch (code) {
        case 112:
            halt();
            out_ += "ok Emergency Stop Requested - reset or M999 required to exit HALT state\n";
            break;
        case 114: {
            constexpr std::string_view kKinds[] = {"C", "WCS", "MCS", "APOS", "MP", "CMP"};
            const std::size_t dot = stripped.find('.');
            const auto kind = dot < stripped.size() - 1
                                  ? static_cast<std::size_t>(stripped[dot + 1] - '0')
                                  : std::size_t{0};
            const bool planned = kind == 0 || kind > 3;
            const Axes& at = planned ? runner_.planned_mm() : runner_.position_mm();
            answer_ =
                fmt::format(" {}: X:{:.4f} Y:{:.4f} Z:{:.4f}",
                            kKinds[std::min(kind, std::size(kKinds) - 1)], at[0], at[1], at[2]);
            break;
        }
        case 115:
            out_ += fmt::format(
                "FIRMWARE_NAME:Smoothieware, FIRMWARE_URL:http%3A//smoothieware.org, "
                "FIRMWARE_VERSION:edge, PROTOCOL_VERSION:1.0, X-AXES:3, X-GRBL_MODE:{}, X-CNC:0\n",
                options_.grbl_mode ? 1 : 0);
            break;
        case 221:
            runner_.scale_power(word_of(stripped, 'S', 100.0) / 100.0);
            break;
        case 2:
        case 400:
            runner_.wait_for_stand();
            break;
        default:  // M3, M4 and M5 too: they are nothing to its laser.
            break;
    }
}

// Commands of its shell: not one of them is numbered, and few say ok.
void SmoothieMachine::run_shell(const std::string& line) {
    if (line.compare(0, 2, "$X") == 0) {
        if (halted_) {
            unhalt();
            out_ += "[Caution: Unlocked]\nok\n";
        }
    } else if (line.compare(0, 2, "$H") == 0) {
        unhalt();
        line_pending_ = true;
        runner_.home();
    } else if (line.compare(0, 5, "fire ") == 0) {
        fire(line);
    } else {
        out_ += fmt::format("error:Unsupported command - {}\n", line);
    }
}

void SmoothieMachine::fire(const std::string& line) {
    if (halted_) {
        return;
    }
    std::istringstream words(line.substr(5));
    std::string power;
    double duration_ms = 0.0;
    words >> power >> duration_ms;
    if (power == "off" || power == "0") {
        fire_power_ = 0.0;
        out_ += "turning laser off and returning to auto mode\n";
        return;
    }
    const double percent = std::clamp(std::strtod(power.c_str(), nullptr), 0.0, 100.0);
    fire_power_ = percent / 100.0;
    fire_until_s_ =
        words ? now_s() + duration_ms / 1000.0 : std::numeric_limits<double>::infinity();
    out_ += fmt::format("WARNING: Firing laser at {:1.2f}% power\n", percent);
}

void SmoothieMachine::burn_standing(double seconds) {
    const Axes& at = runner_.position_mm();
    runner_.beam_log().add(
        {now_s() - seconds, now_s(), at[0], at[1], at[0], at[1], fire_power_, fire_power_, 0.0});
}

std::string SmoothieMachine::advance(double seconds) {
    for (double left = seconds; left > 0.0;) {
        const bool fires = fire_power_ > 0.0;
        const double step = fires ? std::min(left, fire_until_s_ - now_s()) : left;
        const double used = runner_.advance(std::max(step, 0.0));
        if (fires) {
            burn_standing(used);
            fire_power_ = now_s() < fire_until_s_ ? fire_power_ : 0.0;
        }
        left = used > 0.0 || fires ? left - used : 0.0;
        work();
    }
    return std::exchange(out_, {});
}

}  // namespace leafcutter::drivers
