// Jobs, cuts and machines as clients see them: with the names of the calls allowed now, so that no
// page has to know the rules.

#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "server/http/event_hub.h"
#include "server/queue/device_runner.h"
#include "server/store/records.h"

namespace leafcutter::server {

class App;
struct Machine;

// As GET /queue.
nlohmann::json queue_json(App& app);

nlohmann::json job_json(App& app, const JobRecord& job);
// A job that has no mesh, and no pieces.
bool is_test_card(const JobRecord& job);

nlohmann::json cut_json(App& app, const CutRecord& cut);
nlohmann::json device_json(const DeviceRunner& runner);
nlohmann::json device_json(App& app, const Machine& machine);

// What other nodes have to know of something here, as JSON text of less than 8000 bytes.
std::optional<std::string> passing_view(App& app, const std::string& type, const std::string& id);

// Whether `action` ("start", "confirm-sheet", …) is among the cut's actions now.
bool cut_allows(App& app, const CutRecord& cut, const std::string& action);

// For the event hub.
std::vector<StoredEvent> stored_events(App& app, std::int64_t after, int limit);
std::optional<PassingEvent> passing_event(App& app, const std::string& type, const std::string& id);
std::string snapshot_event(App& app, std::int64_t seq, const std::optional<std::string>& job);

}  // namespace leafcutter::server
