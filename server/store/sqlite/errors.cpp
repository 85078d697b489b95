#include "server/store/sqlite/errors.h"

#include <sqlite3.h>

#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>

namespace leafcutter::server {

namespace {

constexpr int primary(int code) {
    return code & 0xff;
}

// The disk had no room for the index of the journal.
bool is_full(const SQLite::Exception& error) {
    return primary(error.getErrorCode()) == SQLITE_FULL ||
           error.getExtendedErrorCode() == SQLITE_IOERR_SHMSIZE;
}

StoreTrouble trouble_of(const SQLite::Exception& error) {
    if (is_full(error)) {
        return StoreTrouble::Full;
    }
    switch (primary(error.getErrorCode())) {
        case SQLITE_BUSY:
        case SQLITE_LOCKED:
        case SQLITE_PROTOCOL:
            return StoreTrouble::Busy;
        case SQLITE_READONLY:
            return StoreTrouble::ReadOnly;
        case SQLITE_CORRUPT:
        case SQLITE_NOTADB:
            return StoreTrouble::Damaged;
        default:
            return StoreTrouble::Failed;
    }
}

}  // namespace

StoreError store_error_of(const SQLite::Exception& error) {
    return {trouble_of(error),
            fmt::format("the database: {} ({})", error.what(), error.getExtendedErrorCode())};
}

bool is_fatal_for_writing(const SQLite::Exception& error) {
    const int code = primary(error.getErrorCode());
    return !is_full(error) &&
           (code == SQLITE_IOERR || code == SQLITE_CORRUPT || code == SQLITE_NOTADB);
}

}  // namespace leafcutter::server
