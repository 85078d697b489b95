// The tables and how older ones become today's.

#pragma once

#include <stdexcept>

namespace SQLite {  // NOLINT(readability-identifier-naming): theirs
class Database;
}

namespace leafcutter::server {

// The database can't be used: damaged, or written by a newer Leafcutter.
class DatabaseUnusable : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

// Sets the connection up for durable writing and applies the missing migrations, each in one
// transaction. Throws DatabaseUnusable.
void prepare_schema(SQLite::Database& database);

}  // namespace leafcutter::server
