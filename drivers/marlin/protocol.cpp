#include "drivers/marlin/protocol.h"

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

namespace leafcutter::drivers {

namespace {

constexpr std::size_t kLongestReply = 512;

bool starts_with(std::string_view text, std::string_view start) {
    return text.substr(0, start.size()) == start;
}

std::size_t number_in(std::string_view text) {
    const std::size_t at = text.find_first_of("0123456789");
    std::size_t number = 0;
    if (at != std::string_view::npos) {
        std::from_chars(text.data() + at, text.data() + text.size(), number);
    }
    return number;
}

bool is_ack(std::string_view line) {
    return line == "ok" || starts_with(line, "ok ");
}

bool is_resend(std::string_view line) {
    return starts_with(line, "Resend:") || starts_with(line, "resend:") || starts_with(line, "rs ");
}

bool is_halt(std::string_view line) {
    constexpr std::string_view kSigns[] = {"Printer halted", "Alarm lock", "Entering Alarm",
                                           "exit HALT state"};
    return starts_with(line, "!!") || starts_with(line, "ALARM:") ||
           std::any_of(std::begin(kSigns), std::end(kSigns), [line](std::string_view sign) {
               return line.find(sign) != std::string_view::npos;
           });
}

// What comes without having been asked for, and answers that are no "ok".
MarlinEvent::Kind kind_of_notice(std::string_view line) {
    using Kind = MarlinEvent::Kind;
    if (starts_with(line, "echo:busy") || starts_with(line, "busy:")) {
        return Kind::Busy;
    }
    if (starts_with(line, "echo:Unknown command")) {
        return Kind::Unknown;
    }
    if (line == "wait") {
        return Kind::Waiting;
    }
    if (line == "start" || line == "Smoothie") {
        return Kind::Restart;
    }
    if (starts_with(line, "Grbl")) {
        return Kind::Foreign;
    }
    if (line.front() == '<' && line.back() == '>') {
        return Kind::Status;
    }
    if (starts_with(line, "FIRMWARE_NAME:")) {
        return Kind::Firmware;
    }
    if (starts_with(line, "Cap:")) {
        return Kind::Capability;
    }
    return starts_with(line, "X:") && parse_position(line) ? Kind::Position : Kind::Other;
}

MarlinEvent::Kind kind_of(std::string_view line) {
    using Kind = MarlinEvent::Kind;
    if (is_halt(line)) {
        return Kind::Halted;
    }
    if (is_ack(line)) {
        return Kind::Ack;
    }
    if (is_resend(line)) {
        return Kind::Resend;
    }
    if (starts_with(line, "Error:") || starts_with(line, "error:")) {
        return Kind::Error;
    }
    return kind_of_notice(line);
}

std::optional<double> value_of(std::string_view text, std::string_view name) {
    const std::size_t at = text.find(name);
    if (at == std::string_view::npos) {
        return std::nullopt;
    }
    const std::string rest(text.substr(at + name.size(), 32));
    char* end = nullptr;
    const double value = std::strtod(rest.c_str(), &end);
    return end == rest.c_str() ? std::nullopt : std::optional(value);
}

}  // namespace

std::vector<MarlinEvent> MarlinProtocol::receive(std::string_view bytes) {
    std::vector<MarlinEvent> events;
    for (const char byte : bytes) {
        const bool line_end = byte == '\n' || byte == '\r';
        if (!line_end) {
            partial_ += byte;
        }
        if ((line_end && !partial_.empty()) || partial_.size() >= kLongestReply) {
            MarlinEvent event;
            event.text = std::exchange(partial_, {});
            event.kind = kind_of(event.text);
            if (event.kind == MarlinEvent::Kind::Resend) {
                event.number = number_in(event.text);
            }
            events.push_back(std::move(event));
        }
    }
    return events;
}

std::string numbered_line(std::size_t number, std::string_view line) {
    const bool foreign = std::any_of(line.begin(), line.end(), [](char byte) {
        const auto code = static_cast<unsigned char>(byte);
        return code < ' ' || code > '~' || byte == '*';
    });
    std::string sent = fmt::format("N{} {}", number, line);
    unsigned sum = 0;
    for (const char byte : sent) {
        sum ^= static_cast<unsigned char>(byte);
    }
    sent += fmt::format("*{}\n", sum);
    if (foreign || sent.size() > MarlinProtocol::kMaxLine) {
        throw std::invalid_argument(fmt::format("\"{}\": no line that Marlin can take", line));
    }
    return sent;
}

std::optional<MarlinPosition> parse_position(std::string_view text) {
    const std::string_view planned = text.substr(0, text.find("Count"));
    const std::optional<double> x = value_of(planned, "X:");
    const std::optional<double> y = value_of(planned, "Y:");
    if (!x || !y) {
        return std::nullopt;
    }
    return MarlinPosition{*x, *y, value_of(planned, "Z:").value_or(0.0)};
}

std::optional<std::array<double, 2>> parse_corner(std::string_view text) {
    const std::optional<double> x = value_of(text, "x:");
    const std::optional<double> y = value_of(text, "y:");
    if (!x || !y) {
        return std::nullopt;
    }
    return std::array<double, 2>{*x, *y};
}

}  // namespace leafcutter::drivers
