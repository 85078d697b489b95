#include "server/http/api/views.h"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "server/app.h"
#include "server/http/api/cut_steps.h"
#include "server/http/api/lookup.h"
#include "server/http/json_body.h"
#include "server/store/ids.h"

namespace leafcutter::server {

namespace {

using nlohmann::json;

// What the store holds was written by us, but a page must not fail on it.
json stored_json(const std::string& text) {
    json parsed = json::parse(text, nullptr, /*allow_exceptions=*/false);
    return parsed.is_discarded() ? json::object() : parsed;
}

std::vector<std::string> job_actions(const JobRecord& job) {
    if (job.state == JobState::Queued || job.state == JobState::Computing) {
        return job.state == JobState::Queued ? std::vector<std::string>{"cancel", "move"}
                                             : std::vector<std::string>{"cancel"};
    }
    std::vector<std::string> actions;
    if (job.state == JobState::Ready || job.state == JobState::Done) {
        actions.emplace_back("cut");
    }
    if (!is_test_card(job)) {
        if (!actions.empty()) {
            actions.emplace_back("recut");
        }
        actions.emplace_back("recompute");
    }
    if (job.state == JobState::Failed || job.state == JobState::Cancelled) {
        actions.emplace_back("retry");
    }
    if (!job.has_open_cut) {
        actions.emplace_back("remove");
    }
    return actions;
}

bool is_ready(App& app, const std::string& device) {
    if (const auto runner = app.fleet().find(device)) {
        return runner->is_ready();
    }
    const auto elsewhere = app.remote().find("device", device);
    return elsewhere && elsewhere->value("ready", false);
}

// A cut may be let loose: the machine stands idle and no other cut has it.
bool may_fire(App& app, const CutRecord& cut) {
    if (!is_ready(app, cut.device)) {
        return false;
    }
    const std::vector<CutRecord> open = app.store().cuts.open_on(cut.device);
    return std::none_of(open.begin(), open.end(), [&cut](const CutRecord& other) {
        return other.id != cut.id && occupies_device(other.state);
    });
}

// It ended early, something is left to burn, and nobody has begun that yet.
bool has_rest(App& app, const CutRecord& cut) {
    return cut.beam && cut.beam->least_mm < cut.beam->total_mm &&
           app.store().cuts.may_be_finished(cut);
}

std::vector<std::string> cut_actions(App& app, const CutRecord& cut) {
    switch (cut.state) {
        case CutState::Waiting:
            return may_fire(app, cut) ? std::vector<std::string>{"start", "abort"}
                                      : std::vector<std::string>{"abort"};
        case CutState::AwaitingSheet:
            return may_fire(app, cut) ? std::vector<std::string>{"confirm-sheet", "abort"}
                                      : std::vector<std::string>{"abort"};
        case CutState::Armed:
            return {"abort"};
        case CutState::Cutting:
            return {"pause", "abort"};
        case CutState::Paused:
            return {"resume", "abort"};
        default:
            return has_rest(app, cut) ? std::vector<std::string>{"finish"}
                                      : std::vector<std::string>{};
    }
}

// How far the beam got; null while nobody knows.
json beam_json(const CutRecord& cut) {
    if (!cut.beam) {
        return {};
    }
    const BeamRecord& beam = *cut.beam;
    return {{"burnt_mm", beam.likely_mm},
            {"least_mm", beam.least_mm},
            {"most_mm", beam.most_mm},
            {"total_mm", beam.total_mm},
            {"percent", beam.total_mm > 0.0 ? 100.0 * beam.likely_mm / beam.total_mm : 0.0},
            {"line", beam.line},
            {"at_mm", beam.at_mm},
            {"certain", beam.certain},
            {"position_kept", beam.position_kept}};
}

json progress_json(App& app, const JobRecord& job) {
    const auto running = app.compute().progress(job.id);
    const auto elsewhere = job.state == JobState::Computing && !running
                               ? app.remote().find("job", job.id)
                               : std::nullopt;
    if (elsewhere && elsewhere->contains("progress")) {
        return elsewhere->at("progress");
    }
    const bool finished = job.state == JobState::Ready || job.state == JobState::Done;
    return {{"stage", running ? running->stage : ""},
            {"fraction", running    ? running->fraction
                         : finished ? 1.0
                                    : 0.0}};
}

json status_json(const drivers::DeviceStatus& status) {
    return {{"state", drivers::to_string(status.state)},
            {"machine_position_mm", status.machine_position_mm},
            {"work_position_mm", status.work_position_mm},
            {"feed_mm_per_min", status.feed_mm_per_min},
            {"power_s", status.power_s},
            {"override_percent", status.override_percent},
            {"alarm_code", status.alarm_code},
            {"message", status.message},
            {"firmware", status.firmware}};
}

json station_json(const DeviceRecord& device) {
    return device.station.empty() ? json() : json(device.station);
}

std::vector<std::string> device_actions(const DeviceRunner& runner) {
    std::vector<std::string> actions{"hold", "resume", "stop", "reset"};
    const bool connected = runner.status().state != drivers::MachineState::Disconnected;
    if (connected && !runner.current_cut()) {
        actions.insert(actions.end(), {"home", "unlock", "jog", "frame", "console"});
    }
    return actions;
}

// The state that the event led to may be past already: clients get what is true now.
void add_subject(App& app, const EventRecord& event, json& data) {
    if (event.type == "job") {
        if (const auto job = app.store().jobs.find(event.subject)) {
            data["job"] = job_json(app, *job);
            return;
        }
    } else if (event.type == "queue") {
        data["queue"] = queue_json(app);
        return;
    } else if (event.type == "node") {
        return;  // GET /fleet has the nodes.
    } else if (event.type == "stock") {
        if (app.store().stock.find(event.subject)) {
            return;  // The note says what happened; GET /stock/{id} what is there.
        }
    } else if (const auto cut = app.store().cuts.find(event.subject)) {
        data["cut"] = cut_json(app, *cut);
        return;
    }
    data["removed"] = event.subject;
}

}  // namespace

bool is_test_card(const JobRecord& job) {
    return job.summary_json && stored_json(*job.summary_json).count("test") != 0;
}

json job_json(App& app, const JobRecord& job) {
    json error;
    if (job.failure) {
        error = {{"kind", job.failure->kind},
                 {"code", job.failure->code},
                 {"detail", job.failure->detail}};
    }
    json sheets = json::array();
    for (const SheetRecord& sheet : job.sheets) {
        sheets.push_back({{"id", sheet.number},
                          {"material", sheet.material},
                          {"state", sheet.cut ? "cut" : "uncut"},
                          {"program_sha256", sheet.program_sha256},
                          {"estimated_s", sheet.estimated_s},
                          {"size_mm", sheet.size_mm},
                          {"stock", sheet.stock.empty() ? json() : json(sheet.stock)}});
    }
    return {
        {"id", job.id},
        {"name", job.name},
        {"state", to_string(job.state)},
        {"created_at", rfc3339(job.created_ms)},
        {"updated_at", rfc3339(job.updated_ms)},
        {"version", job.version},
        {"priority", job.priority},
        {"attempt", job.attempt},
        {"retries", job.retries},
        {"retry_cause", job.retry_cause},
        {"dead_letter", job.failure && job.failure->code == "poison-job"},
        {"file", {{"name", job.file.name}, {"bytes", job.file.bytes}, {"sha256", job.file.sha256}}},
        {"params", stored_json(job.params_json)},
        {"progress", progress_json(app, job)},
        {"error", error},
        {"summary", job.summary_json ? stored_json(*job.summary_json) : json()},
        {"sheets", sheets},
        {"cuts", job.cuts},
        {"recut_of", job.recut_of.empty() ? json() : json(job.recut_of)},
        {"actions", job_actions(job)}};
}

json cut_json(App& app, const CutRecord& cut) {
    CutProgress progress{cut.lines_total, cut.lines_sent, cut.lines_acknowledged};
    if (const auto runner = app.fleet().find(cut.device)) {
        progress = runner->live_progress(cut.id).value_or(progress);
    }
    const auto elsewhere =
        app.fleet().find(cut.device) ? std::nullopt : app.remote().find("cut", cut.id);
    if (elsewhere && !is_final(cut.state)) {
        const json& said = elsewhere->at("progress");
        progress = {said.value("lines_total", progress.lines_total),
                    said.value("lines_sent", progress.lines_sent),
                    said.value("lines_acknowledged", progress.lines_acknowledged),
                    said.value("burnt_mm", 0.0), said.value("burn_mm", 0.0)};
    }
    const double total = static_cast<double>(progress.lines_total);
    const double fraction = cut.state == CutState::Done ? 1.0
                            : total > 0.0 ? static_cast<double>(progress.lines_acknowledged) / total
                                          : 0.0;
    return {{"id", cut.id},
            {"job", cut.job},
            {"device", cut.device},
            {"sheets", cut.sheets},
            {"sheet", cut.sheet()},
            {"state", to_string(cut.state)},
            {"version", cut.version},
            {"program_sha256", cut.program_sha256},
            {"progress",
             {{"lines_total", progress.lines_total},
              {"lines_sent", progress.lines_sent},
              {"lines_acknowledged", progress.lines_acknowledged},
              {"fraction", fraction},
              {"burnt_mm", progress.burnt_mm},
              {"burn_mm", progress.burn_mm}}},
            {"beam", beam_json(cut)},
            {"rest_of", cut.rest_of.empty() ? json() : json(cut.rest_of)},
            {"reason", cut.reason},
            {"created_at", rfc3339(cut.created_ms)},
            {"updated_at", rfc3339(cut.updated_ms)},
            {"steps", cut_steps(app, cut)},
            {"actions", cut_actions(app, cut)}};
}

bool cut_allows(App& app, const CutRecord& cut, const std::string& action) {
    const std::vector<std::string> actions = cut_actions(app, cut);
    return std::find(actions.begin(), actions.end(), action) != actions.end();
}

json device_json(const DeviceRunner& runner) {
    const DeviceRecord& device = runner.record();
    const auto cut = runner.current_cut();
    return {{"id", device.id},
            {"name", device.name},
            {"uri", device.uri},
            {"auto_start", device.auto_start},
            {"bed_mm", device.bed_mm},
            {"station", station_json(device)},
            {"status", status_json(runner.status())},
            {"cut", cut ? json(*cut) : json()},
            {"console", runner.console_lines()},
            {"actions", device_actions(runner)}};
}

// Of a machine on another node: what that says of it, or that it says nothing.
json device_json(App& app, const Machine& machine) {
    if (machine.runner) {
        return device_json(*machine.runner);
    }
    const DeviceRecord& device = machine.record;
    json view{{"id", device.id},         {"name", device.name},
              {"uri", device.uri},       {"auto_start", device.auto_start},
              {"bed_mm", device.bed_mm}, {"station", station_json(device)}};
    const auto elsewhere = app.remote().find("device", device.id);
    drivers::DeviceStatus unknown;
    unknown.message = device.station.empty()
                          ? "no station has this machine"
                          : fmt::format("the station {} is silent", device.station);
    view["status"] = elsewhere ? elsewhere->at("status") : status_json(unknown);
    view["cut"] = elsewhere ? elsewhere->at("cut") : json();
    view["console"] = elsewhere ? elsewhere->at("console") : json::array();
    view["actions"] = elsewhere ? elsewhere->at("actions") : json::array();
    return view;
}

std::optional<std::string> passing_view(App& app, const std::string& type, const std::string& id) {
    if (type == "job") {
        const auto running = app.compute().progress(id);
        return running ? std::optional(dump_json(
                             {{"progress",
                               {{"stage", running->stage}, {"fraction", running->fraction}}}}))
                       : std::nullopt;
    }
    if (type == "cut") {
        const auto cut = app.store().cuts.find(id);
        return cut ? std::optional(dump_json({{"progress", cut_json(app, *cut).at("progress")}}))
                   : std::nullopt;
    }
    const auto runner = app.fleet().find(id);
    if (!runner) {
        return std::nullopt;
    }
    json view = device_json(*runner);
    view["ready"] = runner->is_ready();
    view["framed"] = runner->framed();
    view["connected"] = runner->status().state != drivers::MachineState::Disconnected;
    json& console = view["console"];
    constexpr std::size_t kFewLines = 20;
    if (console.size() > kFewLines) {
        console.erase(console.begin(),
                      console.end() - static_cast<json::difference_type>(kFewLines));
    }
    return dump_json(view);
}

std::vector<StoredEvent> stored_events(App& app, std::int64_t after, int limit) {
    std::vector<StoredEvent> events;
    for (const EventRecord& event : app.store().events.after(after, limit)) {
        json data = {{"seq", event.seq},
                     {"type", event.type},
                     {"id", event.subject},
                     {"at", rfc3339(event.at_ms)},
                     {"note", event.note}};
        add_subject(app, event, data);
        events.push_back({event.seq, event.type, event.job, dump_json(data)});
    }
    return events;
}

std::optional<PassingEvent> passing_event(App& app,
                                          const std::string& type,
                                          const std::string& id) {
    json data = {{"type", type}, {"id", id}};
    std::string of_job;
    if (type == "job") {
        const auto job = app.store().jobs.find(id);
        if (!job) {
            return std::nullopt;
        }
        of_job = id;
        data["job"] = job_json(app, *job);
    } else if (type == "cut") {
        const auto cut = app.store().cuts.find(id);
        if (!cut) {
            return std::nullopt;
        }
        of_job = cut->job;
        data["cut"] = cut_json(app, *cut);
    } else {
        const auto machine = find_machine(app, id);
        if (!machine) {
            return std::nullopt;
        }
        data["device"] = device_json(app, *machine);
    }
    return PassingEvent{of_job, dump_json(data)};
}

std::string snapshot_event(App& app, std::int64_t seq, const std::optional<std::string>& job) {
    constexpr int kMostJobs = 200;
    json data = {{"seq", seq},
                 {"type", "snapshot"},
                 {"jobs", json::array()},
                 {"cuts", json::array()},
                 {"devices", json::array()},
                 {"queue", queue_json(app)}};
    JobQuery newest;
    newest.limit = kMostJobs;
    for (const JobRecord& each : app.store().jobs.list(newest)) {
        if (!job || each.id == *job) {
            data["jobs"].push_back(job_json(app, each));
        }
    }
    for (const CutRecord& cut : app.store().cuts.list(kMostJobs)) {
        if (!job || cut.job == *job) {
            data["cuts"].push_back(cut_json(app, cut));
        }
    }
    for (const Machine& machine : all_machines(app)) {
        data["devices"].push_back(device_json(app, machine));
    }
    return dump_json(data);
}

}  // namespace leafcutter::server
