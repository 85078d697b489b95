#include "server/http/api/lookup.h"

#include <algorithm>
#include <charconv>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "server/app.h"
#include "server/http/json_body.h"
#include "server/http/problem.h"

namespace leafcutter::server {

namespace {

std::optional<std::int64_t> query_number(const Request& request, const char* name) {
    const auto found = request.query.find(name);
    if (found == request.query.end()) {
        return std::nullopt;
    }
    std::int64_t number = 0;
    const char* end = found->second.data() + found->second.size();
    const auto parsed = std::from_chars(found->second.data(), end, number);
    if (parsed.ec != std::errc() || parsed.ptr != end || number < 0) {
        throw HttpProblem(400, "bad-query", fmt::format("{}: must be a whole number", name));
    }
    return number;
}

}  // namespace

Response json_response(const nlohmann::json& value, int status) {
    Response response;
    response.status = status;
    response.body = dump_json(value);
    return response;
}

int limit_in(const Request& request) {
    constexpr std::int64_t kMost = 200;
    const std::int64_t limit = query_number(request, "limit").value_or(Page{}.limit);
    return static_cast<int>(std::clamp<std::int64_t>(limit, 1, kMost));
}

Page page_in(const Request& request) {
    return {limit_in(request), query_number(request, "cursor")};
}

JobRecord find_job(App& app, const Request& request) {
    auto job = app.store().jobs.find(request.capture("id"));
    if (!job) {
        throw HttpProblem(404, "no-such-job", "there is no job of that id");
    }
    return *std::move(job);
}

namespace {

Machine machine_here(std::shared_ptr<DeviceRunner> runner) {
    const bool connected = runner->status().state != drivers::MachineState::Disconnected;
    return {runner->record(), std::move(runner), connected};
}

Machine machine_elsewhere(App& app, DeviceRecord record) {
    const auto view = app.remote().find("device", record.id);
    return {std::move(record), nullptr, view && view->value("connected", false)};
}

}  // namespace

std::optional<Machine> find_machine(App& app, const std::string& id) {
    if (auto runner = app.fleet().find(id)) {
        return machine_here(std::move(runner));
    }
    auto record = app.self() == nullptr ? std::nullopt : app.store().devices.find(id);
    return record ? std::optional(machine_elsewhere(app, *std::move(record))) : std::nullopt;
}

std::vector<Machine> all_machines(App& app) {
    std::vector<Machine> machines;
    if (app.self() == nullptr) {
        for (auto& runner : app.fleet().all()) {
            machines.push_back(machine_here(std::move(runner)));
        }
        return machines;
    }
    for (DeviceRecord& record : app.store().devices.list()) {
        auto runner = app.fleet().find(record.id);
        machines.push_back(runner ? machine_here(std::move(runner))
                                  : machine_elsewhere(app, std::move(record)));
    }
    return machines;
}

CutRecord find_cut(App& app, const Request& request) {
    auto cut = app.store().cuts.find(request.capture("id"));
    if (!cut) {
        throw HttpProblem(404, "no-such-cut", "there is no cut of that id");
    }
    return *std::move(cut);
}

}  // namespace leafcutter::server
