// The door: who sends a request, and whether they may.

#pragma once

#include "server/auth/role.h"
#include "server/http/request.h"
#include "server/http/router.h"

namespace leafcutter::server {

class Accounts;
class LoginLimit;

inline constexpr const char* kSessionCookie = "leafcutter_session";

// Whether the method may change anything.
bool is_unsafe(const Request& request);

// The session's token as the cookie carries it; empty if there is none.
std::string session_token_of(const Request& request);

// Sets `request.caller`, from the key (Authorization: Bearer, or X-Api-Key) or the session's
// cookie; or, with the fleet's key, as another node found out. What is unknown or over is nobody.
// Throws HttpProblem (403) for a session's unsafe call without its X-CSRF-Token.
void identify(Accounts& accounts, std::string_view fleet_key, Request& request);

// Another node of the fleet sent it, for itself or for somebody who asked there.
bool is_from_peer(const Request& request, std::string_view fleet_key);

// Throws HttpProblem: 401 for nobody, 403 for somebody of a lesser role, or for a key that may not
// fire.
void admit(const Request& request, Role least, Beam beam);

// Throws HttpProblem (429) while `key` has to wait; see LoginLimit.
void check_try(LoginLimit& limit, const std::string& key);

// A password's hash takes 64 MB and a core: so few at once that nothing else waits for them.
class HashPlace {
public:
    // Throws HttpProblem (503) if all are taken.
    HashPlace();
    ~HashPlace();
    HashPlace(const HashPlace&) = delete;
    HashPlace& operator=(const HashPlace&) = delete;
};

}  // namespace leafcutter::server
