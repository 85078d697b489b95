// What SQLite's errors mean to those who know no SQLite.

#pragma once

#include "server/store/store_error.h"

namespace SQLite {  // NOLINT(readability-identifier-naming): theirs
class Exception;
}

namespace leafcutter::server {

StoreError store_error_of(const SQLite::Exception& error);

// After it nothing that was written can be trusted to be on disk: a sync that failed once may well
// "succeed" when it is tried again, with the data gone.
bool is_fatal_for_writing(const SQLite::Exception& error);

}  // namespace leafcutter::server
