// leafcutter submit: a job through the daemon.

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <httplib.h>
#include <nlohmann/json.hpp>

#include "geometry/error.h"
#include "server/cli/command.h"
#include "server/cli/input_file.h"
#include "server/cli/interrupt.h"
#include "server/cli/param_options.h"
#include "server/cli/progress_line.h"
#include "server/store/blobs.h"
#include "server/store/ids.h"

namespace leafcutter::server {

namespace {

using nlohmann::json;

struct SubmitOptions {
    std::string model;
    std::string url = "http://127.0.0.1:8080";
    std::string params_file;
    std::vector<std::string> assignments;
    std::string name;
    bool wait = false;
};

// The answer's body, or what went wrong as an exception with the exit status it deserves.
json answer_of(const httplib::Result& result, const std::string& url) {
    if (!result) {
        throw std::runtime_error(fmt::format("{}: no answer ({}): is the daemon running?", url,
                                             httplib::to_string(result.error())));
    }
    json body = json::parse(result->body, nullptr, /*allow_exceptions=*/false);
    if (result->status < 300) {
        return body;
    }
    const std::string detail =
        body.is_object() ? body.value("detail", "") : fmt::format("status {}", result->status);
    if (result->status == 422 || result->status == 413) {
        throw UsageError(detail);
    }
    throw std::runtime_error(fmt::format("{}: {}", url, detail));
}

json create_job(httplib::Client& client, const SubmitOptions& options) {
    constexpr std::size_t kMostBytes = 256ULL << 20;
    const json params = wanted_params(options.params_file, options.assignments);
    const std::vector<std::byte> bytes = read_input_file(options.model, kMostBytes);
    const auto* text = reinterpret_cast<const char*>(bytes.data());
    const std::string sha256 = sha256_of({text, bytes.size()});
    answer_of(client.Put("/api/v1/blobs/" + sha256, text, bytes.size(), "application/octet-stream"),
              options.url);
    const std::string file_name = std::filesystem::path(options.model).filename().string();
    const json job = {{"blob", sha256},
                      {"file_name", file_name},
                      {"name", options.name.empty() ? file_name : options.name},
                      {"params", params}};
    const httplib::Headers headers{{"Idempotency-Key", new_id("submit_")}};
    return answer_of(
        client.Post("/api/v1/jobs", headers,
                    job.dump(-1, ' ', false, json::error_handler_t::replace), "application/json"),
        options.url);
}

json wait_for_job(httplib::Client& client,
                  json job,
                  const SubmitOptions& options,
                  ProgressLine& line) {
    constexpr auto kBetweenLooks = std::chrono::milliseconds(200);
    const InterruptWatch interrupt;
    const std::string path = "/api/v1/jobs/" + job.at("id").get<std::string>();
    while (job.at("state") == "queued" || job.at("state") == "computing") {
        const json& progress = job.at("progress");
        line.show(progress.at("stage").get<std::string>(), progress.at("fraction").get<double>());
        std::this_thread::sleep_for(kBetweenLooks);
        if (interrupt.token().stop_requested()) {
            throw geometry::Cancelled();  // The job itself goes on.
        }
        job = answer_of(client.Get(path), options.url);
    }
    line.clear();
    return job;
}

void check_outcome(const json& job) {
    if (job.at("state") == "cancelled") {
        throw std::runtime_error("the job was cancelled");
    }
    if (job.at("state") == "failed") {
        const std::string kind = job.at("error").at("kind").get<std::string>();
        const std::string detail = job.at("error").at("detail").get<std::string>();
        if (kind.starts_with("bad-") || kind == "not-supported") {
            throw UsageError(detail);
        }
        throw std::runtime_error(detail);
    }
}

void submit(const SubmitOptions& options, const CommonOptions& common) {
    httplib::Client client(options.url);
    if (!client.is_valid()) {
        throw UsageError(options.url + ": is no URL of a daemon; write http://127.0.0.1:8080");
    }
    client.set_read_timeout(std::chrono::seconds(60));
    json job = create_job(client, options);
    if (options.wait) {
        ProgressLine line(common);
        job = wait_for_job(client, std::move(job), options, line);
        check_outcome(job);
    }
    if (common.json) {
        std::printf("%s\n", job.dump(-1, ' ', false, json::error_handler_t::replace).c_str());
        return;
    }
    std::printf("%s %s %s/api/v1/jobs/%s\n", job.at("id").get<std::string>().c_str(),
                job.at("state").get<std::string>().c_str(), options.url.c_str(),
                job.at("id").get<std::string>().c_str());
}

}  // namespace

void add_submit_command(CLI::App& app, const CommonOptions& common) {
    CLI::App* command = app.add_subcommand("submit", "A job through the daemon");
    const auto options = std::make_shared<SubmitOptions>();  // Shared with the callback.
    command->add_option("model", options->model, "Mesh: STL, OBJ, OFF or PLY")->required();
    command->add_option("--url", options->url, "Where the daemon answers")->capture_default_str();
    command->add_option("--params", options->params_file, "Job parameters, a JSON file");
    command->add_option("--set", options->assignments, "One parameter: grid.strip_width_mm=6");
    command->add_option("--name", options->name, "The job's name; the file's if not given");
    command->add_flag("--wait", options->wait, "Wait until it is computed");
    command->callback([options, &common] { submit(*options, common); });
}

}  // namespace leafcutter::server
