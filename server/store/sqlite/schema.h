// The tables and how older ones become today's.

#pragma once

#include <string>

namespace SQLite {  // NOLINT(readability-identifier-naming): theirs
class Database;
}

namespace leafcutter::server {

// Sets a connection up for durable writing.
void prepare_connection(SQLite::Database& database);

int schema_version(SQLite::Database& database);
int newest_schema();

// What is wrong with the file; empty: nothing. Reads all of it.
std::string quick_check(SQLite::Database& database);

// Applies the missing migrations, each in one transaction. Throws DatabaseUnusable for a database
// of the future.
void migrate(SQLite::Database& database);

}  // namespace leafcutter::server
