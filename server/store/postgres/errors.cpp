#include "server/store/postgres/errors.h"

#include <fmt/format.h>

namespace leafcutter::server {

namespace {

StoreTrouble trouble_of(const PgError& error) {
    const std::string& state = error.sql_state();
    // Lost; or the server goes down, refuses more connections or a lock, or it was too slow.
    if (error.is_lost() || state.starts_with("08") || state.starts_with("57") ||
        state.starts_with("55") || state == "25P03" || state == "53300" || is_conflict(error)) {
        return StoreTrouble::Busy;
    }
    if (state == "53100") {
        return StoreTrouble::Full;
    }
    if (state == "25006") {
        return StoreTrouble::ReadOnly;
    }
    return state.starts_with("XX") ? StoreTrouble::Damaged : StoreTrouble::Failed;
}

}  // namespace

bool is_conflict(const PgError& error) {
    return error.sql_state() == "40001" || error.sql_state() == "40P01";
}

StoreError store_error_of(const PgError& error) {
    const std::string code = error.is_lost() ? "" : fmt::format(" ({})", error.sql_state());
    return {trouble_of(error), fmt::format("the database: {}{}", error.what(), code)};
}

}  // namespace leafcutter::server
