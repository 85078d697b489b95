// leafcutter jobs: the daemon's jobs and their queue.

#include <cstdio>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "server/cli/api_client.h"
#include "server/cli/command.h"
#include "server/cli/follow.h"
#include "server/cli/param_options.h"
#include "server/cli/progress_line.h"

namespace leafcutter::server {

namespace {

using nlohmann::json;

struct JobsOptions {
    ApiOptions api;
    std::string job;
    std::string state;
    std::string text;  // A cause, a reason, or a file.
    std::vector<std::string> pieces;
    std::string params_file;
    std::vector<std::string> assignments;
    bool wait = false;
    int number = 0;
    int limit = 50;
    bool dead_letters = false;
};

std::string text_at(const json& value, const char* key) {
    const auto found = value.find(key);
    return found != value.end() && found->is_string() ? found->get<std::string>() : "";
}

void print_job(const json& job) {
    const json& progress = job.at("progress");
    const bool works = job.at("state") == "computing";
    const std::string percent =
        works ? fmt::format("{:3.0f} %", 100.0 * progress.at("fraction").get<double>()) : "";
    std::printf("%-28s %-10s %-6s %4d  %s\n", text_at(job, "id").c_str(),
                text_at(job, "state").c_str(), percent.c_str(), job.value("priority", 0),
                text_at(job, "name").c_str());
    if (job.at("error").is_object()) {
        std::printf("    %s\n", text_at(job.at("error"), "detail").c_str());
    }
}

void show(const json& answer, const CommonOptions& common) {
    if (common.json) {
        print_json(answer);
    } else if (answer.is_object() && answer.count("jobs") != 0) {
        for (const json& job : answer.at("jobs")) {
            print_job(job);
        }
    } else if (answer.is_object() && answer.count("state") != 0) {
        print_job(answer);
    }
}

void list_jobs_of(const JobsOptions& options, const CommonOptions& common) {
    ApiClient client(options.api);
    if (!options.job.empty()) {
        show(client.get("/jobs/" + options.job), common);
        return;
    }
    std::string query = fmt::format("/jobs?limit={}", options.limit);
    if (!options.state.empty()) {
        query += "&state=" + options.state;
    }
    if (options.dead_letters) {
        query += "&dead_letters=true";
    }
    show(client.get(query), common);
}

void show_queue(const JobsOptions& options, const CommonOptions& common) {
    const json queue = ApiClient(options.api).get("/queue");
    if (common.json) {
        print_json(queue);
        return;
    }
    std::printf("%s%s; %d queued, %d computing, %d dead letters\n",
                queue.at("paused").get<bool>() ? "paused " : "open",
                text_at(queue, "reason").c_str(), queue.at("queued").get<int>(),
                queue.at("computing").get<int>(), queue.at("dead_letters").get<int>());
    int place = 0;
    for (const json& job : queue.at("next")) {
        std::printf("%4d  %-28s %4d  %s\n", ++place, text_at(job, "id").c_str(),
                    job.at("priority").get<int>(), text_at(job, "name").c_str());
    }
}

using Options = std::shared_ptr<JobsOptions>;

// A subcommand for one job: `act` takes a client and the job's path.
template <typename Act>
CLI::App* add_verb(CLI::App& jobs,
                   const Options& options,
                   const CommonOptions& common,
                   std::pair<const char*, const char*> words,
                   Act act) {
    CLI::App* verb = jobs.add_subcommand(words.first, words.second);
    verb->add_option("job", options->job, "A job's id")->required();
    verb->callback([options, &common, act] {
        ApiClient client(options->api);
        show(act(client, "/jobs/" + options->job), common);
    });
    return verb;
}

void add_job_verbs(CLI::App& jobs, const Options& options, const CommonOptions& common) {
    add_verb(jobs, options, common, {"cancel", "End one that waits or is computed"},
             [](ApiClient& client, const std::string& path) { return client.remove(path); });
    add_verb(jobs, options, common, {"remove", "Forget one that is over"},
             [](ApiClient& client, const std::string& path) { return client.remove(path); });
    add_verb(jobs, options, common, {"retry", "Try a failed or cancelled one again"},
             [options](ApiClient& client, const std::string& path) {
                 return client.post(path + "/retry", {{"cause", options->text}});
             })
        ->add_option("--cause", options->text, "What has changed since");
    add_verb(jobs, options, common, {"priority", "Set one's priority, the highest goes first"},
             [options](ApiClient& client, const std::string& path) {
                 return client.patch(path, {{"priority", options->number}});
             })
        ->add_option("priority", options->number, "-1000 to 1000")
        ->required();
    add_verb(jobs, options, common, {"move", "Put one to a place of the queue"},
             [options](ApiClient& client, const std::string& path) {
                 return client.patch(path, {{"position", options->number}});
             })
        ->add_option("position", options->number, "1: next")
        ->required();
}

// A new job made of one that is there.
template <typename Body>
CLI::App* add_maker(CLI::App& jobs,
                    const Options& options,
                    const CommonOptions& common,
                    std::pair<const char*, const char*> words,
                    Body body) {
    const std::string call = fmt::format("/{}", words.first);
    CLI::App* verb = add_verb(
        jobs, options, common, words,
        [options, &common, call, body](ApiClient& client, const std::string& path) {
            const json made = client.post(path + call, body());
            return options->wait ? follow_job(client, made.at("id").get<std::string>(), common)
                                 : made;
        });
    verb->add_flag("--wait", options->wait, "Until it is computed");
    return verb;
}

void add_makers(CLI::App& jobs, const Options& options, const CommonOptions& common) {
    add_maker(jobs, options, common, {"recut", "Single pieces of one again, as a new job"},
              [options] {
                  return json{{"pieces", options->pieces}};
              })
        ->add_option("pieces", options->pieces, "W12.1, a whole strip W12, sheet:3, or all")
        ->required();
    CLI::App* recompute = add_maker(
        jobs, options, common, {"recompute", "The same mesh again, as a new job"}, [options] {
            return json{{"params", wanted_params(options->params_file, options->assignments)}};
        });
    recompute->add_option("--params", options->params_file, "Job parameters, a JSON file");
    recompute->add_option("--set", options->assignments, "One parameter: grid.strip_width_mm=6");
    CLI::App* download = add_verb(
        jobs, options, common, {"download", "Save one's package"},
        [options, &common](ApiClient& client, const std::string& path) {
            const std::string file = options->text.empty() ? options->job + ".zip" : options->text;
            ProgressLine line(common);
            client.save(path + "/package.zip", file,
                        [&line](double fraction) { line.show("download", fraction); });
            return json{{"file", file}};
        });
    download->add_option("-o,--output", options->text, "JOB.zip if not given");
}

void add_queue_verbs(CLI::App& jobs, const Options& options, const CommonOptions& common) {
    CLI::App* queue = jobs.add_subcommand("queue", "Who is next");
    queue->callback([options, &common] { show_queue(*options, common); });
    CLI::App* pause = jobs.add_subcommand("pause", "Let no job begin");
    pause->add_option("--reason", options->text, "For the others");
    pause->callback([options, &common] {
        ApiClient(options->api).post("/queue/pause", {{"reason", options->text}});
        show_queue(*options, common);
    });
    CLI::App* resume = jobs.add_subcommand("resume", "Let jobs begin again");
    resume->callback([options, &common] {
        ApiClient(options->api).post("/queue/resume", json::object());
        show_queue(*options, common);
    });
    CLI::App* wait = jobs.add_subcommand("wait", "Follow one until it is computed");
    wait->add_option("job", options->job, "A job's id")->required();
    wait->callback([options, &common] {
        ApiClient client(options->api);
        show(follow_job(client, options->job, common), common);
    });
}

}  // namespace

void add_jobs_command(CLI::App& app, const CommonOptions& common) {
    CLI::App* jobs = app.add_subcommand("jobs", "The daemon's jobs and their queue");
    const auto options = std::make_shared<JobsOptions>();  // Shared with the callbacks.
    add_api_options(*jobs, options->api);
    jobs->fallthrough();
    jobs->require_subcommand(0, 1);
    jobs->add_option("--state", options->state, "Only jobs in this state");
    jobs->add_option("--limit", options->limit, "At most so many")->capture_default_str();
    jobs->add_flag("--dead-letters", options->dead_letters, "Only those that gave up");
    add_job_verbs(*jobs, options, common);
    add_makers(*jobs, options, common);
    add_queue_verbs(*jobs, options, common);
    CLI::App* show_one = jobs->add_subcommand("show", "One of them");
    show_one->add_option("job", options->job, "A job's id")->required();
    jobs->callback([jobs, options, &common] {
        if (jobs->get_subcommands().empty() ||
            jobs->get_subcommands().front()->get_name() == "show") {
            list_jobs_of(*options, common);
        }
    });
}

}  // namespace leafcutter::server
