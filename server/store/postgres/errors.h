// PostgreSQL's errors in the store's own words.

#pragma once

#include "server/store/postgres/connection.h"
#include "server/store/store_error.h"

namespace leafcutter::server {

StoreError store_error_of(const PgError& error);

// Two transactions stood in each other's way: the same once more may do.
bool is_conflict(const PgError& error);

}  // namespace leafcutter::server
