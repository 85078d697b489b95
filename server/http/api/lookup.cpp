#include "server/http/api/lookup.h"

#include <nlohmann/json.hpp>

#include "server/app.h"
#include "server/http/json_body.h"
#include "server/http/problem.h"

namespace leafcutter::server {

Response json_response(const nlohmann::json& value, int status) {
    Response response;
    response.status = status;
    response.body = dump_json(value);
    return response;
}

JobRecord find_job(App& app, const Request& request) {
    auto job = app.store().jobs.find(request.capture("id"));
    if (!job) {
        throw HttpProblem(404, "no-such-job", "there is no job of that id");
    }
    return *std::move(job);
}

CutRecord find_cut(App& app, const Request& request) {
    auto cut = app.store().cuts.find(request.capture("id"));
    if (!cut) {
        throw HttpProblem(404, "no-such-cut", "there is no cut of that id");
    }
    return *std::move(cut);
}

}  // namespace leafcutter::server
