// Logging in and out of the dashboard.

#include <array>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "server/app.h"
#include "server/http/api/handlers.h"
#include "server/http/api/lookup.h"
#include "server/http/guard.h"
#include "server/http/json_body.h"
#include "server/http/problem.h"

namespace leafcutter::server {

namespace {

using nlohmann::json;

json session_json(const Caller& caller, const std::string& token) {
    const bool is_session = caller.proof == Caller::Proof::Session;
    const bool known = caller.proof != Caller::Proof::None;
    json body = {{"accounts", caller.proof != Caller::Proof::NoAccounts},
                 {"authenticated", known},
                 {"user", caller.name.empty() ? json() : json(caller.name)},
                 {"role", known ? json(to_string(caller.role)) : json()},
                 {"may_fire", caller.may_fire},
                 {"csrf_token", is_session ? json(csrf_token_of(token)) : json()}};
    return body;
}

std::string cookie_of(const Request& request, const std::string& token, std::int64_t seconds) {
    return fmt::format("{}={}; Path=/; Max-Age={}; HttpOnly; SameSite=Strict{}", kSessionCookie,
                       token, seconds, request.is_secure ? "; Secure" : "");
}

}  // namespace

Response show_session(App&, Request& request) {
    return json_response(session_json(request.caller, session_token_of(request)));
}

Response log_in(App& app, Request& request) {
    const json body = read_json_object(request);
    const std::string user = text_field(body, "user");
    const std::string password = text_field(body, "password");
    request.audit_note = user.substr(0, 64);
    if (app.accounts().empty()) {
        throw HttpProblem(409, "no-accounts", "nobody has an account: everything is open");
    }
    // A few tries at one name, and as many at all names: guessing names is guessing too.
    const std::array<std::string, 2> tries{fmt::format("{} {}", request.remote, user),
                                           fmt::format("{}", request.remote)};
    for (const std::string& key : tries) {
        check_try(app.login_limit(), key);
    }
    const HashPlace place;
    if (!app.accounts().is_password_of(user, password)) {
        throw HttpProblem(401, "login-failed", "there is no such user, or the password is wrong");
    }
    for (const std::string& key : tries) {
        app.login_limit().succeed(key);
    }
    const std::string old = session_token_of(request);
    if (!old.empty()) {
        app.accounts().end_session(old);
    }
    const NewSecret token = app.accounts().begin_session(user);
    request.caller = app.accounts().by_session(token.secret);
    Response response = json_response(session_json(request.caller, token.secret));
    response.headers["Set-Cookie"] = cookie_of(request, token.secret, Accounts::kSessionMs / 1000);
    return response;
}

Response log_out(App& app, Request& request) {
    const std::string token = session_token_of(request);
    if (!token.empty()) {
        app.accounts().end_session(token);
    }
    Response gone;
    gone.status = 204;
    gone.headers["Set-Cookie"] = cookie_of(request, "", 0);
    return gone;
}

}  // namespace leafcutter::server
