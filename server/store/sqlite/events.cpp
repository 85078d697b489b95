#include "server/store/sqlite/events.h"

#include <SQLiteCpp/SQLiteCpp.h>

#include "server/store/ids.h"
#include "server/store/sqlite/database.h"

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

std::int64_t SqliteEventLog::first_seq() const {
    std::int64_t first = 0;
    database_.read([&first](SQLite::Database& database) {
        first = database.execAndGet("SELECT coalesce(min(seq), 0) FROM event").getInt64();
    });
    return first;
}

std::int64_t SqliteEventLog::last_seq() const {
    std::int64_t last = 0;
    database_.read([&last](SQLite::Database& database) {
        SQLite::Statement query(
            database,
            "SELECT max((SELECT coalesce(max(seq), 0) FROM event), "
            "coalesce((SELECT seq FROM sqlite_sequence WHERE name = 'event'), 0))");
        last = query.executeStep() ? query.getColumn(0).getInt64() : 0;
    });
    return last;
}

int SqliteEventLog::forget(std::int64_t before_ms, int limit) {
    int forgotten = 0;
    database_.write([&](SQLite::Database& database) {
        // Clocks jump: what goes is a beginning of the log, up to the first young one.
        SQLite::Statement erase(
            database,
            "DELETE FROM event WHERE seq < coalesce((SELECT min(seq) FROM event WHERE "
            "at_ms >= ?1), (SELECT max(seq) FROM event)) AND seq < (SELECT min(seq) FROM event) "
            "+ ?2");
        erase.bind(1, before_ms);
        erase.bind(2, limit);
        forgotten = erase.exec();
    });
    return forgotten;
}

std::vector<EventRecord> SqliteEventLog::after(std::int64_t seq, int limit) const {
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
