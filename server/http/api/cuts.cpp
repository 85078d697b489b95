// Cuts. Nothing here fires a laser but start and confirm-sheet, which name the exact program.

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "server/app.h"
#include "server/http/api/handlers.h"
#include "server/http/api/lookup.h"
#include "server/http/api/views.h"
#include "server/http/guard.h"
#include "server/http/json_body.h"
#include "server/http/problem.h"
#include "server/queue/spread.h"
#include "server/store/blobs.h"

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

// Said by someone who looked; anything but true is no word.
bool says(const json& body, const char* field) {
    const auto found = body.find(field);
    return found != body.end() && *found == true;
}

// What is burnt already: what the journal knows, or where it can't, what the operator saw.
double burnt_part(const json& body, const BeamRecord& beam) {
    const auto said = body.find("burnt_mm");
    if (said != body.end() && !said->is_null()) {
        // A ruler is not exact: a little beyond what can be is still taken.
        constexpr double kRuler = 5.0;
        const bool plausible = said->is_number() && said->get<double>() >= beam.least_mm - kRuler &&
                               said->get<double>() <= beam.most_mm + kRuler;
        if (!plausible) {
            throw HttpProblem(422, "bad-field",
                              fmt::format("burnt_mm: must lie between {:.1f} and {:.1f}",
                                          beam.least_mm, beam.most_mm));
        }
        return said->get<double>();
    }
    if (!beam.certain) {
        throw HttpProblem(
            409, "beam-unknown",
            fmt::format(
                "the beam stopped somewhere between {:.1f} and {:.1f} mm: look at the "
                "sheet and say burnt_mm. A machine that lost its power stopped near {:.1f}; "
                "one that only lost its link did all it had been sent, {:.1f}",
                beam.least_mm, beam.most_mm, beam.likely_mm, beam.most_mm));
    }
    return beam.likely_mm;
}

void check_finish(App& app, const json& body, const CutRecord& cut) {
    if (!says(body, "material_in_place")) {
        throw HttpProblem(422, "bad-field",
                          "material_in_place: must be true: the sheet lies as it lay");
    }
    if (!cut.beam->position_kept && !says(body, "homed")) {
        throw HttpProblem(422, "bad-field",
                          "homed: must be true: the machine lost its position, home it first");
    }
    const auto runner = app.fleet().find(cut.device);
    if (!runner || !runner->is_ready()) {
        throw HttpProblem(409, "device-not-ready", "the machine is not idle: unlock or home it");
    }
    const auto origin = origin_of_cut(app.store(), cut);
    const drivers::DeviceStatus status = runner->status();
    for (std::size_t axis = 0; origin && axis < 2; ++axis) {
        constexpr double kSame = 0.1;
        const double now = status.machine_position_mm[axis] - status.work_position_mm[axis];
        if (std::abs(now - (*origin)[axis]) > kSame && !says(body, "origin_set_again")) {
            throw HttpProblem(409, "origin-moved",
                              fmt::format("the work origin lay at {:.2f}, {:.2f} of the machine "
                                          "and does no more: set it back, or say origin_set_again",
                                          (*origin)[0], (*origin)[1]));
        }
    }
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

using Machines = std::vector<Machine>;

Machines one_machine(App& app, const json& body) {
    const auto device = body.find("device");
    if (device == body.end() || !device->is_string()) {
        throw HttpProblem(422, "bad-field", "device: name the machine");
    }
    auto machine = find_machine(app, device->get<std::string>());
    if (!machine) {
        throw HttpProblem(422, "no-such-device", "device: there is no machine of that id");
    }
    return {*std::move(machine)};
}

// "auto": every machine that is connected.
Machines machines_in(App& app, const json& wanted) {
    Machines machines;
    if (wanted == "auto") {
        for (Machine& machine : all_machines(app)) {
            if (machine.connected) {
                machines.push_back(std::move(machine));
            }
        }
        if (machines.empty()) {
            throw HttpProblem(409, "device-not-ready", "no machine is connected");
        }
        return machines;
    }
    if (!wanted.is_array() || wanted.empty()) {
        throw HttpProblem(422, "bad-field", "devices: must be a list of machines, or \"auto\"");
    }
    for (const json& id : wanted) {
        auto machine = id.is_string() ? find_machine(app, id.get<std::string>()) : std::nullopt;
        const bool again =
            machine && std::any_of(machines.begin(), machines.end(), [&](const Machine& other) {
                return other.record.id == machine->record.id;
            });
        if (!machine || again) {
            throw HttpProblem(
                422, "no-such-device",
                fmt::format("devices: there is no machine {}, or it is there twice", id.dump()));
        }
        machines.push_back(*std::move(machine));
    }
    return machines;
}

std::vector<CutPlace> places_of(App& app, const Machines& machines) {
    std::vector<CutPlace> places;
    for (const Machine& machine : machines) {
        CutPlace place{machine.record.id, machine.record.bed_mm};
        for (const CutRecord& cut : app.store().cuts.open_on(place.device)) {
            const auto job = app.store().jobs.find(cut.job);
            for (std::size_t i = cut.position; job && i < cut.sheets.size(); ++i) {
                for (const SheetRecord& sheet : job->sheets) {
                    place.busy_s += sheet.number == cut.sheets[i] ? sheet.estimated_s : 0.0;
                }
            }
        }
        places.push_back(std::move(place));
    }
    return places;
}

// Those that are named, or those not cut yet, or all if every one is.
std::vector<SheetRecord> wanted_sheets(const JobRecord& job, const std::vector<int>& named) {
    std::vector<SheetRecord> wanted;
    for (const int number : named) {
        const auto found =
            std::find_if(job.sheets.begin(), job.sheets.end(),
                         [number](const SheetRecord& sheet) { return sheet.number == number; });
        if (found == job.sheets.end()) {
            throw NotCuttable(fmt::format("the job has no sheet {}", number));
        }
        wanted.push_back(*found);
    }
    for (const bool uncut_only : {true, false}) {
        if (!wanted.empty()) {
            return wanted;
        }
        std::copy_if(job.sheets.begin(), job.sheets.end(), std::back_inserter(wanted),
                     [uncut_only](const SheetRecord& sheet) {
                         return !sheet.program_sha256.empty() && !(uncut_only && sheet.cut);
                     });
    }
    if (!wanted.empty()) {
        return wanted;
    }
    throw NotCuttable("the job has no sheets");
}

// Apart from the keys of jobs, which have no line end.
std::optional<IdempotencyKey> key_of(const Request& request, const json& body) {
    const auto key = request.header("idempotency-key");
    if (!key) {
        return std::nullopt;
    }
    return IdempotencyKey{fmt::format("{}\n{}", request.caller.name, *key),
                          sha256_of(fmt::format("{}\n{}", request.capture("id"), body.dump()))};
}

}  // namespace

Response create_cut(App& app, Request& request) {
    const JobRecord job = find_job(app, request);
    const json body = read_json_object(request);
    const bool spread = body.count("devices") != 0;
    const Machines machines =
        spread ? machines_in(app, body.at("devices")) : one_machine(app, body);
    for (const Machine& machine : machines) {
        if (machine.record.auto_start) {
            admit(request, Role::Operator, Beam::MayFire);
        }
    }
    const std::vector<CutWish> wishes =
        spread ? spread_sheets(wanted_sheets(job, sheets_in(body)), places_of(app, machines))
               : std::vector<CutWish>{{machines.front().record.id, sheets_in(body)}};
    const std::vector<CutRecord> cuts = app.store().cuts.add(job.id, wishes, key_of(request, body));
    for (const Machine& machine : machines) {
        if (machine.runner) {  // Other nodes hear of it from the database.
            machine.runner->wake();
        }
    }
    json made = json::array();
    for (const CutRecord& cut : cuts) {
        made.push_back(cut_json(app, cut));
    }
    Response response = json_response(spread ? json{{"cuts", made}} : made.front(), 201);
    response.headers["Location"] = "/api/v1/cuts/" + cuts.front().id;
    return response;
}

Response list_cuts(App& app, Request& request) {
    const Page page = page_in(request);
    json cuts = json::array();
    const std::vector<CutRecord> records = app.store().cuts.list(page.limit, page.cursor);
    for (const CutRecord& cut : records) {
        cuts.push_back(cut_json(app, cut));
    }
    const bool full = static_cast<int>(records.size()) == page.limit;
    const json cursor = full ? json(std::to_string(records.back().ordinal)) : json();
    return json_response({{"cuts", cuts}, {"next_cursor", cursor}});
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

Response finish_cut(App& app, Request& request) {
    const CutRecord cut = find_cut(app, request);
    const json body = read_json_object(request);
    if (!cut_allows(app, cut, "finish")) {
        throw not_now(cut, "finish");
    }
    check_finish(app, body, cut);
    const double burnt_mm = burnt_part(body, *cut.beam);
    const std::string program = rest_program(app.store(), cut, burnt_mm);
    if (program.empty()) {
        throw HttpProblem(409, "nothing-left", "all of this sheet is burnt");
    }
    const auto rest = app.store().cuts.add_rest(cut, app.store().blobs.put(program).sha256);
    if (!rest) {
        throw HttpProblem(409, "not-now", "something else happened to the cut just now");
    }
    app.fleet().find(cut.device)->wake();
    Response response = json_response(cut_json(app, *rest), 201);
    response.headers["Location"] = "/api/v1/cuts/" + rest->id;
    return response;
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
        admit(request, Role::Operator, Beam::Off);  // Anybody may stop a beam, not empty a queue.
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
