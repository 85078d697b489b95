#include "server/http/api/lookup.h"

#include <algorithm>
#include <charconv>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "server/app.h"
#include "server/http/json_body.h"
#include "server/http/problem.h"

namespace leafcutter::server {

namespace {

std::optional<std::int64_t> query_number(const Request& request, const char* name) {
    const auto found = request.query.find(name);
    if (found == request.query.end()) {
        return std::nullopt;
    }
    std::int64_t number = 0;
    const char* end = found->second.data() + found->second.size();
    const auto parsed = std::from_chars(found->second.data(), end, number);
    if (parsed.ec != std::errc() || parsed.ptr != end || number < 0) {
        throw HttpProblem(400, "bad-query", fmt::format("{}: must be a whole number", name));
    }
    return number;
}

}  // namespace

Response json_response(const nlohmann::json& value, int status) {
    Response response;
    response.status = status;
    response.body = dump_json(value);
    return response;
}

Page page_in(const Request& request) {
    constexpr std::int64_t kMost = 200;
    Page page;
    const std::int64_t limit = query_number(request, "limit").value_or(page.limit);
    page.limit = static_cast<int>(std::clamp<std::int64_t>(limit, 1, kMost));
    page.cursor = query_number(request, "cursor");
    return page;
}

JobRecord find_job(App& app, const Request& request) {
    auto job = app.store().jobs.find(request.capture("id"));
    if (!job) {
        throw HttpProblem(404, "no-such-job", "there is no job of that id");
    }
    return *std::move(job);
}

CutRecord find_cut(App& app, const Request& request) {
    auto cut = app.store().cuts.find(request.capture("id"));
    if (!cut) {
        throw HttpProblem(404, "no-such-cut", "there is no cut of that id");
    }
    return *std::move(cut);
}

}  // namespace leafcutter::server
