#include "drivers/sim/faulty_wire.h"

#include <array>
#include <charconv>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

namespace leafcutter::drivers {

namespace {

using Kind = WireFault::Kind;

constexpr std::array<std::pair<std::string_view, Kind>, 9> kNames{{
    {"flip-bit", Kind::FlipBit},
    {"drop-line", Kind::DropLine},
    {"drop-byte", Kind::DropByte},
    {"drop-ok", Kind::DropOk},
    {"garble-ok", Kind::GarbleOk},
    {"double-ok", Kind::DoubleOk},
    {"stall", Kind::Stall},
    {"reset", Kind::Reset},
    {"unplug", Kind::Unplug},
}};

}  // namespace

WireFault parse_wire_fault(std::string_view text) {
    const std::size_t colon = text.find(':');
    for (const auto& [name, kind] : kNames) {
        if (text.substr(0, colon) != name || colon == std::string_view::npos) {
            continue;
        }
        WireFault fault{kind, 0};
        const char* const last = text.data() + text.size();
        const auto [end, error] = std::from_chars(text.data() + colon + 1, last, fault.at);
        if (error == std::errc{} && end == last && fault.at > 0) {
            return fault;
        }
    }
    throw std::invalid_argument(
        fmt::format("fault \"{}\": must be flip-bit:N, drop-line:N, drop-byte:N, drop-ok:N, "
                    "garble-ok:N, double-ok:N, stall:N, reset:N or unplug:N with N > 0",
                    text));
}

// Bytes that belong to no line, real-time commands above all, pass with the line they stand before.
std::string FaultyWire::feed(std::string_view bytes) {
    std::string answer;
    for (const char byte : bytes) {
        to_machine_ += byte;
        if (byte == '\n') {
            answer += machine_->feed(disturb_line(std::exchange(to_machine_, {})));
        }
    }
    const bool whole = to_machine_.find('N') == std::string::npos;
    if (whole && !to_machine_.empty()) {
        answer += machine_->feed(std::exchange(to_machine_, {}));
    }
    answer += machine_->feed({});
    return disturb_answers(answer);
}

std::string FaultyWire::advance(double seconds) {
    return disturb_answers(machine_->advance(seconds));
}

std::string FaultyWire::disturb_line(std::string line) {
    if (++lines_ != fault_.at) {
        return line;
    }
    if (fault_.kind == Kind::DropLine) {
        return {};
    }
    if (fault_.kind == Kind::DropByte) {
        line.pop_back();
    } else if (fault_.kind == Kind::FlipBit) {
        const std::size_t middle = line.size() / 2;
        line[middle] = static_cast<char>(line[middle] ^ 1);
    }
    return line;
}

std::string FaultyWire::disturb_answers(std::string_view bytes) {
    std::string passed;
    if (silent_) {
        return passed;
    }
    for (const char byte : bytes) {
        to_host_ += byte;
        if (byte != '\n') {
            continue;
        }
        std::string line = std::exchange(to_host_, {});
        const bool ok = line.compare(0, 2, "ok") == 0;
        passed += ok && ++oks_ == fault_.at ? disturb_ok(std::move(line)) : line;
        if (silent_) {
            break;
        }
    }
    return passed;
}

std::string FaultyWire::disturb_ok(std::string line) {
    switch (fault_.kind) {
        case Kind::DropOk:
            return {};
        case Kind::GarbleOk:
            line[0] = static_cast<char>(line[0] ^ 0x10);
            return line;
        case Kind::DoubleOk:
            return line + line;
        case Kind::Stall:
            silent_ = true;
            return {};
        case Kind::Reset:
            machine_->power_cycle();
            return {};
        case Kind::Unplug:
            silent_ = unplugged_ = true;
            return {};
        default:
            return line;
    }
}

}  // namespace leafcutter::drivers
