// The event log in SQLite.

#pragma once

#include "server/store/event_log.h"

namespace SQLite {  // NOLINT(readability-identifier-naming): theirs
class Database;
}

namespace leafcutter::server {

class Database;

// Within a writer's transaction.
void append_event(SQLite::Database& database, const EventRecord& event);

class SqliteEventLog final : public EventLog {
public:
    explicit SqliteEventLog(Database& database) : database_(database) {}

    std::int64_t first_seq() const override;
    std::int64_t last_seq() const override;
    std::vector<EventRecord> after(std::int64_t seq, int limit) const override;
    int forget(std::int64_t before_ms, int limit) override;

private:
    Database& database_;
};

}  // namespace leafcutter::server
