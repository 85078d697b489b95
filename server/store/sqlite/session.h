// A connection to SQLite as the stores see it.

#pragma once

#include "server/store/sql/session.h"

namespace SQLite {  // NOLINT(readability-identifier-naming): theirs
class Database;
}

namespace leafcutter::server {

class SqliteSession final : public SqlSession {
public:
    explicit SqliteSession(SQLite::Database& database) : database_(database) {}

    std::unique_ptr<SqlCursor> prepare(std::string_view text) override;
    std::int64_t now_ms() override;
    void tell(const EventRecord& event) override;
    std::int64_t last_event() override;
    void count_on() override {}  // It always does.
    std::string_view for_update_of_free_rows() const override { return {}; }

private:
    SQLite::Database& database_;
};

}  // namespace leafcutter::server
