// Users, their keys, and what everybody did.

#include <algorithm>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "server/app.h"
#include "server/http/api/handlers.h"
#include "server/http/api/lookup.h"
#include "server/http/guard.h"
#include "server/http/json_body.h"
#include "server/http/problem.h"
#include "server/store/ids.h"

namespace leafcutter::server {

namespace {

using nlohmann::json;

Response gone() {
    Response response;
    response.status = 204;
    return response;
}

json time_or_null(std::int64_t ms) {
    return ms > 0 ? json(rfc3339(ms)) : json();
}

json user_json(const User& user) {
    return {{"name", user.name},
            {"role", to_string(user.role)},
            {"created_at", rfc3339(user.created_ms)}};
}

json key_json(const ApiKey& key) {
    return {{"id", key.id},
            {"user", key.user},
            {"label", key.label},
            {"role", to_string(key.role)},
            {"may_fire", key.may_fire},
            {"created_at", rfc3339(key.created_ms)},
            {"expires_at", time_or_null(key.expires_ms)},
            {"used_at", time_or_null(key.used_ms)}};
}

Role role_in(const json& body, Role otherwise) {
    if (!body.contains("role")) {
        return otherwise;
    }
    const auto role = role_named(text_field(body, "role"));
    if (!role) {
        throw HttpProblem(422, "bad-field", "role: must be viewer, submitter, operator or admin");
    }
    return *role;
}

void check_fields(const json& body, const std::set<std::string>& known) {
    for (const auto& [key, value] : body.items()) {
        if (known.count(key) == 0) {
            throw HttpProblem(422, "bad-field", fmt::format("{}: there is no such field", key));
        }
    }
}

bool is_admin(const Request& request) {
    return request.caller.role == Role::Admin;
}

// Admins see to everybody, others to themselves: to them nobody else is there.
User find_user(App& app, const Request& request) {
    const std::string& name = request.capture("name");
    const auto user = app.accounts().user(name);
    if (!user || (!is_admin(request) && name != request.caller.name)) {
        throw HttpProblem(404, "no-such-user", "there is no user of that name");
    }
    return *user;
}

// A key that gets out must not be able to make itself a lasting way in.
void refuse_keys(const Request& request) {
    if (request.caller.proof == Caller::Proof::Key && !is_admin(request)) {
        throw HttpProblem(403, "needs-login", "a key can't do this: log in");
    }
}

// Whoever found a page open is not yet its user.
void check_own_password(App& app, const Request& request, const json& body) {
    const std::string key = fmt::format("{} {}", request.remote, request.caller.name);
    check_try(app.login_limit(), key);
    if (!app.accounts().is_password_of(request.caller.name, text_field(body, "old_password"))) {
        throw HttpProblem(403, "wrong-password", "old_password is not your password");
    }
    app.login_limit().succeed(key);
}

bool flag_in(const json& body, const char* key) {
    const auto found = body.find(key);
    if (found == body.end()) {
        return false;
    }
    if (!found->is_boolean()) {
        throw HttpProblem(422, "bad-field", fmt::format("{}: must be true or false", key));
    }
    return found->get<bool>();
}

KeyWish key_wish(const json& body) {
    check_fields(body, {"label", "role", "may_fire", "expires_in_days", "user"});
    KeyWish wish;
    wish.label = text_field(body, "label");
    wish.role = role_in(body, Role::Submitter);
    wish.may_fire = flag_in(body, "may_fire");
    const auto days = body.find("expires_in_days");
    if (days != body.end() && !days->is_null()) {
        constexpr std::int64_t kMostDays = 3650;
        if (!days->is_number_integer() || *days < 1 || *days > kMostDays) {
            throw HttpProblem(422, "bad-field", "expires_in_days: must be 1 to 3650");
        }
        constexpr std::int64_t kDayMs = 24LL * 3600 * 1000;
        wish.lifetime_ms = days->get<std::int64_t>() * kDayMs;
    }
    return wish;
}

}  // namespace

Response list_users(App& app, Request&) {
    json users = json::array();
    for (const User& user : app.accounts().users()) {
        users.push_back(user_json(user));
    }
    return json_response({{"users", users}, {"next_cursor", nullptr}});
}

Response add_user(App& app, Request& request) {
    const json body = read_json_object(request);
    check_fields(body, {"name", "role", "password"});
    const std::string name = text_field(body, "name");
    request.audit_note = name.substr(0, 64);
    const HashPlace place;
    app.accounts().add(name, role_in(body, Role::Viewer), text_field(body, "password"));
    Response response = json_response(user_json(app.accounts().user(name).value()), 201);
    response.headers["Location"] = fmt::format("/api/v1/users/{}", name);
    return response;
}

Response show_user(App& app, Request& request) {
    return json_response(user_json(find_user(app, request)));
}

Response change_user(App& app, Request& request) {
    const json body = read_json_object(request);
    check_fields(body, {"role", "password", "old_password"});
    const User user = find_user(app, request);
    refuse_keys(request);
    if (body.contains("role")) {
        admit(request, Role::Admin, Beam::Off);
    }
    if (body.contains("password")) {
        const HashPlace place;
        if (user.name == request.caller.name) {
            check_own_password(app, request, body);
        }
        app.accounts().set_password(user.name, text_field(body, "password"));
    }
    if (body.contains("role")) {
        app.accounts().set_role(user.name, role_in(body, user.role));
        request.audit_note =
            fmt::format("{} -> {}", to_string(user.role), text_field(body, "role"));
    }
    return json_response(user_json(find_user(app, request)));
}

Response delete_user(App& app, Request& request) {
    app.accounts().remove(find_user(app, request).name);
    return gone();
}

Response list_keys(App& app, Request& request) {
    json keys = json::array();
    for (const ApiKey& key : app.accounts().keys()) {
        if (is_admin(request) || key.user == request.caller.name) {
            keys.push_back(key_json(key));
        }
    }
    return json_response({{"keys", keys}, {"next_cursor", nullptr}});
}

Response add_key(App& app, Request& request) {
    refuse_keys(request);
    const json body = read_json_object(request);
    const KeyWish wish = key_wish(body);
    const std::string owner = text_field_or(body, "user", request.caller.name);
    if (owner != request.caller.name) {
        admit(request, Role::Admin, Beam::Off);
    }
    admit(request, wish.role, Beam::Off);
    const auto [key, secret] = app.accounts().add_key(owner, wish);
    request.audit_note = key.id;
    json shown = key_json(key);
    shown["key"] = secret.secret;  // This once.
    Response response = json_response(shown, 201);
    response.headers["Location"] = fmt::format("/api/v1/keys/{}", key.id);
    return response;
}

Response delete_key(App& app, Request& request) {
    const std::string& id = request.capture("id");
    const std::vector<ApiKey> keys = app.accounts().keys();
    const bool own = std::any_of(keys.begin(), keys.end(), [&](const ApiKey& key) {
        return key.id == id && (is_admin(request) || key.user == request.caller.name);
    });
    if (!own || !app.accounts().remove_key(id)) {
        throw HttpProblem(404, "no-such-key", "there is no key of that id");
    }
    return gone();
}

Response list_audit(App& app, Request& request) {
    app.audit().flush();  // What was answered is in the list.
    const Page page = page_in(request);
    json entries = json::array();
    const std::vector<AuditRecord> records = app.store().accounts.audit(page.cursor, page.limit);
    for (const AuditRecord& record : records) {
        entries.push_back({{"seq", record.seq},
                           {"at", rfc3339(record.at_ms)},
                           {"user", record.user.empty() ? json() : json(record.user)},
                           {"remote", record.remote},
                           {"action", record.action},
                           {"note", record.note},
                           {"status", record.status}});
    }
    const bool full = static_cast<int>(records.size()) == page.limit;
    return json_response(
        {{"entries", entries},
         {"next_cursor", full ? json(std::to_string(records.back().seq)) : json()}});
}

}  // namespace leafcutter::server
