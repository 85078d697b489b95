#include "server/cli/machine_verbs.h"

#include <array>
#include <cstdio>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace leafcutter::server {

namespace {

using nlohmann::json;

struct MachineOptions {
    std::shared_ptr<ApiOptions> api;
    std::string id;
    std::string text;  // A line for the console, or a URI.
    std::string name;
    std::vector<double> bed_mm;
    bool auto_start = false;
    double dx_mm = 0.0;
    double dy_mm = 0.0;
    double feed_mm_per_min = 0.0;
    std::array<int, 3> percent{};  // Feed, rapid, power; 0: as it is.

    std::string path() const { return "/devices/" + id; }
};

using Options = std::shared_ptr<MachineOptions>;

void print_machine(const json& device) {
    const json& cut = device.at("cut");
    std::printf("%-16s %-14s %-28s %s\n", device.at("id").get<std::string>().c_str(),
                device.at("status").at("state").get<std::string>().c_str(),
                cut.is_string() ? cut.get<std::string>().c_str() : "-",
                device.at("uri").get<std::string>().c_str());
}

// `act` takes a client; what it returns is shown, null says nothing.
template <typename Act>
CLI::App* add_verb(CLI::App& devices,
                   const Options& options,
                   const CommonOptions& common,
                   std::pair<const char*, const char*> words,
                   Act act) {
    CLI::App* verb = devices.add_subcommand(words.first, words.second);
    verb->add_option("device", options->id, "A machine's id")->required();
    verb->callback([options, &common, act] {
        ApiClient client(*options->api);
        const json answer = act(client);
        if (common.json) {
            print_json(answer);
        } else if (answer.is_object() && answer.count("status") != 0) {
            print_machine(answer);
        }
    });
    return verb;
}

json commanded(ApiClient& client, const MachineOptions& options, json command) {
    return client.post(options.path() + "/commands", command);
}

void add_plain_commands(CLI::App& devices, const Options& options, const CommonOptions& common) {
    constexpr std::array<std::pair<const char*, const char*>, 7> kWords{
        std::pair{"home", "Find its origin"},
        std::pair{"unlock", "End an alarm without homing"},
        std::pair{"frame", "Trace the waiting sheet's bounding box, beam off"},
        std::pair{"hold", "Hold at once, beam off"},
        std::pair{"resume", "Go on after a hold"},
        std::pair{"stop", "Stop at once: the cut in work is over"},
        std::pair{"reset", "Connect anew, or wake the controller up"}};
    for (const auto& words : kWords) {
        add_verb(devices, options, common, words, [options, word = words.first](ApiClient& client) {
            return commanded(client, *options, {{"command", word}});
        });
    }
}

json jog_of(const MachineOptions& options) {
    json command = {{"command", "jog"}, {"dx_mm", options.dx_mm}, {"dy_mm", options.dy_mm}};
    if (options.feed_mm_per_min > 0.0) {
        command["feed_mm_per_min"] = options.feed_mm_per_min;
    }
    return command;
}

json overrides_of(const MachineOptions& options) {
    constexpr std::array<const char*, 3> kNames{"feed", "rapid", "power"};
    json command = {{"command", "override"}};
    for (std::size_t i = 0; i < kNames.size(); ++i) {
        if (options.percent.at(i) != 0) {
            command[kNames.at(i)] = options.percent.at(i);
        }
    }
    return command;
}

void add_commands_with_values(CLI::App& devices,
                              const Options& options,
                              const CommonOptions& common) {
    CLI::App* jog = add_verb(
        devices, options, common, {"jog", "Move the head, beam off"},
        [options](ApiClient& client) { return commanded(client, *options, jog_of(*options)); });
    jog->add_option("--dx", options->dx_mm, "mm");
    jog->add_option("--dy", options->dy_mm, "mm");
    jog->add_option("--feed", options->feed_mm_per_min, "mm/min")->check(CLI::PositiveNumber);
    CLI::App* change =
        add_verb(devices, options, common, {"override", "Change speed and power while it cuts"},
                 [options](ApiClient& client) {
                     return commanded(client, *options, overrides_of(*options));
                 });
    change->add_option("--feed", options->percent[0], "percent");
    change->add_option("--rapid", options->percent[1], "percent: 25, 50, 100");
    change->add_option("--power", options->percent[2], "percent");
    add_verb(
        devices, options, common, {"console", "One line to the controller"},
        [options](ApiClient& client) {
            return commanded(client, *options, {{"command", "console"}, {"line", options->text}});
        })
        ->add_option("line", options->text, "As the controller takes it")
        ->required();
}

json described(const MachineOptions& options) {
    json device = {{"uri", options.text}, {"auto_start", options.auto_start}};
    if (!options.name.empty()) {
        device["name"] = options.name;
    }
    if (!options.bed_mm.empty()) {
        device["bed_mm"] = options.bed_mm;
    }
    return device;
}

}  // namespace

void add_machine_verbs(CLI::App& devices,
                       const std::shared_ptr<ApiOptions>& api,
                       const CommonOptions& common) {
    const auto options = std::make_shared<MachineOptions>();  // Shared with the callbacks.
    options->api = api;
    add_plain_commands(devices, options, common);
    add_commands_with_values(devices, options, common);
    add_verb(devices, options, common, {"show", "One of the daemon's"},
             [options](ApiClient& client) { return client.get(options->path()); });
    CLI::App* put = add_verb(
        devices, options, common, {"put", "Give the daemon a machine, or change one"},
        [options](ApiClient& client) { return client.put(options->path(), described(*options)); });
    put->add_option("uri", options->text, "grbl:/dev/ttyUSB0, lihuiyu:usb, sim:grbl")->required();
    put->add_option("--name", options->name, "For people");
    put->add_option("--bed", options->bed_mm, "Width and height in mm")->expected(2);
    put->add_flag("--auto-start", options->auto_start, "It cuts without an operator's word");
    add_verb(devices, options, common, {"remove", "Take one from the daemon"},
             [options](ApiClient& client) { return client.remove(options->path()); });
}

void print_machines(const json& answer, const CommonOptions& common) {
    if (common.json) {
        print_json(answer);
        return;
    }
    for (const json& device : answer.at("devices")) {
        print_machine(device);
    }
}

}  // namespace leafcutter::server
