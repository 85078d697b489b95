// leafcutter cuts: the daemon's cuts. Starting one says what an operator says in the dashboard.

#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "server/cli/api_client.h"
#include "server/cli/command.h"
#include "server/cli/follow.h"

namespace leafcutter::server {

namespace {

using nlohmann::json;

struct CutsOptions {
    ApiOptions api;
    std::string id;
    std::vector<std::string> devices;
    std::vector<int> sheets;
    bool bed_clear = false;
    bool material_in_place = false;
    bool homed = false;
    std::optional<double> burnt_mm;
    bool wait = false;
};

void print_cut(const json& cut) {
    std::printf("%-28s %-14s %3.0f %%  %-12s sheet %d  job %s  %s\n",
                cut.at("id").get<std::string>().c_str(), cut.at("state").get<std::string>().c_str(),
                100.0 * cut.at("progress").at("fraction").get<double>(),
                cut.at("device").get<std::string>().c_str(), cut.at("sheet").get<int>(),
                cut.at("job").get<std::string>().c_str(),
                cut.at("reason").get<std::string>().c_str());
}

void show(const json& answer, const CommonOptions& common) {
    if (common.json) {
        print_json(answer);
    } else if (answer.count("cuts") != 0) {
        for (const json& cut : answer.at("cuts")) {
            print_cut(cut);
        }
    } else {
        print_cut(answer);
    }
}

json added(ApiClient& client, const CutsOptions& options) {
    json body = json::object();
    if (!options.sheets.empty()) {
        body["sheets"] = options.sheets;
    }
    if (options.devices.size() == 1 && options.devices.front() != "auto") {
        body["device"] = options.devices.front();
    } else {
        body["devices"] = options.devices.front() == "auto" ? json("auto") : json(options.devices);
    }
    return client.post(fmt::format("/jobs/{}/cuts", options.id), body);
}

// Names the program that the cut has now: who types this has looked at the bed.
json started(ApiClient& client, const CutsOptions& options) {
    if (!options.bed_clear) {
        throw UsageError("--bed-clear: say it after a look: nothing lies on the bed but the sheet");
    }
    const std::string path = "/cuts/" + options.id;
    const json cut = client.get(path);
    const std::string action = cut.at("state") == "awaiting-sheet" ? "/confirm-sheet" : "/start";
    return client.post(path + action,
                       {{"program_sha256", cut.at("program_sha256")}, {"bed_clear", true}});
}

// The rest of a cut that ended early, as a cut of its own.
json finished(ApiClient& client, const CutsOptions& options) {
    if (!options.material_in_place) {
        throw UsageError("--material-in-place: say it after a look: the sheet lies as it lay");
    }
    json body = {{"material_in_place", true}, {"homed", options.homed}};
    if (options.burnt_mm) {
        body["burnt_mm"] = *options.burnt_mm;
    }
    return client.post(fmt::format("/cuts/{}/finish", options.id), body);
}

using Options = std::shared_ptr<CutsOptions>;

template <typename Act>
CLI::App* add_verb(CLI::App& cuts,
                   const Options& options,
                   const CommonOptions& common,
                   std::pair<const char*, const char*> words,
                   Act act) {
    CLI::App* verb = cuts.add_subcommand(words.first, words.second);
    verb->add_option("id", options->id, "A cut's id; of a job's for add")->required();
    verb->callback([options, &common, act] {
        ApiClient client(options->api);
        show(act(client), common);
    });
    return verb;
}

void add_verbs(CLI::App& cuts, const Options& options, const CommonOptions& common) {
    CLI::App* add = add_verb(cuts, options, common, {"add", "Queue a job's sheets for machines"},
                             [options](ApiClient& client) { return added(client, *options); });
    add->add_option("--device", options->devices,
                    "A machine, several to spread the sheets over, or auto")
        ->required();
    add->add_option("--sheet", options->sheets, "Only these sheets");
    CLI::App* start =
        add_verb(cuts, options, common, {"start", "Let the beam loose on the cut's current sheet"},
                 [options, &common](ApiClient& client) {
                     const json cut = started(client, *options);
                     return options->wait ? follow_sheet(client, options->id, common) : cut;
                 });
    start->add_flag("--bed-clear", options->bed_clear, "You looked: only the sheet is on the bed");
    start->add_flag("--wait", options->wait, "Follow it until the sheet is cut");
    CLI::App* finish = add_verb(
        cuts, options, common, {"finish", "A new cut of what an interrupted one left of its sheet"},
        [options](ApiClient& client) { return finished(client, *options); });
    finish->add_flag("--material-in-place", options->material_in_place,
                     "You looked: the sheet lies as it lay");
    finish->add_flag("--homed", options->homed, "The machine lost its position and was homed");
    finish->add_option("--burnt-mm", options->burnt_mm,
                       "What is burnt, where the journal can't be sure");
    for (const char* word : {"pause", "resume", "abort"}) {
        add_verb(cuts, options, common, {word, "Tell the machine that cuts it"},
                 [options, word](ApiClient& client) {
                     return client.post(fmt::format("/cuts/{}/{}", options->id, word),
                                        json::object());
                 });
    }
    add_verb(
        cuts, options, common, {"wait", "Follow one until it is over"},
        [options, &common](ApiClient& client) { return follow_cut(client, options->id, common); });
    add_verb(cuts, options, common, {"show", "One of them"},
             [options](ApiClient& client) { return client.get("/cuts/" + options->id); });
}

}  // namespace

void add_cuts_command(CLI::App& app, const CommonOptions& common) {
    CLI::App* cuts = app.add_subcommand("cuts", "The daemon's cuts");
    const auto options = std::make_shared<CutsOptions>();  // Shared with the callbacks.
    add_api_options(*cuts, options->api);
    cuts->fallthrough();
    cuts->require_subcommand(0, 1);
    add_verbs(*cuts, options, common);
    cuts->callback([cuts, options, &common] {
        if (cuts->get_subcommands().empty()) {
            show(ApiClient(options->api).get("/cuts"), common);
        }
    });
}

}  // namespace leafcutter::server
