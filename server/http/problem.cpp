#include "server/http/problem.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <spdlog/spdlog.h>

#include "drivers/device.h"
#include "geometry/error.h"
#include "server/auth/accounts.h"
#include "server/http/json_body.h"
#include "server/store/cut_store.h"
#include "server/store/job_store.h"
#include "server/store/store_error.h"

namespace leafcutter::server {

namespace {

std::string_view title_of(int status) {
    switch (status) {
        case 400:
            return "The request is malformed";
        case 401:
            return "Who are you?";
        case 403:
            return "Not allowed";
        case 404:
            return "There is no such thing";
        case 405:
            return "This method does not apply here";
        case 408:
            return "Too slow";
        case 409:
            return "Not in this state";
        case 411:
            return "The body's length is missing";
        case 413:
            return "Too large";
        case 415:
            return "This kind of content is not taken";
        case 416:
            return "This range can't be had";
        case 421:
            return "Wrong host";
        case 422:
            return "A value is not possible";
        case 429:
            return "Too many tries";
        case 431:
            return "The head is too large";
        case 503:
            return "Busy";
        case 507:
            return "The disk is full";
        default:
            return status >= 500 ? "The server failed" : "Refused";
    }
}

// The field's path at the head of a message, as a JSON pointer; empty if there is none.
std::string pointer_in(const std::string& message) {
    const std::size_t colon = message.find(':');
    if (colon == std::string::npos || message.find(' ') < colon) {
        return {};
    }
    std::string pointer(1, '/');
    for (const char c : std::string_view(message).substr(0, colon)) {
        if (c != ']') {
            pointer += c == '.' || c == '[' ? '/' : c;
        }
    }
    return pointer;
}

HttpProblem problem_of(const StoreError& error) {
    spdlog::error("store: {}", error.what());
    switch (error.trouble()) {
        case StoreTrouble::Busy:
            return {503, "store-busy", "the database is held by somebody else: try again"};
        case StoreTrouble::Full:
            return {507, "disk", "the disk is full: nothing was changed"};
        case StoreTrouble::ReadOnly:
            return {503, "read-only", "the store takes no changes: see /readyz"};
        case StoreTrouble::Damaged:
            return {503, "store-damaged", "this can't be read: the database is damaged"};
        case StoreTrouble::Failed:
            break;
    }
    return {503, "store-failed", "the database failed: see the log"};
}

}  // namespace

Response problem_response(const HttpProblem& problem) {
    nlohmann::json body = {
        {"type", fmt::format("https://leafcutter.dev/problems/{}", problem.code)},
        {"title", title_of(problem.status)},
        {"status", problem.status},
        {"detail", problem.what()},
        {"code", problem.code}};
    const std::string pointer = problem.status == 422 ? pointer_in(problem.what()) : std::string();
    if (!pointer.empty()) {
        body["errors"].push_back({{"pointer", pointer}, {"detail", problem.what()}});
    }
    Response response;
    response.status = problem.status;
    response.headers = problem.headers;
    response.content_type = "application/problem+json";
    response.body = dump_json(body);
    if (problem.status == 503) {
        constexpr int kSoonS = 1;
        response.headers["Retry-After"] = std::to_string(kSoonS);
    }
    return response;
}

Response response_to(const std::exception& error) {
    if (const auto* problem = dynamic_cast<const HttpProblem*>(&error)) {
        return problem_response(*problem);
    }
    if (const auto* refused = dynamic_cast<const geometry::Error*>(&error)) {
        return problem_response({422, refused->code(), refused->what()});
    }
    if (dynamic_cast<const drivers::Refused*>(&error) != nullptr) {
        return problem_response({409, "refused", error.what()});
    }
    if (dynamic_cast<const NotCuttable*>(&error) != nullptr) {
        return problem_response({409, "not-cuttable", error.what()});
    }
    if (dynamic_cast<const KeyReused*>(&error) != nullptr) {
        return problem_response({422, "idempotency-key-reused", error.what()});
    }
    if (dynamic_cast<const BadAccount*>(&error) != nullptr) {
        return problem_response({422, "bad-field", error.what()});
    }
    if (dynamic_cast<const LastAdmin*>(&error) != nullptr) {
        return problem_response({409, "last-admin", error.what()});
    }
    if (dynamic_cast<const BlobWriteFailed*>(&error) != nullptr) {
        spdlog::error("blob store: {}", error.what());
        return problem_response({507, "disk", "the file could not be stored"});
    }
    if (const auto* store = dynamic_cast<const StoreError*>(&error)) {
        return problem_response(problem_of(*store));
    }
    spdlog::error("request failed: {}", error.what());  // The client gets no word of its insides.
    return problem_response({500, "internal", "an internal error; the log has more"});
}

}  // namespace leafcutter::server
