// Machines: what is known of them, and what hands do to them. Stop and hold go straight to the
// machine, past every queue and the database.

#include <array>
#include <cmath>
#include <functional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "drivers/port_discovery.h"
#include "server/app.h"
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
                   key != "console") {
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
    {"console",
     [](DeviceRunner& runner, const json& body) { runner.console(console_line_in(body)); },
     Role::Operator, Beam::MayFire},
};

}  // namespace

Response list_devices(App& app, Request&) {
    json devices = json::array();
    for (const auto& runner : app.fleet().all()) {
        devices.push_back(device_json(*runner));
    }
    return json_response({{"devices", devices}});
}

Response show_device(App& app, Request& request) {
    return json_response(device_json(*find_device(app, request)));
}

Response put_device(App& app, Request& request) {
    const std::string& id = request.capture("id");
    const bool is_new = app.fleet().find(id) == nullptr;
    app.fleet().put(device_in(read_json_object(request), id, app.burn_logs()));
    app.hub().post("device", id);
    return json_response(device_json(*find_device(app, request)), is_new ? 201 : 200);
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
                    "must be home, unlock, jog, frame, hold, resume, stop, reset or console");
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
