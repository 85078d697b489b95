// `leafcutter devices`: serial ports and USB engravers found on this host.

#include <cstdio>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "drivers/port_discovery.h"
#include "server/cli/command.h"

namespace leafcutter::server {

namespace {

using Json = nlohmann::ordered_json;

void print_json(const std::vector<drivers::FoundPort>& ports) {
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
        app.add_subcommand("devices", "Serial ports and USB engravers found on this host");
    command->callback([&common] {
        const std::vector<drivers::FoundPort> ports = drivers::find_ports();
        common.json ? print_json(ports) : print_text(ports);
    });
}

}  // namespace leafcutter::server
