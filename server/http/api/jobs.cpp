// Jobs and the meshes they are made of.

#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "geometry/io/read_mesh.h"
#include "server/app.h"
#include "server/http/api/handlers.h"
#include "server/http/api/job_intake.h"
#include "server/http/api/lookup.h"
#include "server/http/api/views.h"
#include "server/http/json_body.h"
#include "server/http/multipart.h"
#include "server/http/problem.h"
#include "server/stock_choice.h"

namespace leafcutter::server {

namespace {

using nlohmann::json;

constexpr std::size_t kLongestName = 200;

NewJob job_from_form(App& app, const Request& request) {
    check_room(app, request.body.bytes);
    NewJob job;
    job.params_json = "{}";
    MultipartReader parts(*request.header("content-type"), request.body);
    while (const auto part = parts.next()) {
        if (part->name == "mesh") {
            job.file = store_mesh(app, parts, *part);
        } else if (part->name == "params") {
            job.params_json = parts.read_all(kMostJsonBytes);
        } else if (part->name == "name") {
            job.name = parts.read_all(4 * kLongestName);
        } else {
            throw HttpProblem(400, "bad-multipart", "there is no field \"" + part->name + "\"");
        }
    }
    if (job.file.sha256.empty()) {
        throw HttpProblem(400, "no-mesh", "the form has no file in the field \"mesh\"");
    }
    return job;
}

NewJob job_from_json(App& app, const Request& request) {
    const json body = read_json_object(request);
    NewJob job;
    job.file.sha256 = text_field_or(body, "blob", "");
    const auto bytes =
        is_sha256(job.file.sha256) ? app.store().blobs.size(job.file.sha256) : std::nullopt;
    if (!bytes) {
        throw HttpProblem(422, "no-blob",
                          "blob: there is none of that name; PUT it to /blobs first");
    }
    job.file.bytes = *bytes;
    job.name = text_field_or(body, "name", "");
    job.file.name = text_field_or(body, "file_name", "");
    job.params_json = dump_json(body.value("params", json::object()));
    return job;
}

// Parameters are refused before any work starts; what is kept is what was given.
void check_params(App& app, NewJob& job) {
    const json params = parse_json(job.params_json);
    job.params_json = dump_json(params);
    app.parts().check_params(names_stock(params)
                                 ? dump_json(with_stock(params, app.store().stock.list()))
                                 : job.params_json);
}

std::optional<IdempotencyKey> key_of(const Request& request, const NewJob& job) {
    const auto key = request.header("idempotency-key");
    if (!key) {
        return std::nullopt;
    }
    std::string whole = fmt::format("{}\n{}\n{}", job.file.sha256, job.name, job.params_json);
    if (!job.recut_of.empty()) {
        whole += fmt::format("\n{}\n{}", job.recut_of, job.recut_json);
    }
    return IdempotencyKey{fmt::format("{}/{}", request.caller.name, *key), sha256_of(whole)};
}

// With an ending that readers know, where a client gave none.
std::string mesh_file_name(App& app, const NewJob& job) {
    const std::string& name = job.file.name.empty() ? job.name : job.file.name;
    if (geometry::is_mesh_name(name)) {
        return name;
    }
    return geometry::mesh_file_name(name.empty() ? "mesh" : name,
                                    app.store().blobs.map(job.file.sha256)->bytes());
}

AddedJob add_job(App& app, const Request& request, NewJob job) {
    job.name = job.name.empty() ? job.file.name : job.name;
    job.name.resize(std::min(job.name.size(), kLongestName));
    app.store().blobs.share(job.file.sha256);  // An accepted job outlives this host.
    const AddedJob added = app.store().jobs.add(job, key_of(request, job));
    if (!added.replayed) {
        app.compute().wake();
    }
    return added;
}

Response created(App& app, const JobRecord& job) {
    Response response = json_response(job_json(app, job), 201);
    response.headers["Location"] = "/api/v1/jobs/" + job.id;
    return response;
}

Response accept(App& app, const Request& request, NewJob job) {
    return created(app, take_job(app, request, std::move(job)).job);
}

}  // namespace

void check_room(App& app, std::int64_t bytes) {
    if (!app.store().blobs.has_room_for(bytes)) {
        throw HttpProblem(507, "disk", "there is no room for this file");
    }
}

SourceFile store_mesh(App& app, MultipartReader& parts, const PartHead& head) {
    const std::unique_ptr<BlobWriter> writer = app.store().blobs.begin();
    std::array<char, 65536> piece;
    while (const std::size_t size = parts.read(piece)) {
        writer->write({piece.data(), size});
    }
    const BlobId blob = writer->finish();
    return {head.file_name, blob.bytes, blob.sha256};
}

AddedJob take_job(App& app, const Request& request, NewJob job) {
    job.file.name = mesh_file_name(app, job);
    check_params(app, job);
    return add_job(app, request, std::move(job));
}

Response take_checked_job(App& app, const Request& request, NewJob job) {
    return created(app, add_job(app, request, std::move(job)).job);
}

Response take_ready_job(App& app, NewJob job, const ComputeOutput& output) {
    std::int64_t bytes = 0;
    for (const fab::PackageFile& file : output.package.files) {
        bytes += static_cast<std::int64_t>(file.bytes.size());
    }
    check_room(app, bytes);
    job.name.resize(std::min(job.name.size(), kLongestName));
    return created(app, app.store().jobs.add_ready(job, stored_result(app.store().blobs, output)));
}

Response create_job(App& app, Request& request) {
    const std::string type = request.header("content-type").value_or("");
    const bool is_form = type.starts_with("multipart/form-data");
    return accept(app, request,
                  is_form ? job_from_form(app, request) : job_from_json(app, request));
}

Response list_jobs(App& app, Request& request) {
    JobQuery query;
    const Page page = page_in(request);
    query.limit = page.limit;
    query.below_ordinal = page.cursor;
    if (const auto state = request.query.find("state"); state != request.query.end()) {
        query.state = job_state_named(state->second);
        if (!query.state) {
            throw HttpProblem(400, "bad-query", "state: there is no such state");
        }
    }
    query.dead_letters = request.query.count("dead_letters") != 0;
    json jobs = json::array();
    const std::vector<JobRecord> records = app.store().jobs.list(query);
    for (const JobRecord& job : records) {
        jobs.push_back(job_json(app, job));
    }
    const bool full = static_cast<int>(records.size()) == query.limit;
    const json cursor = full ? json(std::to_string(records.back().ordinal)) : json();
    return json_response({{"jobs", jobs}, {"next_cursor", cursor}});
}

Response show_job(App& app, Request& request) {
    return json_response(job_json(app, find_job(app, request)));
}

Response delete_job(App& app, Request& request) {
    const JobRecord job = find_job(app, request);
    if (app.store().jobs.cancel(job.id)) {
        app.compute().stop_job(job.id);
        return json_response(job_json(app, find_job(app, request)));
    }
    if (app.store().jobs.remove(job.id) == Removal::StillInUse) {
        throw HttpProblem(409, "in-use", "the job has a cut under way: abort it first");
    }
    Response gone;
    gone.status = 204;
    return gone;
}

Response recompute_job(App& app, Request& request) {
    const JobRecord old = find_job(app, request);
    if (is_test_card(old)) {
        throw HttpProblem(409, "no-mesh", "a test card has no mesh: make a new one");
    }
    const json body = read_json_object(request);
    const auto params = body.find("params");
    NewJob job;
    job.file = old.file;
    job.name = text_field_or(body, "name", old.name);
    job.params_json = params == body.end() ? old.params_json : dump_json(*params);
    return accept(app, request, std::move(job));
}

Response show_blob(App& app, Request& request) {
    const std::string& wanted = request.capture("sha256");
    const Blobs& blobs = app.store().blobs;
    if (!is_sha256(wanted) || !blobs.is_here(wanted)) {  // Asking others is the asker's business.
        throw HttpProblem(404, "no-blob", "there is no blob of that name here");
    }
    Response response;
    response.content_type = "application/octet-stream";
    auto file = std::make_shared<FileHandle>(blobs.open(wanted));
    response.file = FilePart{std::move(file), 0, blobs.size(wanted).value_or(0)};
    return response;
}

Response put_blob(App& app, Request& request) {
    const std::string& wanted = request.capture("sha256");
    if (!is_sha256(wanted)) {
        throw HttpProblem(422, "bad-digest", "the name must be a SHA-256 in lower-case hex");
    }
    Response response;
    std::array<char, 65536> piece;
    if (app.store().blobs.is_here(wanted)) {
        while (request.body.read(piece) > 0) {  // Known already; the bytes have to go somewhere.
        }
        response.status = 204;
        return response;
    }
    check_room(app, request.body.bytes);
    const std::unique_ptr<BlobWriter> writer = app.store().blobs.begin();
    while (const std::size_t size = request.body.read(piece)) {
        writer->write({piece.data(), size});
    }
    if (writer->digest().sha256 != wanted) {
        throw HttpProblem(422, "bad-digest", "the bytes have another SHA-256 than the name says");
    }
    writer->finish();
    response.status = 201;
    return response;
}

}  // namespace leafcutter::server
