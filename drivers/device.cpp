#include "drivers/device.h"

#include <algorithm>
#include <optional>

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

std::unique_ptr<Session> grbl_session(Session::Time now) {
    return std::make_unique<GrblSession>(now);
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
        return attached(uri, open_transport(uri.substr(kGrbl.size())), grbl_session);
    }
    if (const auto query = query_of(uri, "sim:grbl")) {
        return attached(uri, open_simulated_grbl(*query), grbl_session);
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
