// Live events.

#include <charconv>

#include "server/app.h"
#include "server/http/api/handlers.h"
#include "server/http/api/lookup.h"
#include "server/http/problem.h"

namespace leafcutter::server {

namespace {

Response stream(App& app, const Request& request, std::optional<std::string> job) {
    if (app.hub().clients() >= EventHub::kMostClients) {
        throw HttpProblem(503, "busy", "too many pages are listening");
    }
    EventSubscription subscription;
    subscription.job = std::move(job);
    subscription.caller = request.caller;
    if (const auto last = request.header("last-event-id")) {
        std::int64_t seq = 0;
        const char* end = last->data() + last->size();
        const auto parsed = std::from_chars(last->data(), end, seq);
        // An id we did not give is as good as none: the stream begins with a snapshot.
        if (parsed.ec == std::errc() && parsed.ptr == end && seq >= 0) {
            subscription.last_seen = seq;
        }
    }
    Response response;
    response.content_type = "text/event-stream";
    response.events = std::move(subscription);
    return response;
}

}  // namespace

Response stream_events(App& app, Request& request) {
    return stream(app, request, std::nullopt);
}

Response stream_job_events(App& app, Request& request) {
    return stream(app, request, find_job(app, request).id);
}

}  // namespace leafcutter::server
