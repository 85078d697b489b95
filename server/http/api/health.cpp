// Operations: is it alive, is it ready, what does it count.

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "drivers/device.h"
#include "server/app.h"
#include "server/http/api/handlers.h"
#include "server/http/api/lookup.h"
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
    std::string text = "# TYPE leafcutter_jobs gauge\n";
    for (const JobState state : {JobState::Queued, JobState::Computing, JobState::Ready,
                                 JobState::Done, JobState::Failed, JobState::Cancelled}) {
        text += fmt::format("leafcutter_jobs{{state=\"{}\"}} {}\n", to_string(state),
                            app.store().jobs.count(state));
    }
    text += "# TYPE leafcutter_cuts gauge\n";
    for (const CutState state :
         {CutState::Waiting, CutState::Cutting, CutState::Paused, CutState::AwaitingSheet,
          CutState::Done, CutState::Aborted, CutState::Failed, CutState::Interrupted}) {
        text += fmt::format("leafcutter_cuts{{state=\"{}\"}} {}\n", to_string(state),
                            app.store().cuts.count(state));
    }
    text += "# TYPE leafcutter_device_connected gauge\n";
    for (const auto& runner : app.fleet().all()) {
        const bool connected = runner->status().state != drivers::MachineState::Disconnected;
        text += fmt::format("leafcutter_device_connected{{device=\"{}\"}} {}\n",
                            runner->record().id, connected ? 1 : 0);
    }
    text += fmt::format("# TYPE leafcutter_event_clients gauge\nleafcutter_event_clients {}\n",
                        app.hub().clients());
    text += fmt::format("# TYPE leafcutter_event_seq counter\nleafcutter_event_seq {}\n",
                        app.store().events.last_seq());
    Response response;
    response.content_type = "text/plain; version=0.0.4";
    response.body = std::move(text);
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
