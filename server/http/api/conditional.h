// Changes that only go through if nobody else changed the thing meanwhile: ETag and If-Match
// (RFC 9110, section 13). Lists page by page.

#pragma once

#include <mutex>
#include <optional>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "server/http/request.h"
#include "server/http/response.h"

namespace leafcutter::server {

// Of what a client may change of a thing; the same words give the same tag.
std::string etag_of(const nlohmann::json& thing);

// `shown` as the answer, with the tag of `thing`.
Response tagged_response(const nlohmann::json& shown,
                         const nlohmann::json& thing,
                         int status = 200);

// Holds every other conditional change off from the look at `current` until the change is done.
class ConditionalChange {
public:
    // `current`: the thing as it is, or nothing if there is none. Throws HttpProblem (412).
    template <typename Look>
    ConditionalChange(const Request& request, Look look) : lock_(mutex()) {
        check(request, look());
    }

private:
    static std::mutex& mutex();
    static void check(const Request& request, const std::optional<nlohmann::json>& current);

    const std::scoped_lock<std::mutex> lock_;
};

// A list held in memory, with ?limit= and ?cursor= (the last id of the page before) heeded; whole
// unless a limit is given. {name: items, "next_cursor": …}. Throws HttpProblem (400).
nlohmann::json paged(const char* name,
                     nlohmann::json items,
                     const char* id_field,
                     const Request& request);

}  // namespace leafcutter::server
