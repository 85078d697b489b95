#include "server/http/router.h"

#include <algorithm>
#include <set>
#include <string>

#include <fmt/format.h>

#include "server/http/api/handlers.h"
#include "server/http/dashboard.h"
#include "server/http/problem.h"

namespace leafcutter::server {

namespace {

constexpr Route kRoutes[] = {
    {"POST", "/api/v1/jobs", create_job},
    {"GET", "/api/v1/jobs", list_jobs},
    {"GET", "/api/v1/jobs/{id}", show_job},
    {"DELETE", "/api/v1/jobs/{id}", delete_job},
    {"POST", "/api/v1/jobs/{id}/recompute", recompute_job},
    {"POST", "/api/v1/jobs/{id}/recut", recut_job},
    {"GET", "/api/v1/jobs/{id}/artifacts", list_artifacts},
    {"GET", "/api/v1/jobs/{id}/artifacts/{path...}", show_artifact},
    {"GET", "/api/v1/jobs/{id}/package.zip", show_package},
    {"GET", "/api/v1/jobs/{id}/events", stream_job_events},
    {"POST", "/api/v1/jobs/{id}/cuts", create_cut},
    {"PUT", "/api/v1/blobs/{sha256}", put_blob},
    {"GET", "/api/v1/cuts", list_cuts},
    {"GET", "/api/v1/cuts/{id}", show_cut},
    {"POST", "/api/v1/cuts/{id}/start", start_cut},
    {"POST", "/api/v1/cuts/{id}/confirm-sheet", confirm_sheet},
    {"POST", "/api/v1/cuts/{id}/pause", pause_cut},
    {"POST", "/api/v1/cuts/{id}/resume", resume_cut},
    {"POST", "/api/v1/cuts/{id}/finish", finish_cut},
    {"POST", "/api/v1/cuts/{id}/abort", abort_cut},
    {"GET", "/api/v1/devices", list_devices},
    {"GET", "/api/v1/devices/{id}", show_device},
    {"PUT", "/api/v1/devices/{id}", put_device},
    {"DELETE", "/api/v1/devices/{id}", delete_device},
    {"POST", "/api/v1/devices/{id}/commands", command_device},
    {"GET", "/api/v1/devices/{id}/settings", list_settings},
    {"GET", "/api/v1/ports", list_ports},
    {"GET", "/api/v1/materials", list_materials},
    {"GET", "/api/v1/materials/{id}", show_material},
    {"PUT", "/api/v1/materials/{id}", put_material},
    {"DELETE", "/api/v1/materials/{id}", delete_material},
    {"GET", "/api/v1/events", stream_events},
    {"GET", "/api/v1/version", show_version},
    {"GET", "/api/v1/openapi.json", show_openapi},
    {"GET", "/healthz", show_health},
    {"GET", "/readyz", show_readiness},
    {"GET", "/metrics", show_metrics},
    {"GET", "/api/v1/healthz", show_health},
    {"GET", "/api/v1/readyz", show_readiness},
    {"GET", "/api/v1/metrics", show_metrics},
};

std::string_view next_segment(std::string_view& path) {
    const std::size_t end = std::min(path.find('/'), path.size());
    const std::string_view segment = path.substr(0, end);
    path.remove_prefix(std::min(end + 1, path.size()));
    return segment;
}

}  // namespace

std::span<const Route> routes() {
    return kRoutes;
}

bool matches(std::string_view pattern, std::string_view path, Request& request) {
    request.captures.clear();
    pattern.remove_prefix(1);
    path.remove_prefix(1);
    while (!pattern.empty() && !path.empty()) {
        const std::string_view wanted = next_segment(pattern);
        if (wanted.ends_with("...}")) {
            request.captures[std::string(wanted.substr(1, wanted.size() - 5))] = path;
            return true;
        }
        const std::string_view segment = next_segment(path);
        if (wanted.starts_with('{')) {
            request.captures[std::string(wanted.substr(1, wanted.size() - 2))] = segment;
        } else if (wanted != segment) {
            return false;
        }
    }
    return pattern.empty() && path.empty();
}

Response route(App& app, Request& request) {
    const std::string method = request.method == "HEAD" ? "GET" : request.method;
    std::set<std::string> allowed;
    for (const Route& each : kRoutes) {
        if (!matches(each.pattern, request.path, request)) {
            continue;
        }
        if (each.method == method) {
            return each.handler(app, request);
        }
        allowed.emplace(each.method);
    }
    if (method == "GET" && allowed.empty()) {
        if (auto page = dashboard_file(request)) {
            return *page;
        }
    }
    if (allowed.empty()) {
        throw HttpProblem(404, "not-found", "there is nothing at this path");
    }
    Response response = problem_response(
        {405, "method-not-allowed", fmt::format("allowed here: {}", fmt::join(allowed, ", "))});
    response.headers["Allow"] = fmt::format("{}", fmt::join(allowed, ", "));
    return response;
}

}  // namespace leafcutter::server
