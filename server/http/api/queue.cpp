// The queue of jobs: who is next, pause, order, another try.

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "server/app.h"
#include "server/http/api/handlers.h"
#include "server/http/api/lookup.h"
#include "server/http/api/views.h"
#include "server/http/json_body.h"
#include "server/http/problem.h"

namespace leafcutter::server {

namespace {

using nlohmann::json;

constexpr std::size_t kLongestText = 1000;

std::string text_in(const json& body, const char* key) {
    const auto found = body.find(key);
    if (found == body.end() || found->is_null()) {
        return {};
    }
    if (!found->is_string() || found->get_ref<const std::string&>().size() > kLongestText) {
        throw HttpProblem(422, "bad-field",
                          fmt::format("{}: must be a text of up to {} bytes", key, kLongestText));
    }
    return found->get<std::string>();
}

std::optional<int> number_at(const json& body, const char* key, int least, int most) {
    const auto found = body.find(key);
    if (found == body.end()) {
        return std::nullopt;
    }
    if (!found->is_number_integer() || *found < least || *found > most) {
        throw HttpProblem(
            422, "bad-field",
            fmt::format("{}: must be a whole number from {} to {}", key, least, most));
    }
    return found->get<int>();
}

void check_keys(const json& body) {
    for (const auto& [key, value] : body.items()) {
        if (key != "priority" && key != "position" && key != "name") {
            throw HttpProblem(422, "bad-field", fmt::format("{}: can't be changed", key));
        }
    }
}

}  // namespace

json queue_json(App& app) {
    constexpr int kMost = 500;
    const QueueCounts counts = app.store().jobs.queue_counts();
    const auto pause = app.store().jobs.queue_pause();
    json next = json::array();
    for (const JobRecord& job : app.store().jobs.queue(kMost)) {
        next.push_back({{"id", job.id}, {"name", job.name}, {"priority", job.priority}});
    }
    return {{"paused", pause.has_value()},
            {"reason", pause.value_or("")},
            {"queued", counts.queued},
            {"computing", counts.computing},
            {"dead_letters", counts.dead_letters},
            {"next", next}};
}

Response show_queue(App& app, Request&) {
    return json_response(queue_json(app));
}

Response pause_queue(App& app, Request& request) {
    app.store().jobs.pause_queue(text_in(read_json_object(request), "reason"));
    return json_response(queue_json(app));
}

Response resume_queue(App& app, Request&) {
    app.store().jobs.resume_queue();
    app.compute().wake();
    for (const auto& runner : app.fleet().all()) {
        runner->wake();
    }
    return json_response(queue_json(app));
}

Response change_job(App& app, Request& request) {
    const JobRecord job = find_job(app, request);
    const json body = read_json_object(request);
    check_keys(body);
    constexpr int kMost = JobStore::kMostPriority;
    const auto priority = number_at(body, "priority", -kMost, kMost);
    const auto position = number_at(body, "position", 1, 1000000);
    const std::string name = text_in(body, "name");
    if (!name.empty()) {
        app.store().jobs.rename(job.id, name);
    }
    if (priority) {
        app.store().jobs.set_priority(job.id, *priority);
    }
    if (position && !app.store().jobs.move_to(job.id, *position)) {
        throw HttpProblem(409, "not-now", "only a job that is queued has a place in the queue");
    }
    return json_response(job_json(app, find_job(app, request)));
}

Response retry_job(App& app, Request& request) {
    const JobRecord job = find_job(app, request);
    const json body = read_json_object(request);
    const std::string cause = text_in(body, "cause");
    if (!app.store().jobs.retry(job.id, cause.empty() ? "an operator wants it" : cause)) {
        throw HttpProblem(409, "not-now",
                          fmt::format("a job that is {} is not tried again: only a failed or "
                                      "cancelled one",
                                      to_string(job.state)));
    }
    app.compute().wake();
    return json_response(job_json(app, find_job(app, request)), 202);
}

}  // namespace leafcutter::server
