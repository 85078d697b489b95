#include "drivers/sim/faulty_machine.h"

#include <array>
#include <charconv>
#include <stdexcept>
#include <utility>

namespace leafcutter::drivers {

namespace {

constexpr std::array<std::pair<std::string_view, Fault::Kind>, 6> kNames{{
    {"drop-ok", Fault::Kind::DropOk},
    {"corrupt-ok", Fault::Kind::CorruptOk},
    {"stall", Fault::Kind::Stall},
    {"alarm", Fault::Kind::Alarm},
    {"reset", Fault::Kind::Reset},
    {"unplug", Fault::Kind::Unplug},
}};

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
                                "\": must be drop-ok:N, corrupt-ok:N, stall:N, alarm:N, reset:N or "
                                "unplug:N with N > 0");
}

FaultyMachine::FaultyMachine(const GrblMachineOptions& options, std::optional<Fault> fault)
    : machine_(options), fault_(fault) {}

std::string FaultyMachine::feed(std::string_view bytes) {
    std::string answer;
    for (std::size_t i = 0; i < bytes.size() && !silent_; ++i) {
        const std::size_t before = machine_.gcode_lines();
        answer += disturb(machine_.feed(bytes.substr(i, 1)), before);
    }
    if (bytes.empty()) {
        answer += disturb(machine_.feed({}), machine_.gcode_lines());
    }
    return answer;
}

std::string FaultyMachine::advance(double seconds) {
    const std::size_t before = machine_.gcode_lines();
    return disturb(machine_.advance(seconds), before);
}

std::string FaultyMachine::disturb(std::string answer, std::size_t lines_before) {
    if (silent_) {
        return {};
    }
    if (!fault_ || machine_.gcode_lines() < fault_->at) {
        return answer;
    }
    const auto [begin, end] = find_answer(answer, fault_->at - lines_before);
    const Fault::Kind kind = fault_->kind;
    fault_.reset();
    switch (kind) {
        case Fault::Kind::DropOk:
            answer.erase(begin, end - begin);
            break;
        case Fault::Kind::CorruptOk:
            answer[begin] = static_cast<char>(answer[begin] ^ 0x10);
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
        case Fault::Kind::Unplug:
            answer.clear();
            silent_ = unplugged_ = true;
            break;
    }
    return answer;
}

}  // namespace leafcutter::drivers
