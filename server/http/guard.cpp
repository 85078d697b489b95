#include "server/http/guard.h"

#include <algorithm>
#include <atomic>
#include <chrono>

#include <fmt/format.h>

#include "server/auth/accounts.h"
#include "server/auth/login_limit.h"
#include "server/auth/secrets.h"
#include "server/http/problem.h"

namespace leafcutter::server {

namespace {

std::optional<std::string> key_in(const Request& request) {
    constexpr std::string_view kScheme = "Bearer ";
    const auto authorization = request.header("authorization");
    if (authorization && authorization->starts_with(kScheme)) {
        return authorization->substr(kScheme.size());
    }
    return request.header("x-api-key");
}

constexpr int kHashPlaces = 2;
std::atomic<int> hashes_running{0};

HttpProblem too_many_tries(std::chrono::seconds wait) {
    HttpProblem problem(429, "too-many-tries",
                        fmt::format("wait {} s before the next try", wait.count()));
    problem.headers["Retry-After"] = std::to_string(wait.count());
    return problem;
}

HttpProblem unknown_caller() {
    HttpProblem problem(401, "unauthenticated", "log in, or send a key that is valid");
    problem.headers["WWW-Authenticate"] = "Bearer realm=\"leafcutter\"";
    return problem;
}

}  // namespace

bool is_unsafe(const Request& request) {
    return request.method != "GET" && request.method != "HEAD" && request.method != "OPTIONS";
}

std::string session_token_of(const Request& request) {
    const std::string header = request.header("cookie").value_or("");
    const std::string wanted = fmt::format("{}=", kSessionCookie);
    std::string_view cookies = header;
    while (!cookies.empty()) {
        const std::size_t end = std::min(cookies.find(';'), cookies.size());
        std::string_view cookie = cookies.substr(0, end);
        cookies.remove_prefix(std::min(end + 1, cookies.size()));
        cookie.remove_prefix(std::min(cookie.find_first_not_of(' '), cookie.size()));
        if (cookie.starts_with(wanted)) {
            return std::string(cookie.substr(wanted.size()));
        }
    }
    return {};
}

namespace {

// Another node passes on what somebody asked of it, and who that is.
Caller caller_of_peer(const Request& request) {
    const Role role =
        role_named(request.header("x-leafcutter-role").value_or("")).value_or(Role::Nobody);
    // Without a name it asks for itself: for files.
    const bool itself = !request.header("x-leafcutter-role");
    return {Caller::Proof::Key, request.header("x-leafcutter-caller").value_or("fleet"),
            itself ? Role::Admin : role,
            !itself && request.header("x-leafcutter-may-fire") == "yes"};
}

}  // namespace

bool is_from_peer(const Request& request, std::string_view fleet_key) {
    const auto key = fleet_key.empty() ? std::nullopt : key_in(request);
    return key && same_secret(*key, fleet_key);
}

void identify(Accounts& accounts, std::string_view fleet_key, Request& request) {
    if (is_from_peer(request, fleet_key)) {
        request.caller = caller_of_peer(request);
        return;
    }
    if (accounts.empty()) {
        request.caller = {Caller::Proof::NoAccounts, "", Role::Admin, true};
        return;
    }
    if (const auto key = key_in(request)) {
        request.caller = accounts.by_key(*key);
        return;
    }
    const std::string token = session_token_of(request);
    if (token.empty()) {
        return;
    }
    request.caller = accounts.by_session(token);
    const bool is_session = request.caller.proof == Caller::Proof::Session;
    if (is_session && is_unsafe(request) &&
        !same_secret(request.header("x-csrf-token").value_or(""), csrf_token_of(token))) {
        request.caller = {};
        throw HttpProblem(403, "csrf-token",
                          "send the session's token along, in the header X-CSRF-Token");
    }
}

void admit(const Request& request, Role least, Beam beam) {
    const Caller& caller = request.caller;
    if (caller.role < least) {
        if (caller.proof == Caller::Proof::None) {
            throw unknown_caller();
        }
        throw HttpProblem(403, "role",
                          fmt::format("this takes the role {}; {} has {}", to_string(least),
                                      caller.name, to_string(caller.role)));
    }
    if (beam == Beam::MayFire && !caller.may_fire) {
        throw HttpProblem(403, "may-not-fire",
                          "this can turn the beam on, and the key was not given that right");
    }
}

void check_try(LoginLimit& limit, const std::string& key) {
    const std::chrono::seconds wait = limit.try_now(key, LoginLimit::Clock::now());
    if (wait.count() > 0) {
        throw too_many_tries(wait);
    }
}

HashPlace::HashPlace() {
    if (++hashes_running > kHashPlaces) {
        --hashes_running;
        throw HttpProblem(503, "busy", "too many passwords are being checked just now");
    }
}

HashPlace::~HashPlace() {
    --hashes_running;
}

}  // namespace leafcutter::server
