#include "drivers/device.h"

#include <algorithm>
#include <charconv>
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

// What of a query is the session's is taken out of it; the rest goes to the transport.
struct GrblAddress {
    std::string transport;
    GrblOptions options;
};

struct NumberRange {
    double least = 0.0;
    double most = 0.0;
};

double number_in(std::string_view pair, const NumberRange& range, std::string_view address) {
    const std::size_t equals = pair.find('=');
    const char* const last = pair.data() + pair.size();
    double value = 0.0;
    const auto [stop, fault] = std::from_chars(pair.data() + equals + 1, last, value);
    if (fault != std::errc{} || stop != last || !(value >= range.least && value <= range.most)) {
        throw std::invalid_argument(fmt::format("device \"{}\": {} must be a number from {} to {}",
                                                address, pair.substr(0, equals), range.least,
                                                range.most));
    }
    return value;
}

GrblAddress split_grbl_address(std::string_view address) {
    const std::size_t question = std::min(address.find('?'), address.size());
    GrblAddress result;
    std::string query;
    for (std::size_t at = question + 1; at < address.size();) {
        const std::size_t end = std::min(address.find('&', at), address.size());
        const std::string_view pair = address.substr(at, end - at);
        at = end + 1;
        if (starts_with(pair, "power_cap=")) {
            result.options.power_cap_percent = number_in(pair, {0.1, 100.0}, address);
        } else if (starts_with(pair, "poll_ms=")) {
            const double interval_ms = number_in(pair, {100.0, 1000.0}, address);
            result.options.poll_interval = std::chrono::milliseconds(static_cast<int>(interval_ms));
        } else {
            query += fmt::format("{}{}", query.empty() ? "?" : "&", pair);
        }
    }
    result.transport = std::string(address.substr(0, question)) + query;
    return result;
}

SessionDevice::MakeSession grbl_session(const GrblOptions& options) {
    return [options](Session::Time now) -> std::unique_ptr<Session> {
        return std::make_unique<GrblSession>(now, options);
    };
}

std::unique_ptr<Session> marlin_session(Session::Time now) {
    return std::make_unique<MarlinSession>(MarlinSession::Firmware::Marlin, now);
}

std::unique_ptr<Session> smoothie_session(Session::Time now) {
    return std::make_unique<MarlinSession>(MarlinSession::Firmware::Smoothie, now);
}

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
    constexpr std::string_view kGrbl = "grbl:";
    if (starts_with(uri, kGrbl)) {
        const GrblAddress address = split_grbl_address(uri.substr(kGrbl.size()));
        return attached(uri, open_transport(address.transport), grbl_session(address.options));
    }
    if (const auto query = query_of(uri, "sim:grbl")) {
        const GrblAddress address = split_grbl_address(fmt::format("?{}", *query));
        const std::string_view rest =
            std::string_view(address.transport)
                .substr(std::min<std::size_t>(1, address.transport.size()));
        return attached(uri, open_simulated_grbl(rest), grbl_session(address.options));
    }
    if (const auto query = query_of(uri, "sim:marlin")) {
        return attached(uri, open_simulated_marlin(*query), marlin_session);
    }
    if (const auto query = query_of(uri, "sim:smoothie")) {
        return attached(uri, open_simulated_smoothie(*query), smoothie_session);
    }
    constexpr std::string_view kMarlin = "marlin:";
    if (starts_with(uri, kMarlin)) {
        return attached(uri, open_transport(uri.substr(kMarlin.size())), marlin_session);
    }
    constexpr std::string_view kSmoothie = "smoothie:";
    if (starts_with(uri, kSmoothie)) {
        return attached(uri, open_transport(uri.substr(kSmoothie.size())), smoothie_session);
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
