// The append-only log of what happened to jobs and cuts. A row is written in the transaction of the
// change it tells of, so the numbers have no gaps.

#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "server/store/records.h"

namespace SQLite {  // NOLINT(readability-identifier-naming): theirs
class Database;
}

namespace leafcutter::server {

class Database;

// Within a writer's transaction.
void append_event(SQLite::Database& database, const EventRecord& event);

class EventLog {
public:
    explicit EventLog(Database& database) : database_(database) {}

    std::int64_t last_seq() const;
    std::vector<EventRecord> after(std::int64_t seq, int limit) const;

private:
    Database& database_;
};

}  // namespace leafcutter::server
