#include "server/http/forward.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <memory>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "server/app.h"
#include "server/http/guard.h"
#include "server/http/json_body.h"
#include "server/http/problem.h"

namespace leafcutter::server {

namespace {

enum class Subject { Device, Cut };

struct MachineCall {
    std::string_view method;
    std::string_view pattern;
    Subject subject;
};

constexpr std::array kMachineCalls{
    MachineCall{"GET", "/api/v1/devices/{id}", Subject::Device},
    MachineCall{"PUT", "/api/v1/devices/{id}", Subject::Device},
    MachineCall{"DELETE", "/api/v1/devices/{id}", Subject::Device},
    MachineCall{"POST", "/api/v1/devices/{id}/commands", Subject::Device},
    MachineCall{"GET", "/api/v1/devices/{id}/settings", Subject::Device},
    MachineCall{"GET", "/api/v1/cuts/{id}", Subject::Cut},
    MachineCall{"POST", "/api/v1/cuts/{id}/start", Subject::Cut},
    MachineCall{"POST", "/api/v1/cuts/{id}/confirm-sheet", Subject::Cut},
    MachineCall{"POST", "/api/v1/cuts/{id}/pause", Subject::Cut},
    MachineCall{"POST", "/api/v1/cuts/{id}/resume", Subject::Cut},
    MachineCall{"POST", "/api/v1/cuts/{id}/finish", Subject::Cut},
    MachineCall{"POST", "/api/v1/cuts/{id}/abort", Subject::Cut},
};

// Reads the body, and lets it be read once more.
std::string body_of(Request& request) {
    // Shared with the reader that takes the body's place.
    auto whole = std::make_shared<const std::string>(read_body(request, kMostJsonBytes));
    auto at = std::make_shared<std::size_t>(0);
    request.body.read = [whole, at](std::span<char> room) {
        const std::size_t size = std::min(room.size(), whole->size() - *at);
        std::copy_n(whole->data() + *at, size, room.data());
        *at += size;
        return size;
    };
    return *whole;
}

// The station that the body names for a machine; empty if it names none.
std::string named_station(const std::string& body) {
    const nlohmann::json said = nlohmann::json::parse(body, nullptr, /*allow_exceptions=*/false);
    const auto station = said.is_object() ? said.find("station") : said.end();
    return said.is_object() && station != said.end() && station->is_string()
               ? station->get<std::string>()
               : "";
}

std::string station_of_device(App& app, const std::string& id) {
    if (app.fleet().find(id)) {
        return app.self()->id;
    }
    const auto device = app.store().devices.find(id);
    return device ? device->station : "";
}

struct Place {
    std::string station;
    bool can_wait = false;  // Without the station, this node's answer is as good.
};

Place place_of(App& app, Request& request, const MachineCall& call, const std::string& body) {
    const std::string& id = request.capture("id");
    const bool reads = call.method == "GET" && !call.pattern.ends_with("settings");
    if (call.subject == Subject::Device) {
        Place place{station_of_device(app, id), reads};
        if (call.method == "PUT" && place.station.empty()) {
            const std::string named = named_station(body);
            place.station = named;
            if (named.empty() && !cuts(app.self()->role)) {
                throw HttpProblem(422, "bad-field",
                                  "station: name the node on which the machine hangs");
            }
        }
        return place;
    }
    const auto cut = app.store().cuts.find(id);
    if (!cut) {
        return {};
    }
    const bool lies_there =
        cut->state == CutState::Waiting || cut->state == CutState::AwaitingSheet;
    return {station_of_device(app, cut->device),
            reads || (call.pattern.ends_with("abort") && lies_there)};
}

Response response_of(PeerAnswer answer) {
    Response response;
    response.status = answer.status;
    response.content_type = std::move(answer.content_type);
    response.body = std::move(answer.body);
    if (!answer.etag.empty()) {
        response.headers["ETag"] = std::move(answer.etag);
    }
    return response;
}

std::optional<PeerAnswer> asked(App& app,
                                const Request& request,
                                const std::string& station,
                                const std::string& body) {
    const auto node = app.peers().living(station);
    if (!node) {
        return std::nullopt;
    }
    PeerCall call;
    call.method = request.method;
    call.path = request.path;
    call.body = body;
    call.caller = request.caller.name;
    call.role = to_string(request.caller.role);
    call.may_fire = request.caller.may_fire;
    for (const char* name : {"if-match", "if-none-match"}) {
        if (const auto value = request.header(name)) {
            call.headers[name] = *value;
        }
    }
    return app.peers().call(*node, call);
}

}  // namespace

std::optional<Response> answer_elsewhere(App& app, Request& request, std::string_view pattern) {
    if (app.self() == nullptr || is_from_peer(request, app.peers().key())) {
        return std::nullopt;
    }
    const auto* const call =
        std::find_if(kMachineCalls.begin(), kMachineCalls.end(), [&](const MachineCall& each) {
            return each.pattern == pattern &&
                   each.method == (request.method == "HEAD" ? "GET" : request.method);
        });
    if (call == kMachineCalls.end()) {
        return std::nullopt;
    }
    const std::string body = is_unsafe(request) ? body_of(request) : "";
    const Place place = place_of(app, request, *call, body);
    if (place.station.empty() || place.station == app.self()->id) {
        return std::nullopt;
    }
    if (auto answer = asked(app, request, place.station, body)) {
        return response_of(*std::move(answer));
    }
    if (place.can_wait) {
        return std::nullopt;
    }
    throw HttpProblem(503, "station-silent",
                      fmt::format("the station {} does not answer: go to the machine, and use its "
                                  "own switches",
                                  place.station));
}

}  // namespace leafcutter::server
