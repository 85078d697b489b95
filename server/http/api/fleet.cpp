// The nodes of a fleet, what they hold, and whether they may take up work.

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "server/app.h"
#include "server/http/api/handlers.h"
#include "server/http/api/lookup.h"
#include "server/http/problem.h"
#include "server/store/ids.h"

namespace leafcutter::server {

namespace {

using nlohmann::json;

bool is_silent(App& app, const NodeRecord& node) {
    return node.silent_ms > app.self()->lease.count();
}

// "drained": it was told to, and has nothing in work any more.
std::string_view state_of(App& app, const NodeRecord& node, const json& facts) {
    if (is_silent(app, node)) {
        return "silent";
    }
    // It has heard of it and has nothing in work.
    const bool idle = facts.value("mode", "") == to_string(NodeMode::Draining) &&
                      facts.value("cutting", 0) + facts.value("computing", 0) == 0;
    return node.mode == NodeMode::Draining && idle ? "drained" : to_string(node.mode);
}

std::vector<std::string> actions_of(App& app, const NodeRecord& node) {
    std::vector<std::string> actions;
    if (node.mode == NodeMode::Active) {
        actions = {"pause", "drain"};
    } else {
        actions = {"resume"};
    }
    if (is_silent(app, node)) {
        actions.emplace_back("forget");
    }
    return actions;
}

json node_json(App& app, const NodeRecord& node) {
    const json facts = json::parse(node.facts_json, nullptr, /*allow_exceptions=*/false);
    const json known = facts.is_object() ? facts : json::object();
    constexpr double kMilli = 1e-3;
    return {{"id", node.id},
            {"role", node.role},
            {"url", node.url},
            {"version", node.version},
            {"mode", to_string(node.mode)},
            {"state", state_of(app, node, known)},
            {"silent_s", kMilli * static_cast<double>(std::max<std::int64_t>(0, node.silent_ms))},
            {"joined_at", rfc3339(node.started_ms)},
            {"seen_at", rfc3339(node.seen_ms)},
            {"machines", known.value("machines", json::array())},
            {"workers", known.value("workers", 0)},
            {"computing", known.value("computing", 0)},
            {"cutting", known.value("cutting", 0)},
            {"database_ms", known.value("database_ms", 0)},
            {"actions", actions_of(app, node)}};
}

json leases_json(App& app) {
    constexpr double kMilli = 1e-3;
    json leases = json::array();
    for (const MachineLease& lease : app.store().fleet.machine_leases()) {
        leases.push_back({{"device", lease.device},
                          {"station", lease.owner},
                          {"fence", lease.fence},
                          {"held", lease.left_ms > 0},
                          {"left_s", kMilli * static_cast<double>(lease.left_ms)}});
    }
    return leases;
}

json duties_json(App& app) {
    json duties = json::array();
    for (const MachineLease& lease : app.store().fleet.duty_leases()) {
        duties.push_back(
            {{"duty", lease.device}, {"node", lease.owner}, {"held", lease.left_ms > 0}});
    }
    return duties;
}

json claims_json(App& app) {
    constexpr int kMost = 200;
    JobQuery query;
    query.state = JobState::Computing;
    query.limit = kMost;
    json claims = json::array();
    for (const JobRecord& job : app.store().jobs.list(query)) {
        claims.push_back({{"job", job.id},
                          {"worker", job.owner},
                          {"fence", job.fence},
                          {"attempt", job.attempt},
                          {"until", rfc3339(job.lease_until_ms)}});
    }
    return claims;
}

const FleetSelf& self_of(App& app) {
    if (app.self() == nullptr) {
        throw HttpProblem(404, "no-fleet", "this daemon works alone");
    }
    return *app.self();
}

Response wanted_mode(App& app, const Request& request, NodeMode mode) {
    self_of(app);
    const std::string& id = request.capture("id");
    if (!app.store().fleet.set_mode(id, mode)) {
        throw HttpProblem(404, "no-such-node", "there is no node of that name");
    }
    for (const NodeRecord& node : app.store().fleet.nodes()) {
        if (node.id == id) {
            return json_response(node_json(app, node), 202);
        }
    }
    throw HttpProblem(404, "no-such-node", "there is no node of that name");
}

}  // namespace

Response show_fleet(App& app, Request&) {
    if (app.self() == nullptr) {
        return json_response({{"alone", true},
                              {"node", nullptr},
                              {"lease_s", nullptr},
                              {"nodes", json::array()},
                              {"machine_leases", json::array()},
                              {"duties", json::array()},
                              {"claims", json::array()}});
    }
    json nodes = json::array();
    for (const NodeRecord& node : app.store().fleet.nodes()) {
        nodes.push_back(node_json(app, node));
    }
    return json_response({{"alone", false},
                          {"node", app.self()->id},
                          {"lease_s", static_cast<double>(app.self()->lease.count()) / 1000.0},
                          {"nodes", std::move(nodes)},
                          {"machine_leases", leases_json(app)},
                          {"duties", duties_json(app)},
                          {"claims", claims_json(app)}});
}

Response pause_node(App& app, Request& request) {
    return wanted_mode(app, request, NodeMode::Paused);
}

Response drain_node(App& app, Request& request) {
    return wanted_mode(app, request, NodeMode::Draining);
}

Response resume_node(App& app, Request& request) {
    return wanted_mode(app, request, NodeMode::Active);
}

Response forget_node(App& app, Request& request) {
    self_of(app);
    for (const NodeRecord& node : app.store().fleet.nodes()) {
        if (node.id == request.capture("id") && !is_silent(app, node)) {
            throw HttpProblem(409, "not-now", "the node lives: stop it first");
        }
    }
    if (!app.store().fleet.forget(request.capture("id"))) {
        throw HttpProblem(404, "no-such-node", "there is no node of that name");
    }
    Response gone;
    gone.status = 204;
    return gone;
}

}  // namespace leafcutter::server
