// leafcutter submit: a job through the daemon.

#include <cstdio>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "server/cli/api_client.h"
#include "server/cli/command.h"
#include "server/cli/follow.h"
#include "server/cli/input_file.h"
#include "server/cli/param_options.h"
#include "server/store/blobs.h"
#include "server/store/ids.h"

namespace leafcutter::server {

namespace {

using nlohmann::json;

struct SubmitOptions {
    std::string model;
    ApiOptions api;
    std::string params_file;
    std::vector<std::string> assignments;
    std::string name;
    int priority = 0;
    bool wait = false;
};

json create_job(ApiClient& client, const SubmitOptions& options) {
    constexpr std::size_t kMostBytes = 256ULL << 20;
    const json params = wanted_params(options.params_file, options.assignments);
    const std::vector<std::byte> bytes = read_input_file(options.model, kMostBytes);
    const auto* text = reinterpret_cast<const char*>(bytes.data());
    const std::string sha256 = sha256_of({text, bytes.size()});
    client.put_bytes("/blobs/" + sha256, text, bytes.size());
    const std::string file_name = std::filesystem::path(options.model).filename().string();
    const json job = {{"blob", sha256},
                      {"file_name", file_name},
                      {"name", options.name.empty() ? file_name : options.name},
                      {"params", params}};
    return client.post("/jobs", job, new_id("submit_"));
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
    ApiClient client(options.api);
    json job = create_job(client, options);
    if (options.priority != 0) {
        job = client.patch("/jobs/" + job.at("id").get<std::string>(),
                           {{"priority", options.priority}});
    }
    if (options.wait) {
        job = follow_job(client, job.at("id").get<std::string>(), common);
        check_outcome(job);
    }
    if (common.json) {
        print_json(job);
        return;
    }
    std::printf("%s %s %s/api/v1/jobs/%s\n", job.at("id").get<std::string>().c_str(),
                job.at("state").get<std::string>().c_str(), client.url().c_str(),
                job.at("id").get<std::string>().c_str());
}

}  // namespace

void add_submit_command(CLI::App& app, const CommonOptions& common) {
    CLI::App* command = app.add_subcommand("submit", "A job through the daemon");
    const auto options = std::make_shared<SubmitOptions>();  // Shared with the callback.
    command->add_option("model", options->model, "Mesh: STL, OBJ, OFF or PLY")->required();
    add_api_options(*command, options->api);
    command->add_option("--priority", options->priority, "-1000 to 1000; the highest goes first");
    command->add_option("--params", options->params_file, "Job parameters, a JSON file");
    command->add_option("--set", options->assignments, "One parameter: grid.strip_width_mm=6");
    command->add_option("--name", options->name, "The job's name; the file's if not given");
    command->add_flag("--wait", options->wait, "Wait until it is computed");
    command->callback([options, &common] { submit(*options, common); });
}

}  // namespace leafcutter::server
