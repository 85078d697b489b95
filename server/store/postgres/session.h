// A transaction in PostgreSQL as the stores see it.

#pragma once

#include <optional>
#include <vector>

#include "server/store/postgres/connection.h"
#include "server/store/sql/session.h"

namespace leafcutter::server {

class PgSession final : public SqlSession {
public:
    explicit PgSession(PgConnection& connection) : connection_(connection) {}

    std::unique_ptr<SqlCursor> prepare(std::string_view text) override;
    std::int64_t now_ms() override;

    // Kept back until write_events(): numbers without gaps need a lock that is best held shortly.
    void tell(const EventRecord& event) override { events_.push_back(event); }
    std::int64_t last_event() override;
    void count_on() override;
    std::string_view for_update_of_free_rows() const override { return "FOR UPDATE SKIP LOCKED"; }

    // The last thing in a transaction; wakes who listens. True if there were any.
    bool write_events();

    // For work that was undone: forgets what it told.
    std::size_t events() const { return events_.size(); }
    void forget_events_after(std::size_t count) { events_.resize(count); }

private:
    PgConnection& connection_;
    std::optional<std::int64_t> now_ms_;
    std::vector<EventRecord> events_;
};

// The channel on which a new event is announced.
constexpr const char* kEventChannel = "leafcutter_events";

// "… = ? AND … = ?2" -> "… = $1 AND … = $2", leaving quoted text alone.
std::string with_numbered_parameters(std::string_view text);

}  // namespace leafcutter::server
