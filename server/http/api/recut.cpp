// Single pieces of a finished job again: a new job.

#include <algorithm>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "server/app.h"
#include "server/http/api/handlers.h"
#include "server/http/api/job_intake.h"
#include "server/http/api/lookup.h"
#include "server/http/json_body.h"
#include "server/http/problem.h"

namespace leafcutter::server {

namespace {

using nlohmann::json;

// "eight.off: W12.1, W13 …"
std::string name_of(const JobRecord& job, const json& body) {
    constexpr std::size_t kMostNamed = 3;
    std::string name;
    if (const auto given = body.find("name"); given != body.end()) {
        if (!given->is_string()) {
            throw HttpProblem(422, "bad-field", "name: must be a string");
        }
        name = given->get<std::string>();
    }
    const auto pieces = body.find("pieces");
    if (name.empty() && pieces != body.end() && pieces->is_array()) {
        name = job.name + ":";
        for (std::size_t i = 0; i < std::min(kMostNamed, pieces->size()); ++i) {
            const json& piece = (*pieces)[i];
            name += fmt::format(" {}", piece.is_string() ? piece.get<std::string>() : "?");
        }
        name += pieces->size() > kMostNamed ? " …" : "";
    }
    return name;
}

std::string artifact_text(App& app, const std::string& job, const std::string& path) {
    const auto artifact = app.store().jobs.artifact(job, path);
    if (!artifact) {
        throw HttpProblem(409, "no-package", fmt::format("the job has no {}", path));
    }
    return app.store().blobs.read(artifact->sha256);
}

}  // namespace

Response recut_job(App& app, Request& request) {
    const JobRecord job = find_job(app, request);
    if (job.state != JobState::Ready && job.state != JobState::Done) {
        throw HttpProblem(409, "not-ready", fmt::format("the job is {}", to_string(job.state)));
    }
    const json body = read_json_object(request);
    RecutCall call;
    call.job_name = job.name;
    call.wishes_json = dump_json(body);
    call.material_records = texts_of(app.store().materials.list());
    call.read = [&app, &job](const std::string& path) { return artifact_text(app, job.id, path); };
    app.parts().check_recut(call);
    return take_checked_job(
        app, request,
        {name_of(job, body), job.file, job.params_json, job.id, std::move(call.wishes_json)});
}

}  // namespace leafcutter::server
