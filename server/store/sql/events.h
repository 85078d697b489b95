// The event log in SQL.

#pragma once

#include "server/store/event_log.h"

namespace leafcutter::server {

class SqlDatabase;
class SqlSession;

// Within a writer's transaction.
void append_event(SqlSession& session, const EventRecord& event);

class SqlEventLog final : public EventLog {
public:
    explicit SqlEventLog(SqlDatabase& database) : database_(database) {}

    std::int64_t first_seq() const override;
    std::int64_t last_seq() const override;
    std::vector<EventRecord> after(std::int64_t seq, int limit) const override;
    int forget(std::chrono::milliseconds age, int limit) override;

private:
    SqlDatabase& database_;
};

}  // namespace leafcutter::server
