// Cuts. Nothing here fires a laser but start and confirm-sheet, which name the exact program.

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "server/app.h"
#include "server/http/api/handlers.h"
#include "server/http/api/lookup.h"
#include "server/http/api/views.h"
#include "server/http/json_body.h"
#include "server/http/problem.h"

namespace leafcutter::server {

namespace {

using nlohmann::json;

HttpProblem not_now(const CutRecord& cut, const std::string& action) {
    return {409, "not-now",
            fmt::format("a cut that is {} does not take \"{}\"", to_string(cut.state), action)};
}

HttpProblem no_sheet_list() {
    return {422, "bad-field", "sheets: must be a list of sheet numbers"};
}

std::vector<int> sheets_in(const json& body) {
    const auto found = body.find("sheets");
    if (found == body.end() || found->is_null()) {
        return {};
    }
    if (!found->is_array()) {
        throw no_sheet_list();
    }
    std::vector<int> sheets;
    for (const json& sheet : *found) {
        if (!sheet.is_number_integer() || sheet < 1 || sheet > 1000000) {
            throw no_sheet_list();
        }
        sheets.push_back(sheet.get<int>());
    }
    return sheets;
}

// The operator's word: this very program, and nothing on the bed but fresh material.
void check_consent(const json& body, const CutRecord& cut) {
    const auto program = body.find("program_sha256");
    if (program == body.end() || !program->is_string()) {
        throw HttpProblem(422, "bad-field", "program_sha256: name the program that is to be cut");
    }
    if (program->get<std::string>() != cut.program_sha256) {
        throw HttpProblem(409, "other-program",
                          "this is not the program of the cut's current sheet");
    }
    const auto clear = body.find("bed_clear");
    if (clear == body.end() || *clear != true) {
        throw HttpProblem(422, "bad-field", "bed_clear: must be true, said by someone who looked");
    }
}

Response arm(App& app, const Request& request, CutState from, const std::string& action) {
    const CutRecord cut = find_cut(app, request);
    const json body = read_json_object(request);
    if (cut.state != from) {
        throw not_now(cut, action);
    }
    check_consent(body, cut);
    const auto runner = app.fleet().find(cut.device);
    if (!runner || !cut_allows(app, cut, action)) {
        throw HttpProblem(409, "device-not-ready",
                          "the machine is not idle, or another cut has it");
    }
    if (!app.store().cuts.arm(cut)) {
        throw HttpProblem(409, "not-now",
                          "something else happened to the cut or its machine just now");
    }
    runner->wake();
    return json_response(cut_json(app, find_cut(app, request)), 202);
}

// Pause and resume go straight to the machine; the cut's state follows what the machine then does.
template <typename Act>
Response tell_runner(App& app, const Request& request, const std::string& action, Act act) {
    const CutRecord cut = find_cut(app, request);
    const auto runner = app.fleet().find(cut.device);
    if (!runner || !act(*runner, cut.id)) {
        throw not_now(cut, action);
    }
    return json_response(cut_json(app, cut), 202);
}

}  // namespace

Response create_cut(App& app, Request& request) {
    const JobRecord job = find_job(app, request);
    const json body = read_json_object(request);
    const auto device = body.find("device");
    if (device == body.end() || !device->is_string()) {
        throw HttpProblem(422, "bad-field", "device: name the machine");
    }
    const auto runner = app.fleet().find(device->get<std::string>());
    if (!runner) {
        throw HttpProblem(422, "no-such-device", "device: there is no machine of that id");
    }
    const CutRecord cut = app.store().cuts.add(job.id, runner->record().id, sheets_in(body));
    runner->wake();
    Response response = json_response(cut_json(app, cut), 201);
    response.headers["Location"] = "/api/v1/cuts/" + cut.id;
    return response;
}

Response list_cuts(App& app, Request&) {
    constexpr int kMost = 200;
    json cuts = json::array();
    for (const CutRecord& cut : app.store().cuts.list(kMost)) {
        cuts.push_back(cut_json(app, cut));
    }
    return json_response({{"cuts", cuts}});
}

Response show_cut(App& app, Request& request) {
    return json_response(cut_json(app, find_cut(app, request)));
}

Response start_cut(App& app, Request& request) {
    return arm(app, request, CutState::Waiting, "start");
}

Response confirm_sheet(App& app, Request& request) {
    return arm(app, request, CutState::AwaitingSheet, "confirm-sheet");
}

Response pause_cut(App& app, Request& request) {
    return tell_runner(app, request, "pause", [](DeviceRunner& runner, const std::string& cut) {
        return runner.pause(cut);
    });
}

Response resume_cut(App& app, Request& request) {
    return tell_runner(app, request, "resume", [](DeviceRunner& runner, const std::string& cut) {
        return runner.resume(cut);
    });
}

Response abort_cut(App& app, Request& request) {
    // An armed cut may begin between two looks at it: then the runner is the one to ask.
    constexpr int kLooks = 3;
    for (int look = 0; look < kLooks; ++look) {
        const CutRecord cut = find_cut(app, request);
        const auto runner = app.fleet().find(cut.device);
        if (runner && runner->abort(cut.id)) {
            return json_response(cut_json(app, cut), 202);
        }
        if (!may_follow(cut.state, CutState::Aborted)) {
            throw not_now(cut, "abort");
        }
        if (app.store().cuts.move(cut.id, cut.state, CutState::Aborted, "aborted by an operator")) {
            if (runner) {
                runner->wake();  // The machine is free for the next one.
            }
            return json_response(cut_json(app, find_cut(app, request)), 202);
        }
    }
    throw HttpProblem(503, "busy", "the cut changes too fast: try again");
}

}  // namespace leafcutter::server
