#include "server/store/sql/events.h"

#include "server/store/sql/session.h"

namespace leafcutter::server {

void append_event(SqlSession& session, const EventRecord& event) {
    session.tell(event);
}

std::int64_t SqlEventLog::first_seq() const {
    std::int64_t first = 0;
    database_.read([&first](SqlSession& session) {
        first = number_in(session, "SELECT coalesce(min(seq), 0) FROM event");
    });
    return first;
}

std::int64_t SqlEventLog::last_seq() const {
    std::int64_t last = 0;
    database_.read([&last](SqlSession& session) { last = session.last_event(); });
    return last;
}

int SqlEventLog::forget(std::chrono::milliseconds age, int limit) {
    int forgotten = 0;
    database_.write([&](SqlSession& session) {
        // Clocks jump: what goes is a beginning of the log, up to the first young one.
        SqlStatement erase(
            session,
            "DELETE FROM event WHERE seq < coalesce((SELECT min(seq) FROM event WHERE "
            "at_ms >= ?1), (SELECT max(seq) FROM event)) AND seq < (SELECT min(seq) FROM event) "
            "+ ?2");
        erase.bind(1, session.now_ms() - age.count());
        erase.bind(2, limit);
        forgotten = erase.run();
    });
    return forgotten;
}

std::vector<EventRecord> SqlEventLog::after(std::int64_t seq, int limit) const {
    std::vector<EventRecord> events;
    database_.read([&](SqlSession& session) {
        SqlStatement query(session,
                           "SELECT seq, at_ms, type, subject, job, note FROM event "
                           "WHERE seq > ? ORDER BY seq LIMIT ?");
        query.bind(1, seq);
        query.bind(2, limit);
        while (query.step()) {
            events.push_back({query.column(0).int64(), query.column(1).int64(),
                              query.column(2).text(), query.column(3).text(),
                              query.column(4).text(), query.column(5).text()});
        }
    });
    return events;
}

}  // namespace leafcutter::server
