// Machines: what is known of them, and what hands do to them. Stop and hold go straight to the
// machine, past every queue and the database.

#include <array>
#include <cmath>
#include <functional>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "drivers/port_discovery.h"
#include "server/app.h"
#include "server/http/api/conditional.h"
#include "server/http/api/handlers.h"
#include "server/http/api/lookup.h"
#include "server/http/api/views.h"
#include "server/http/guard.h"
#include "server/http/json_body.h"
#include "server/http/problem.h"

namespace leafcutter::server {

namespace {

using nlohmann::json;

std::shared_ptr<DeviceRunner> find_device(App& app, const Request& request) {
    auto runner = app.fleet().find(request.capture("id"));
    if (!runner) {
        throw HttpProblem(404, "no-such-device", "there is no machine of that id");
    }
    return runner;
}

HttpProblem bad_field(const std::string& field, const std::string& what) {
    return {422, "bad-field", fmt::format("{}: {}", field, what)};
}

double number_at(const json& body, const char* key, double otherwise) {
    const auto found = body.find(key);
    if (found == body.end()) {
        return otherwise;
    }
    constexpr double kFarthest = 1e5;
    if (!found->is_number() || !(std::abs(found->get<double>()) <= kFarthest)) {
        throw bad_field(key, "must be a number up to 100000");
    }
    return found->get<double>();
}

DeviceRecord device_in(const json& body,
                       const std::string& id,
                       const std::filesystem::path& burn_logs) {
    DeviceRecord device;
    device.id = id;
    device.name = id;
    for (const auto& [key, value] : body.items()) {
        if (key == "name" && value.is_string()) {
            device.name = value.get<std::string>();
        } else if (key == "uri" && value.is_string()) {
            device.uri = value.get<std::string>();
        } else if (key == "auto_start" && value.is_boolean()) {
            device.auto_start = value.get<bool>();
        } else if (key == "bed_mm" && value.is_array() && value.size() == 2 &&
                   value[0].is_number() && value[1].is_number()) {
            device.bed_mm = value.get<std::array<double, 2>>();
        } else if (key == "name" || key == "uri" || key == "auto_start" || key == "bed_mm") {
            throw bad_field(key, "has the wrong type");
        } else if (key != "id" && key != "status" && key != "cut" && key != "actions" &&
                   key != "console" && key != "station") {
            throw bad_field(key, "there is no such field");
        }
    }
    try {
        check_remote_device(device, burn_logs);
    } catch (const BadConfig& error) {
        throw HttpProblem(422, "bad-field", error.what());
    }
    return device;
}

drivers::Jog jog_in(const json& body) {
    drivers::Jog jog;
    jog.dx_mm = number_at(body, "dx_mm", 0.0);
    jog.dy_mm = number_at(body, "dy_mm", 0.0);
    jog.feed_mm_per_min = number_at(body, "feed_mm_per_min", jog.feed_mm_per_min);
    if (jog.feed_mm_per_min <= 0.0) {
        throw bad_field("feed_mm_per_min", "must be > 0");
    }
    return jog;
}

// One line, without the real-time letters that would act at once, past every check.
std::string console_line_in(const json& body) {
    const auto found = body.find("line");
    std::string line = found != body.end() && found->is_string() ? found->get<std::string>() : "";
    constexpr std::size_t kLongest = 80;
    bool printable = !line.empty() && line.size() <= kLongest;
    for (const char c : line) {
        printable = printable && c >= 0x20 && c < 0x7f && c != '!' && c != '~' && c != '?';
    }
    if (!printable) {
        throw bad_field("line", "must be 1 to 80 plain letters without !, ~ and ?");
    }
    return line;
}

// In percent; Grbl has these steps of rapids.
std::array<std::optional<int>, 3> overrides_in(const json& body) {
    constexpr std::array<const char*, 3> kNames{"feed", "rapid", "power"};
    std::array<std::optional<int>, 3> percent;
    for (std::size_t i = 0; i < kNames.size(); ++i) {
        const auto found = body.find(kNames.at(i));
        if (found == body.end()) {
            continue;
        }
        const bool rapid = i == 1;
        const int value = found->is_number_integer() ? found->get<int>() : 0;
        if (rapid && value != 25 && value != 50 && value != 100) {
            throw bad_field(kNames.at(i), "must be 25, 50 or 100 percent");
        }
        if (value < 10 || value > 200) {
            throw bad_field(kNames.at(i), "must be a whole percentage from 10 to 200");
        }
        percent.at(i) = value;
    }
    if (percent == std::array<std::optional<int>, 3>{}) {
        throw bad_field("feed", "one of feed, rapid and power must be given");
    }
    return percent;
}

void set_setting(DeviceRunner& runner, const json& body) {
    const auto key = body.find("key");
    if (key == body.end() || !key->is_string()) {
        throw bad_field("key", "must name a setting, like $110");
    }
    const auto value = body.find("value");
    if (value == body.end() || !value->is_number()) {
        throw bad_field("value", "must be a number");
    }
    runner.set_setting(key->get<std::string>(), value->get<double>());
}

using Command = void (*)(DeviceRunner& runner, const json& body);

struct NamedCommand {
    std::string_view name;
    Command act;
    Role least = Role::Operator;
    Beam beam = Beam::Off;
};

constexpr NamedCommand kCommands[] = {
    {"home", [](DeviceRunner& runner, const json&) { runner.home(); }},
    {"unlock", [](DeviceRunner& runner, const json&) { runner.unlock(); }},
    {"jog", [](DeviceRunner& runner, const json& body) { runner.jog(jog_in(body)); }},
    {"frame", [](DeviceRunner& runner, const json&) { runner.frame(); }},
    {"hold", [](DeviceRunner& runner, const json&) { runner.hold(); }, Role::Viewer},
    {"resume", [](DeviceRunner& runner, const json&) { runner.resume(); }, Role::Operator,
     Beam::MayFire},
    {"stop", [](DeviceRunner& runner, const json&) { runner.stop(); }, Role::Viewer},
    {"reset", [](DeviceRunner& runner, const json&) { runner.reset(); }},
    {"override",
     [](DeviceRunner& runner, const json& body) { runner.set_overrides(overrides_in(body)); }},
    {"setting", set_setting},
    {"console",
     [](DeviceRunner& runner, const json& body) { runner.console(console_line_in(body)); },
     Role::Operator, Beam::MayFire},
};

json changeable(const DeviceRecord& device) {
    return {{"id", device.id},
            {"name", device.name},
            {"uri", device.uri},
            {"auto_start", device.auto_start},
            {"bed_mm", device.bed_mm}};
}

Response tagged(const DeviceRunner& runner, int status) {
    return tagged_response(device_json(runner), changeable(runner.record()), status);
}

}  // namespace

Response list_devices(App& app, Request& request) {
    json devices = json::array();
    for (const Machine& machine : all_machines(app)) {
        devices.push_back(device_json(app, machine));
    }
    return json_response(paged("devices", std::move(devices), "id", request));
}

Response show_device(App& app, Request& request) {
    const auto machine = find_machine(app, request.capture("id"));
    if (machine && !machine->runner) {
        return tagged_response(device_json(app, *machine), changeable(machine->record), 200);
    }
    return tagged(*find_device(app, request), 200);
}

Response put_device(App& app, Request& request) {
    const std::string& id = request.capture("id");
    DeviceRecord wanted = device_in(read_json_object(request), id, app.burn_logs());
    wanted.station = app.self() == nullptr ? "" : app.self()->id;
    bool is_new = true;
    const ConditionalChange change(request, [&]() -> std::optional<json> {
        const auto known = app.fleet().find(id);
        is_new = known == nullptr;
        return known ? std::optional(changeable(known->record())) : std::nullopt;
    });
    app.fleet().put(wanted);
    app.hub().post("device", id);
    return tagged(*find_device(app, request), is_new ? 201 : 200);
}

Response delete_device(App& app, Request& request) {
    const std::string id = find_device(app, request)->record().id;
    if (!app.store().cuts.open_on(id).empty()) {
        throw HttpProblem(409, "in-use",
                          "there are cuts in this machine's queue: abort them first");
    }
    app.fleet().remove(id);
    Response gone;
    gone.status = 204;
    return gone;
}

Response command_device(App& app, Request& request) {
    const auto runner = find_device(app, request);
    const json body = read_json_object(request);
    const auto name = body.find("command");
    for (const NamedCommand& command : kCommands) {
        if (name != body.end() && *name == command.name) {
            request.audit_note = command.name;
            admit(request, command.least, command.beam);
            command.act(*runner, body);
            return json_response(json::object(), 202);
        }
    }
    throw bad_field("command",
                    "must be home, unlock, jog, frame, hold, resume, stop, reset, override, "
                    "setting or console");
}

Response list_settings(App& app, Request& request) {
    json settings = json::array();
    for (const drivers::MachineSetting& each : find_device(app, request)->settings()) {
        settings.push_back({{"key", each.key}, {"value", each.value}, {"name", each.name}});
    }
    return json_response({{"settings", settings}});
}

Response list_ports(App&, Request&) {
    json ports = json::array();
    for (const drivers::FoundPort& port : drivers::find_ports()) {
        ports.push_back({{"uri", port.uri},
                         {"path", port.path},
                         {"stable_path", port.stable_path},
                         {"usb_id", port.usb_id},
                         {"description", port.description},
                         {"serial_number", port.serial_number},
                         {"trouble", port.trouble}});
    }
    return json_response({{"ports", ports}});
}

}  // namespace leafcutter::server
