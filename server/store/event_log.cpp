#include "server/store/event_log.h"

#include <SQLiteCpp/SQLiteCpp.h>

#include "server/store/database.h"
#include "server/store/ids.h"

namespace leafcutter::server {

void append_event(SQLite::Database& database, const EventRecord& event) {
    SQLite::Statement insert(
        database, "INSERT INTO event(at_ms, type, subject, job, note) VALUES(?, ?, ?, ?, ?)");
    insert.bind(1, wall_clock_ms());
    insert.bind(2, event.type);
    insert.bind(3, event.subject);
    insert.bind(4, event.job);
    insert.bind(5, event.note);
    insert.exec();
}

std::int64_t EventLog::last_seq() const {
    std::int64_t last = 0;
    database_.read([&last](SQLite::Database& database) {
        last = database.execAndGet("SELECT coalesce(max(seq), 0) FROM event").getInt64();
    });
    return last;
}

std::vector<EventRecord> EventLog::after(std::int64_t seq, int limit) const {
    std::vector<EventRecord> events;
    database_.read([&](SQLite::Database& database) {
        SQLite::Statement query(database,
                                "SELECT seq, at_ms, type, subject, job, note FROM event "
                                "WHERE seq > ? ORDER BY seq LIMIT ?");
        query.bind(1, seq);
        query.bind(2, limit);
        while (query.executeStep()) {
            events.push_back({query.getColumn(0).getInt64(), query.getColumn(1).getInt64(),
                              query.getColumn(2).getString(), query.getColumn(3).getString(),
                              query.getColumn(4).getString(), query.getColumn(5).getString()});
        }
    });
    return events;
}

}  // namespace leafcutter::server
