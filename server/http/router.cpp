#include "server/http/router.h"

#include <algorithm>
#include <chrono>
#include <set>
#include <string>

#include <fmt/format.h>

#include "server/app.h"
#include "server/http/api/handlers.h"
#include "server/http/dashboard.h"
#include "server/http/forward.h"
#include "server/http/guard.h"
#include "server/http/problem.h"

namespace leafcutter::server {

namespace {

constexpr Route kRoutes[] = {
    {"POST", "/api/v1/jobs", create_job, Role::Submitter},
    {"GET", "/api/v1/jobs", list_jobs, Role::Viewer},
    {"GET", "/api/v1/jobs/{id}", show_job, Role::Viewer},
    {"DELETE", "/api/v1/jobs/{id}", delete_job, Role::Submitter},
    {"PATCH", "/api/v1/jobs/{id}", change_job, Role::Operator},
    {"POST", "/api/v1/jobs/{id}/retry", retry_job, Role::Submitter},
    {"POST", "/api/v1/jobs/{id}/recompute", recompute_job, Role::Submitter},
    {"POST", "/api/v1/jobs/{id}/recut", recut_job, Role::Submitter},
    {"POST", "/api/v1/test-cards", create_test_card, Role::Submitter},
    {"GET", "/api/v1/jobs/{id}/artifacts", list_artifacts, Role::Viewer},
    {"GET", "/api/v1/jobs/{id}/artifacts/{path...}", show_artifact, Role::Viewer},
    {"GET", "/api/v1/jobs/{id}/mesh", show_mesh, Role::Viewer},
    {"GET", "/api/v1/jobs/{id}/package.zip", show_package, Role::Viewer},
    {"GET", "/api/v1/jobs/{id}/events", stream_job_events, Role::Viewer},
    {"POST", "/api/v1/jobs/{id}/cuts", create_cut, Role::Operator},
    {"PUT", "/api/v1/blobs/{sha256}", put_blob, Role::Submitter},
    {"GET", "/api/v1/blobs/{sha256}", show_blob, Role::Admin},
    {"GET", "/api/v1/cuts", list_cuts, Role::Viewer},
    {"GET", "/api/v1/cuts/{id}", show_cut, Role::Viewer},
    {"POST", "/api/v1/cuts/{id}/start", start_cut, Role::Operator, Beam::MayFire},
    {"POST", "/api/v1/cuts/{id}/confirm-sheet", confirm_sheet, Role::Operator, Beam::MayFire},
    {"POST", "/api/v1/cuts/{id}/pause", pause_cut, Role::Viewer},
    {"POST", "/api/v1/cuts/{id}/resume", resume_cut, Role::Operator, Beam::MayFire},
    {"POST", "/api/v1/cuts/{id}/finish", finish_cut, Role::Operator, Beam::MayFire},
    {"POST", "/api/v1/cuts/{id}/abort", abort_cut, Role::Viewer},
    {"GET", "/api/v1/devices", list_devices, Role::Viewer},
    {"GET", "/api/v1/devices/{id}", show_device, Role::Viewer},
    {"PUT", "/api/v1/devices/{id}", put_device, Role::Admin},
    {"DELETE", "/api/v1/devices/{id}", delete_device, Role::Admin},
    {"POST", "/api/v1/devices/{id}/commands", command_device, Role::Viewer},
    {"GET", "/api/v1/devices/{id}/settings", list_settings, Role::Viewer},
    {"GET", "/api/v1/ports", list_ports, Role::Viewer},
    {"GET", "/api/v1/materials", list_materials, Role::Viewer},
    {"GET", "/api/v1/materials/{id}", show_material, Role::Viewer},
    {"PUT", "/api/v1/materials/{id}", put_material, Role::Operator},
    {"DELETE", "/api/v1/materials/{id}", delete_material, Role::Operator},
    {"POST", "/api/v1/materials", import_materials, Role::Operator},
    {"GET", "/api/v1/stock", list_stock, Role::Viewer},
    {"POST", "/api/v1/stock", import_stock, Role::Operator},
    {"GET", "/api/v1/stock/{id}", show_stock, Role::Viewer},
    {"PUT", "/api/v1/stock/{id}", put_stock, Role::Operator},
    {"DELETE", "/api/v1/stock/{id}", delete_stock, Role::Operator},
    {"GET", "/api/v1/presets", list_presets, Role::Viewer},
    {"POST", "/api/v1/presets", import_presets, Role::Submitter},
    {"GET", "/api/v1/presets/{id}", show_preset, Role::Viewer},
    {"PUT", "/api/v1/presets/{id}", put_preset, Role::Submitter},
    {"DELETE", "/api/v1/presets/{id}", delete_preset, Role::Submitter},
    {"GET", "/api/v1/queue", show_queue, Role::Viewer},
    {"POST", "/api/v1/queue/pause", pause_queue, Role::Operator},
    {"POST", "/api/v1/queue/resume", resume_queue, Role::Operator},
    {"GET", "/api/v1/fleet", show_fleet, Role::Viewer},
    {"POST", "/api/v1/fleet/{id}/pause", pause_node, Role::Operator},
    {"POST", "/api/v1/fleet/{id}/drain", drain_node, Role::Operator},
    {"POST", "/api/v1/fleet/{id}/resume", resume_node, Role::Operator},
    {"DELETE", "/api/v1/fleet/{id}", forget_node, Role::Admin},
    {"GET", "/api/v1/retention", show_retention, Role::Viewer},
    {"PUT", "/api/v1/retention", change_retention, Role::Admin},
    {"GET", "/api/v1/backups", list_backups, Role::Admin},
    {"POST", "/api/v1/backups", make_backup, Role::Admin},
    {"GET", "/api/v1/session", show_session, Role::Nobody},
    {"POST", "/api/v1/session", log_in, Role::Nobody},
    {"DELETE", "/api/v1/session", log_out, Role::Nobody},
    {"GET", "/api/v1/users", list_users, Role::Admin},
    {"POST", "/api/v1/users", add_user, Role::Admin},
    {"GET", "/api/v1/users/{name}", show_user, Role::Viewer},
    {"PUT", "/api/v1/users/{name}", change_user, Role::Viewer},
    {"DELETE", "/api/v1/users/{name}", delete_user, Role::Admin},
    {"GET", "/api/v1/keys", list_keys, Role::Viewer},
    {"POST", "/api/v1/keys", add_key, Role::Viewer},
    {"DELETE", "/api/v1/keys/{id}", delete_key, Role::Viewer},
    {"GET", "/api/v1/audit", list_audit, Role::Admin},
    {"GET", "/api/v1/events", stream_events, Role::Viewer},
    {"GET", "/api/v1/version", show_version, Role::Nobody},
    {"GET", "/api/v1/openapi.json", show_openapi, Role::Nobody},
    {"GET", "/api/version", octoprint_version, Role::Nobody},
    {"POST", "/api/files/local", octoprint_upload, Role::Submitter},
    {"GET", "/healthz", show_health, Role::Nobody},
    {"GET", "/readyz", show_readiness, Role::Nobody},
    {"GET", "/metrics", show_metrics, Role::Viewer},
    {"GET", "/api/v1/healthz", show_health, Role::Nobody},
    {"GET", "/api/v1/readyz", show_readiness, Role::Nobody},
    {"GET", "/api/v1/metrics", show_metrics, Role::Viewer},
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
    identify(app.accounts(), app.peers().key(), request);
    if (request.caller.proof == Caller::Proof::None && app.look_again_for_accounts(request)) {
        identify(app.accounts(), app.peers().key(), request);
    }
    const std::string method = request.method == "HEAD" ? "GET" : request.method;
    std::set<std::string> allowed;
    for (const Route& each : kRoutes) {
        if (!matches(each.pattern, request.path, request)) {
            continue;
        }
        if (each.method == method) {
            admit(request, each.least, each.beam);
            auto there = answer_elsewhere(app, request, each.pattern);
            return there ? *std::move(there) : each.handler(app, request);
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

Response answer(App& app, Request& request) {
    const auto begin = std::chrono::steady_clock::now();
    Response response;
    try {
        response = route(app, request);
    } catch (const std::exception& error) {
        response = response_to(error);
    }
    app.http_metrics().add(request.method, response.status,
                           std::chrono::steady_clock::now() - begin);
    if (is_unsafe(request)) {
        AuditRecord record;
        record.user = request.caller.name;
        record.remote = request.remote;
        record.action = fmt::format("{} {}", request.method, request.path);
        record.note = request.audit_note;
        record.status = response.status;
        app.audit().append(std::move(record));
    }
    return response;
}

}  // namespace leafcutter::server
