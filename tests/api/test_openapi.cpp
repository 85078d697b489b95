#include <set>
#include <string>
#include <tuple>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "server/http/embedded.h"
#include "server/http/router.h"

namespace leafcutter::server {
namespace {

// Method, path, least role, and whether it may fire.
using Call = std::tuple<std::string, std::string, std::string, bool>;

std::set<Call> described_calls() {
    const nlohmann::json api = nlohmann::json::parse(find_embedded("openapi.json")->bytes);
    std::set<Call> calls;
    for (const auto& [path, item] : api.at("paths").items()) {
        for (const auto& [method, operation] : item.items()) {
            if (method != "parameters") {
                calls.emplace(method, path, operation.at("x-role"),
                              operation.value("x-may-fire", false));
            }
        }
    }
    return calls;
}

std::set<Call> routed_calls() {
    const std::string root = "/api/v1";
    std::set<Call> calls;
    for (const Route& route : routes()) {
        std::string path(route.pattern);
        if (!path.starts_with(root)) {
            continue;  // Health checks answer at the root, too.
        }
        path.erase(0, root.size());
        if (const std::size_t rest = path.find("...}"); rest != std::string::npos) {
            path.erase(rest, 3);
        }
        std::string method(route.method);
        for (char& letter : method) {
            letter = static_cast<char>(letter - 'A' + 'a');
        }
        calls.emplace(method, path, to_string(route.least), route.beam == Beam::MayFire);
    }
    return calls;
}

TEST(OpenApi, DescribesExactlyTheCallsThatExistAndTheirRoles) {
    EXPECT_EQ(described_calls(), routed_calls());
}

TEST(Router, MatchesSegmentsAndRests) {
    Request request;
    EXPECT_TRUE(matches("/jobs/{id}/files/{path...}", "/jobs/7/files/a/b.svg", request));
    EXPECT_EQ(request.capture("id"), "7");
    EXPECT_EQ(request.capture("path"), "a/b.svg");
    EXPECT_FALSE(matches("/jobs/{id}", "/jobs/7/files", request));
    EXPECT_FALSE(matches("/jobs/{id}", "/jobs", request));
    EXPECT_FALSE(matches("/jobs", "/jobsx", request));
}

}  // namespace
}  // namespace leafcutter::server
