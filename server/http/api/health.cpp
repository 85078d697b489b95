// Operations: is it alive, is it ready, what does it count.

#include <nlohmann/json.hpp>

#include "server/app.h"
#include "server/http/api/handlers.h"
#include "server/http/api/lookup.h"
#include "server/http/api/metrics_text.h"
#include "server/http/embedded.h"
#include "server/http/problem.h"

namespace leafcutter::server {

Response show_health(App&, Request&) {
    return json_response({{"status", "ok"}});
}

Response show_readiness(App& app, Request&) {
    constexpr std::int64_t kRoomForAJob = 16LL << 20;
    const std::string trouble = app.store().trouble();
    const bool database = trouble.empty();
    const bool disk = app.store().blobs.has_room_for(kRoomForAJob);
    const bool ready = database && disk;
    return json_response({{"status", ready ? "ready" : "not-ready"},
                          {"database", database},
                          {"disk", disk},
                          {"read_only", !database},
                          {"trouble", trouble},
                          {"notice", app.store().notice()}},
                         ready ? 200 : 503);
}

Response show_metrics(App& app, Request&) {
    Response response;
    response.content_type = "text/plain; version=0.0.4";
    response.body = metrics_text(app);
    return response;
}

Response show_version(App& app, Request&) {
    return json_response({{"name", "leafcutter"},
                          {"version", LEAFCUTTER_VERSION},
                          {"api", "v1"},
                          {"read_only", !app.store().trouble().empty()},
                          {"notice", app.store().notice()}});
}

Response show_openapi(App&, Request&) {
    Response response;
    response.body = find_embedded("openapi.json")->bytes;
    return response;
}

}  // namespace leafcutter::server
