// What most handlers begin and end with.

#pragma once

#include <cstdint>
#include <optional>

#include <nlohmann/json_fwd.hpp>

#include "server/http/request.h"
#include "server/http/response.h"
#include "server/store/records.h"

namespace leafcutter::server {

class App;
class DeviceRunner;

Response json_response(const nlohmann::json& value, int status = 200);

// Which part of a list is wanted: ?limit= (50 unless told, 200 at most) and ?cursor=, which is the
// `next_cursor` of the page before.
struct Page {
    int limit = 50;
    std::optional<std::int64_t> cursor;
};

// Throw HttpProblem (400).
Page page_in(const Request& request);
int limit_in(const Request& request);

// Of the route's {id}. Throws HttpProblem (404).
JobRecord find_job(App& app, const Request& request);
CutRecord find_cut(App& app, const Request& request);

// A machine of this node, or one that the fleet has elsewhere.
struct Machine {
    DeviceRecord record;
    std::shared_ptr<DeviceRunner>
        runner;  // Null: it hangs on another node. Shared as DeviceFleet's.
    bool connected = false;
};
std::optional<Machine> find_machine(App& app, const std::string& id);
std::vector<Machine> all_machines(App& app);  // By id.

}  // namespace leafcutter::server
