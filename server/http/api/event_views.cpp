// What event streams tell, see views.h.

#include <nlohmann/json.hpp>

#include "server/app.h"
#include "server/http/api/lookup.h"
#include "server/http/api/views.h"
#include "server/http/json_body.h"
#include "server/store/ids.h"

namespace leafcutter::server {

namespace {

using nlohmann::json;

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
