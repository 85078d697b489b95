// As much of OctoPrint's API as tools need to send a file: they know it, they don't know us.

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "geometry/io/read_mesh.h"
#include "server/app.h"
#include "server/http/api/handlers.h"
#include "server/http/api/job_intake.h"
#include "server/http/api/lookup.h"
#include "server/http/json_body.h"
#include "server/http/problem.h"

namespace leafcutter::server {

namespace {

using nlohmann::json;

NewJob job_in_form(App& app, const Request& request) {
    check_room(app, request.body.bytes);
    NewJob job;
    job.params_json = "{}";
    MultipartReader parts(request.header("content-type").value_or(""), request.body);
    while (const auto part = parts.next()) {
        if (part->name != "file" || part->file_name.empty()) {
            continue;  // print, select, path, userdata: nothing here starts a machine.
        }
        if (!geometry::is_mesh_name(part->file_name)) {
            throw HttpProblem(415, "not-a-mesh",
                              "send an STL, OBJ, OFF or PLY mesh: programs come out of here, they "
                              "don't go in");
        }
        job.file = store_mesh(app, parts, *part);
    }
    if (job.file.sha256.empty()) {
        throw HttpProblem(400, "no-mesh", "the form has no file in the field \"file\"");
    }
    return job;
}

}  // namespace

Response octoprint_version(App&, Request&) {
    return json_response(
        {{"api", "0.1"},
         {"server", "1.9.0"},
         {"text", fmt::format("OctoPrint API of Leafcutter {}", LEAFCUTTER_VERSION)}});
}

Response octoprint_upload(App& app, Request& request) {
    const AddedJob added = take_job(app, request, job_in_form(app, request));
    const std::string host = request.header("host").value_or("localhost");
    const std::string place = fmt::format("{}://{}/api/v1/jobs/{}",
                                          request.is_secure ? "https" : "http", host, added.job.id);
    const json file = {{"name", added.job.file.name},
                       {"path", added.job.file.name},
                       {"type", "model"},
                       {"origin", "local"},
                       {"refs", {{"resource", place}}}};
    Response response = json_response({{"files", {{"local", file}}},
                                       {"done", true},
                                       {"effectiveSelect", false},
                                       {"effectivePrint", false}},
                                      201);
    response.headers["Location"] = place;
    return response;
}

}  // namespace leafcutter::server
