// What an operator does before a cut's beam may come on, in order.

#pragma once

#include <nlohmann/json_fwd.hpp>

#include "server/store/records.h"

namespace leafcutter::server {

class App;

// A list; empty while there is nothing to do by hand. Each entry says whether it has to be done,
// and if the daemon knows, that it is.
nlohmann::json cut_steps(App& app, const CutRecord& cut);

}  // namespace leafcutter::server
