#include "drivers/device.h"

#include <algorithm>
#include <charconv>
#include <initializer_list>
#include <optional>

#include <fmt/format.h>

#include "drivers/grbl/session.h"
#include "drivers/lihuiyu/address.h"
#include "drivers/marlin/session.h"
#include "drivers/session_device.h"
#include "drivers/sim/sim_transport.h"
#include "drivers/transport.h"

namespace leafcutter::drivers {

std::string_view to_string(MachineState state) {
    switch (state) {
        case MachineState::Disconnected:
            return "disconnected";
        case MachineState::Idle:
            return "idle";
        case MachineState::Run:
            return "run";
        case MachineState::Hold:
            return "hold";
        case MachineState::Jog:
            return "jog";
        case MachineState::Home:
            return "home";
        case MachineState::Alarm:
            return "alarm";
        case MachineState::Door:
            return "door";
        case MachineState::Check:
            return "check";
        case MachineState::Sleep:
            return "sleep";
        case MachineState::Unknown:
            return "unknown";
    }
    return "unknown";
}

void Device::set_overrides(const std::array<int, 3>& /*percent*/) {
    throw Refused("overrides: this machine has none");
}

void Device::set_setting(std::string_view /*key*/, double /*value*/) {
    throw Refused("settings: this machine has none");
}

namespace {

bool starts_with(std::string_view text, std::string_view start) {
    return text.substr(0, start.size()) == start;
}

std::unique_ptr<Device> attached(std::string_view uri,
                                 std::unique_ptr<Transport> transport,
                                 const SessionDevice::MakeSession& make_session) {
    auto device =
        std::make_unique<SessionDevice>(std::string(uri), std::move(transport), make_session);
    device->attach();
    return device;
}

// What follows the ? of a simulated machine's URI; nothing for another machine.
std::optional<std::string_view> query_of(std::string_view uri, std::string_view machine) {
    const std::string_view rest = uri.substr(std::min(machine.size(), uri.size()));
    if (!starts_with(uri, machine) || (!rest.empty() && rest[0] != '?')) {
        return std::nullopt;
    }
    return rest.substr(std::min<std::size_t>(rest.size(), 1));
}

// A number that a session takes from the query of its URI.
struct SessionOption {
    std::string_view key;
    double least = 0.0;
    double most = 0.0;
    double& value;
};

double number_in(std::string_view text, const SessionOption& option, std::string_view address) {
    const char* const last = text.data() + text.size();
    double value = 0.0;
    const auto [stop, fault] = std::from_chars(text.data(), last, value);
    if (fault != std::errc{} || stop != last || !(value >= option.least && value <= option.most)) {
        throw std::invalid_argument(fmt::format("device \"{}\": {} must be a number from {} to {}",
                                                address, option.key, option.least, option.most));
    }
    return value;
}

// Takes them out of the query. Returns what is left, for the transport.
std::string take_options(std::string_view address, std::initializer_list<SessionOption> options) {
    const std::size_t question = std::min(address.find('?'), address.size());
    std::string query;
    for (std::size_t at = question + 1; at < address.size();) {
        const std::size_t end = std::min(address.find('&', at), address.size());
        const std::string_view pair = address.substr(at, end - at);
        at = end + 1;
        const std::size_t equals = std::min(pair.find('='), pair.size());
        const auto option = std::find_if(
            options.begin(), options.end(),
            [&](const SessionOption& each) { return each.key == pair.substr(0, equals); });
        if (option == options.end()) {
            query += fmt::format("{}{}", query.empty() ? "?" : "&", pair);
        } else {
            option->value =
                number_in(pair.substr(std::min(equals + 1, pair.size())), *option, address);
        }
    }
    return std::string(address.substr(0, question)) + query;
}

std::string_view without_question(std::string_view query) {
    return query.substr(std::min<std::size_t>(1, query.size()));
}

struct SessionAddress {
    std::string transport;
    SessionDevice::MakeSession make_session;
};

SessionAddress grbl_address(std::string_view address) {
    GrblOptions options;
    double poll_ms = static_cast<double>(options.poll_interval.count());
    std::string transport =
        take_options(address, {{"power_cap", 0.1, 100.0, options.power_cap_percent},
                               {"poll_ms", 100.0, 1000.0, poll_ms}});
    options.poll_interval = std::chrono::milliseconds(static_cast<int>(poll_ms));
    return {std::move(transport), [options](Session::Time now) -> std::unique_ptr<Session> {
                return std::make_unique<GrblSession>(now, options);
            }};
}

SessionAddress line_address(MarlinSession::Firmware firmware, std::string_view address) {
    constexpr double kLongest = 1e5;
    MarlinOptions options;
    double s_max = 0.0;
    std::string transport =
        take_options(address, {{"power_cap", 0.1, 100.0, options.power_cap_percent},
                               {"s_max", 0.001, kLongest, s_max},
                               {"width", 1.0, kLongest, options.bed_mm[0]},
                               {"height", 1.0, kLongest, options.bed_mm[1]}});
    options.s_max = s_max > 0.0 ? std::optional(s_max) : std::nullopt;
    return {std::move(transport),
            [firmware, options](Session::Time now) -> std::unique_ptr<Session> {
                return std::make_unique<MarlinSession>(firmware, now, options);
            }};
}

using OpenTransport = std::unique_ptr<Transport> (*)(std::string_view address);

// A family of controllers, behind a link or simulated.
struct Family {
    std::string_view linked;
    std::string_view simulated;
    SessionAddress (*address)(std::string_view text);
    OpenTransport open_simulated;
};

constexpr Family kFamilies[] = {
    {"grbl:", "sim:grbl", grbl_address, open_simulated_grbl},
    {"marlin:", "sim:marlin",
     [](std::string_view text) { return line_address(MarlinSession::Firmware::Marlin, text); },
     open_simulated_marlin},
    {"smoothie:", "sim:smoothie",
     [](std::string_view text) { return line_address(MarlinSession::Firmware::Smoothie, text); },
     open_simulated_smoothie}};

}  // namespace

bool is_device_uri(std::string_view uri) {
    constexpr std::string_view kLinked[] = {"grbl:", "marlin:", "smoothie:", "lihuiyu:"};
    constexpr std::string_view kSimulated[] = {"sim:grbl", "sim:marlin", "sim:smoothie",
                                               "sim:lihuiyu"};
    return std::any_of(std::begin(kLinked), std::end(kLinked),
                       [uri](std::string_view kind) { return starts_with(uri, kind); }) ||
           std::any_of(std::begin(kSimulated), std::end(kSimulated),
                       [uri](std::string_view kind) { return query_of(uri, kind).has_value(); });
}

std::unique_ptr<Device> open_device(std::string_view uri) {
    for (const Family& family : kFamilies) {
        if (starts_with(uri, family.linked)) {
            const SessionAddress address = family.address(uri.substr(family.linked.size()));
            return attached(uri, open_transport(address.transport), address.make_session);
        }
        if (const auto query = query_of(uri, family.simulated)) {
            const SessionAddress address = family.address(fmt::format("?{}", *query));
            return attached(uri, family.open_simulated(without_question(address.transport)),
                            address.make_session);
        }
    }
    if (starts_with(uri, "lihuiyu:") || uri == "sim:lihuiyu" || starts_with(uri, "sim:lihuiyu?")) {
        return open_lihuiyu(uri);
    }
    throw std::invalid_argument(
        "device \"" + std::string(uri) +
        "\": must be grbl:/dev/PORT?baud=N, grbl:tcp://host:port, marlin:…, "
        "smoothie:… alike, lihuiyu:usb?bus=N&address=N, sim:grbl, sim:marlin, sim:smoothie or "
        "sim:lihuiyu");
}

}  // namespace leafcutter::drivers
