#include "drivers/sim/faulty_machine.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <stdexcept>
#include <utility>

#include "drivers/grbl/protocol.h"

namespace leafcutter::drivers {

namespace {

constexpr std::array<std::pair<std::string_view, Fault::Kind>, 12> kNames{{
    {"drop-byte", Fault::Kind::DropByte},
    {"double-byte", Fault::Kind::DoubleByte},
    {"corrupt-byte", Fault::Kind::CorruptByte},
    {"drop-ok", Fault::Kind::DropOk},
    {"double-ok", Fault::Kind::DoubleOk},
    {"corrupt-ok", Fault::Kind::CorruptOk},
    {"delay", Fault::Kind::Delay},
    {"stall", Fault::Kind::Stall},
    {"alarm", Fault::Kind::Alarm},
    {"reset", Fault::Kind::Reset},
    {"power", Fault::Kind::PowerCut},
    {"unplug", Fault::Kind::Unplug},
}};

constexpr double kDelaySeconds = 5.0;
constexpr std::size_t kColumn = 4;  // Of the byte that a fault on the way in meets.

bool is_on_the_way_in(Fault::Kind kind) {
    return kind == Fault::Kind::DropByte || kind == Fault::Kind::DoubleByte ||
           kind == Fault::Kind::CorruptByte;
}

// Where the `count`-th answer to a line begins, and where it ends (behind its line end).
std::pair<std::size_t, std::size_t> find_answer(std::string_view text, std::size_t count) {
    std::size_t begin = 0;
    while (begin < text.size()) {
        const std::size_t end = std::min(text.find('\n', begin), text.size() - 1) + 1;
        const std::string_view line = text.substr(begin, end - begin);
        const bool answer = line.substr(0, 2) == "ok" || line.substr(0, 6) == "error:";
        if (answer && --count == 0) {
            return {begin, end};
        }
        begin = end;
    }
    return {text.size(), text.size()};
}

}  // namespace

Fault parse_fault(std::string_view text) {
    const std::size_t colon = text.find(':');
    for (const auto& [name, kind] : kNames) {
        if (text.substr(0, colon) != name || colon == std::string_view::npos) {
            continue;
        }
        Fault fault{kind, 0};
        const char* const last = text.data() + text.size();
        const auto [end, error] = std::from_chars(text.data() + colon + 1, last, fault.at);
        if (error == std::errc{} && end == last && fault.at > 0) {
            return fault;
        }
    }
    throw std::invalid_argument("fault \"" + std::string(text) +
                                "\": must be drop-byte:N, double-byte:N, corrupt-byte:N, "
                                "drop-ok:N, double-ok:N, corrupt-ok:N, delay:N, stall:N, alarm:N, "
                                "reset:N, power:N or unplug:N with N > 0");
}

std::vector<Fault> parse_faults(std::string_view text) {
    std::vector<Fault> faults;
    while (!text.empty()) {
        const std::size_t end = std::min(text.find_first_of(",\n"), text.size());
        std::string_view word = text.substr(0, end);
        text.remove_prefix(std::min(end + 1, text.size()));
        word = word.substr(0, word.find('#'));
        const std::size_t first = word.find_first_not_of(" \t\r");
        if (first != std::string_view::npos) {
            const std::size_t last = word.find_last_not_of(" \t\r");
            faults.push_back(parse_fault(word.substr(first, last - first + 1)));
        }
    }
    return faults;
}

FaultyMachine::FaultyMachine(const GrblMachineOptions& options, std::vector<Fault> faults)
    : machine_(options), faults_(std::move(faults)) {
    std::sort(faults_.begin(), faults_.end(),
              [](const Fault& a, const Fault& b) { return a.at > b.at; });
}

std::string FaultyMachine::feed(std::string_view bytes) {
    std::string answer;
    for (std::size_t i = 0; i < bytes.size() && !silent_; ++i) {
        answer += deliver(bytes[i]);
    }
    if (bytes.empty()) {
        answer += disturb(machine_.feed({}), machine_.gcode_lines());
    }
    return answer;
}

// One byte on its way in.
std::string FaultyMachine::deliver(char byte) {
    std::string arriving(1, byte);
    const bool line_end = byte == '\n' || byte == '\r';
    if (!is_realtime_byte(byte)) {
        const bool gcode = line_.empty() && !line_end && byte != '$';
        lines_begun_ += gcode ? 1 : 0;
        const bool there = line_.size() == kColumn || (line_end && line_.size() < kColumn);
        const bool in_gcode = gcode || (!line_.empty() && line_[0] != '$');
        const auto hit = std::find_if(faults_.begin(), faults_.end(), [&](const Fault& fault) {
            return is_on_the_way_in(fault.kind) && fault.at == lines_begun_;
        });
        if (there && in_gcode && hit != faults_.end()) {
            arriving = hit->kind == Fault::Kind::DropByte     ? ""
                       : hit->kind == Fault::Kind::DoubleByte ? std::string(2, byte)
                                                              : std::string(1, byte ^ 0x01);
            faults_.erase(hit);
        }
        line_ = line_end ? "" : line_ + byte;
    }
    const std::size_t before = machine_.gcode_lines();
    return disturb(machine_.feed(arriving), before);
}

std::string FaultyMachine::advance(double seconds) {
    const std::size_t before = machine_.gcode_lines();
    return disturb(machine_.advance(seconds), before);
}

std::string FaultyMachine::disturb(std::string answer, std::size_t lines_before) {
    if (silent_) {
        return {};
    }
    // The last line's first: what is cut out of the answer moves nothing before it.
    for (std::size_t i = 0; i < faults_.size() && !silent_;) {
        if (is_on_the_way_in(faults_[i].kind) || machine_.gcode_lines() < faults_[i].at) {
            ++i;
            continue;
        }
        const Fault fault = faults_[i];
        faults_.erase(faults_.begin() + static_cast<std::ptrdiff_t>(i));
        disturb_by(fault, answer, lines_before);
    }
    if (machine_.now_s() < mute_until_s_) {
        held_back_ += answer;
        return {};
    }
    return std::exchange(held_back_, {}) + answer;
}

void FaultyMachine::disturb_by(Fault fault, std::string& answer, std::size_t lines_before) {
    const std::size_t count = fault.at > lines_before ? fault.at - lines_before : 1;
    const auto [begin, end] = find_answer(answer, count);
    switch (fault.kind) {
        case Fault::Kind::DropOk:
            answer.erase(begin, end - begin);
            break;
        case Fault::Kind::DoubleOk:
            answer.insert(end, answer.substr(begin, end - begin));
            break;
        case Fault::Kind::CorruptOk:
            if (begin < end) {
                answer[begin] = static_cast<char>(answer[begin] ^ 0x10);
            }
            break;
        case Fault::Kind::Delay:
            mute_until_s_ = machine_.now_s() + kDelaySeconds;
            break;
        case Fault::Kind::Stall:
            answer.erase(end);
            silent_ = true;
            break;
        case Fault::Kind::Alarm:
            machine_.trip_hard_limit();
            answer += machine_.feed({});
            break;
        case Fault::Kind::Reset:
            machine_.power_cycle();
            answer += machine_.feed({});
            break;
        case Fault::Kind::PowerCut:
            machine_.power_cycle();
            machine_.feed({});
            answer.erase(end);
            silent_ = true;
            break;
        case Fault::Kind::Unplug:
            answer.clear();
            silent_ = unplugged_ = true;
            break;
        default:
            break;
    }
}

}  // namespace leafcutter::drivers
