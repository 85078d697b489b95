#include "server/http/api/conditional.h"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <string_view>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "server/http/api/lookup.h"
#include "server/http/json_body.h"
#include "server/http/problem.h"
#include "server/store/blobs.h"

namespace leafcutter::server {

namespace {

using nlohmann::json;

// One of a comma-separated list of tags; weak ones never match.
bool names(std::string_view tags, std::string_view tag) {
    while (!tags.empty()) {
        const std::size_t end = std::min(tags.find(','), tags.size());
        std::string_view each = tags.substr(0, end);
        tags.remove_prefix(std::min(end + 1, tags.size()));
        each.remove_prefix(std::min(each.find_first_not_of(' '), each.size()));
        each = each.substr(0, each.find_last_not_of(' ') + 1);
        if (each == tag) {
            return true;
        }
    }
    return false;
}

}  // namespace

std::string etag_of(const json& thing) {
    constexpr std::size_t kLetters = 32;
    return fmt::format("\"{}\"", sha256_of(dump_json(thing)).substr(0, kLetters));
}

Response tagged_response(const json& shown, const json& thing, int status) {
    Response response = json_response(shown, status);
    response.headers["ETag"] = etag_of(thing);
    return response;
}

std::mutex& ConditionalChange::mutex() {
    static std::mutex one_at_a_time;
    return one_at_a_time;
}

void ConditionalChange::check(const Request& request, const std::optional<json>& current) {
    const auto wanted = request.header("if-match");
    if (wanted && (!current || (*wanted != "*" && !names(*wanted, etag_of(*current))))) {
        throw HttpProblem(412, "changed-meanwhile",
                          current ? "somebody changed it since you looked: look again"
                                  : "there is no such thing to change");
    }
    const auto unwanted = request.header("if-none-match");
    if (unwanted && current && (*unwanted == "*" || names(*unwanted, etag_of(*current)))) {
        throw HttpProblem(412, "there-already", "there is one of that id");
    }
}

json paged(const char* name, json items, const char* id_field, const Request& request) {
    auto first = items.begin();
    if (const auto cursor = request.query.find("cursor"); cursor != request.query.end()) {
        first = std::find_if(items.begin(), items.end(),
                             [&](const json& item) { return item.at(id_field) == cursor->second; });
        if (first == items.end()) {
            throw HttpProblem(400, "bad-query", "cursor: the list has no such id any more");
        }
        ++first;
    }
    auto last = items.end();
    if (request.query.count("limit") != 0) {
        last = first + std::min<std::ptrdiff_t>(limit_in(request), items.end() - first);
    }
    json page = json::array();
    std::copy(first, last, std::back_inserter(page));
    const bool more = last != items.end() && !page.empty();
    const json next = more ? page.back().at(id_field) : json();
    return {{name, std::move(page)}, {"next_cursor", next}};
}

}  // namespace leafcutter::server
