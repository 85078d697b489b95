// `leafcutter devices`: serial ports and USB engravers found on this host.

#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "drivers/port_discovery.h"
#include "server/cli/api_client.h"
#include "server/cli/command.h"
#include "server/cli/machine_verbs.h"

namespace leafcutter::server {

namespace {

using Json = nlohmann::ordered_json;

void print_ports_json(const std::vector<drivers::FoundPort>& ports) {
    Json list = Json::array();
    for (const drivers::FoundPort& port : ports) {
        list.push_back({{"uri", port.uri},
                        {"path", port.path},
                        {"stable_path", port.stable_path},
                        {"usb_id", port.usb_id},
                        {"description", port.description},
                        {"serial_number", port.serial_number},
                        {"trouble", port.trouble}});
    }
    const Json all = {{"format", "leafcutter-devices/1"}, {"devices", list}};
    std::printf("%s\n", all.dump(2, ' ', false, Json::error_handler_t::replace).c_str());
}

void print_text(const std::vector<drivers::FoundPort>& ports) {
    for (const drivers::FoundPort& port : ports) {
        const std::string& name = port.uri.empty() ? port.path : port.uri;
        std::printf("%-28s %-10s %s\n", name.c_str(), port.usb_id.c_str(),
                    port.description.c_str());
        if (!port.stable_path.empty()) {
            std::printf("    always at: %s\n", port.stable_path.c_str());
        }
        if (!port.trouble.empty()) {
            std::printf("    trouble: %s\n", port.trouble.c_str());
        }
    }
    if (ports.empty()) {
        std::printf("no serial port and no USB engraver found; sim:grbl is always there\n");
    }
}

}  // namespace

void add_devices_command(CLI::App& app, const CommonOptions& common) {
    CLI::App* command =
        app.add_subcommand("devices",
                           "Serial ports and USB engravers found on this host; the daemon's "
                           "machines");
    const auto api = std::make_shared<ApiOptions>();  // Shared with the callback.
    const auto of_daemon = std::make_shared<bool>(false);
    add_api_options(*command, *api);
    command->add_flag("--daemon", *of_daemon, "The daemon's machines and their state instead");
    command->fallthrough();
    command->require_subcommand(0, 1);
    add_machine_verbs(*command, api, common);
    command->callback([command, &common, api, of_daemon] {
        if (!command->get_subcommands().empty()) {
            return;
        }
        if (*of_daemon) {
            print_machines(ApiClient(*api).get("/devices"), common);
            return;
        }
        const std::vector<drivers::FoundPort> ports = drivers::find_ports();
        common.json ? print_ports_json(ports) : print_text(ports);
    });
}

}  // namespace leafcutter::server
