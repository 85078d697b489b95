// The engine for many machines: PostgreSQL, shared by all nodes of a fleet.

#pragma once

#include <memory>
#include <string>

#include "server/store/engine.h"
#include "server/store/postgres/database.h"

namespace leafcutter::server {

// `uri` is "postgresql://user@host/database" or what else libpq takes. Throws DatabaseUnusable.
OpenedEngine open_postgres(const std::string& uri, const NodeScope& scope, PgHooks hooks);

}  // namespace leafcutter::server
