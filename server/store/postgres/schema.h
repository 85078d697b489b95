// The tables in PostgreSQL and how older ones become today's.

#pragma once

namespace leafcutter::server {

class PgConnection;

int newest_pg_schema();

// Applies the missing migrations in one transaction, one process at a time. A database of the
// future is used as it is if its migrations say that this version may. Throws DatabaseUnusable
// otherwise; PgError.
void migrate(PgConnection& connection);

}  // namespace leafcutter::server
