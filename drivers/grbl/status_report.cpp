#include "drivers/grbl/status_report.h"

#include <charconv>
#include <cmath>
#include <utility>
#include <vector>

namespace leafcutter::drivers {

namespace {

std::vector<std::string_view> split(std::string_view text, char separator) {
    std::vector<std::string_view> parts;
    std::size_t begin = 0;
    for (std::size_t i = 0; i <= text.size(); ++i) {
        if (i == text.size() || text[i] == separator) {
            parts.push_back(text.substr(begin, i - begin));
            begin = i + 1;
        }
    }
    return parts;
}

template <typename Number>
std::optional<Number> read_number(std::string_view text) {
    Number value{};
    const char* const last = text.data() + text.size();
    const auto [end, error] = std::from_chars(text.data(), last, value);
    if (error != std::errc{} || end != last) {
        return std::nullopt;
    }
    if constexpr (std::is_floating_point_v<Number>) {
        if (!std::isfinite(value)) {
            return std::nullopt;
        }
    }
    return value;
}

// Takes the first numbers; a machine may have more axes than we look at, or fewer.
template <typename Number, std::size_t Count>
std::optional<std::array<Number, Count>> read_list(std::string_view text, std::size_t needed) {
    std::array<Number, Count> values{};
    const auto parts = split(text, ',');
    if (parts.size() < needed) {
        return std::nullopt;
    }
    for (std::size_t i = 0; i < std::min(Count, parts.size()); ++i) {
        const auto value = read_number<Number>(parts[i]);
        if (!value) {
            return std::nullopt;
        }
        values[i] = *value;
    }
    return values;
}

MachineState state_of(std::string_view name) {
    constexpr std::array<std::pair<std::string_view, MachineState>, 9> kStates{{
        {"Idle", MachineState::Idle},
        {"Run", MachineState::Run},
        {"Hold", MachineState::Hold},
        {"Jog", MachineState::Jog},
        {"Home", MachineState::Home},
        {"Alarm", MachineState::Alarm},
        {"Door", MachineState::Door},
        {"Check", MachineState::Check},
        {"Sleep", MachineState::Sleep},
    }};
    for (const auto& [known, state] : kStates) {
        if (known == name) {
            return state;
        }
    }
    return MachineState::Unknown;
}

// Returns false for a broken field.
bool read_field(std::string_view field, StatusReport& report) {
    const std::size_t colon = field.find(':');
    if (colon == std::string_view::npos) {
        return true;
    }
    const std::string_view name = field.substr(0, colon);
    const std::string_view value = field.substr(colon + 1);
    if (name == "MPos") {
        return (report.machine_position = read_list<double, 3>(value, 2)).has_value();
    }
    if (name == "WPos") {
        return (report.work_position = read_list<double, 3>(value, 2)).has_value();
    }
    if (name == "WCO") {
        return (report.work_offset = read_list<double, 3>(value, 2)).has_value();
    }
    if (name == "Bf") {
        return (report.free_buffers = read_list<int, 2>(value, 2)).has_value();
    }
    if (name == "Ov") {
        return (report.override_percent = read_list<int, 3>(value, 3)).has_value();
    }
    if (name == "F") {
        return (report.feed = read_number<double>(value)).has_value();
    }
    if (name == "FS") {
        const auto both = read_list<double, 2>(value, 2);
        if (both) {
            report.feed = (*both)[0];
            report.power_s = (*both)[1];
        }
        return both.has_value();
    }
    return true;
}

}  // namespace

std::optional<StatusReport> parse_status_report(std::string_view line) {
    if (line.size() < 3 || line.front() != '<' || line.back() != '>') {
        return std::nullopt;
    }
    const auto fields = split(line.substr(1, line.size() - 2), '|');
    StatusReport report;
    const std::size_t colon = fields[0].find(':');
    report.state = state_of(fields[0].substr(0, colon));
    if (colon != std::string_view::npos) {
        report.sub_state = read_number<int>(fields[0].substr(colon + 1));
    }
    for (std::size_t i = 1; i < fields.size(); ++i) {
        if (!read_field(fields[i], report)) {
            return std::nullopt;
        }
    }
    return report;
}

}  // namespace leafcutter::drivers
