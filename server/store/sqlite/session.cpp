#include "server/store/sqlite/session.h"

#include <SQLiteCpp/SQLiteCpp.h>

#include "server/store/ids.h"

namespace leafcutter::server {

namespace {

class SqliteCursor final : public SqlCursor {
public:
    SqliteCursor(SQLite::Database& database, std::string_view text)
        : statement_(database, std::string(text)) {}

    void bind_null(int parameter) override { statement_.bind(parameter); }
    void bind_number(int parameter, std::int64_t value) override {
        statement_.bind(parameter, value);
    }
    void bind_real(int parameter, double value) override { statement_.bind(parameter, value); }
    void bind_text(int parameter, std::string_view value) override {
        statement_.bind(parameter, std::string(value));
    }

    bool step() override { return statement_.executeStep(); }
    int run() override {
        const int changed = statement_.exec();
        statement_.reset();
        return changed;
    }
    void reset() override { statement_.reset(); }

    bool is_null(int column) const override { return statement_.getColumn(column).isNull(); }
    std::int64_t number(int column) const override {
        return statement_.getColumn(column).getInt64();
    }
    double real(int column) const override { return statement_.getColumn(column).getDouble(); }
    std::string text(int column) const override { return statement_.getColumn(column).getString(); }

private:
    mutable SQLite::Statement statement_;  // Theirs has no const way to a column.
};

}  // namespace

std::unique_ptr<SqlCursor> SqliteSession::prepare(std::string_view text) {
    return std::make_unique<SqliteCursor>(database_, text);
}

std::int64_t SqliteSession::now_ms() {
    return wall_clock_ms();
}

void SqliteSession::tell(const EventRecord& event) {
    SqlStatement insert(*this,
                        "INSERT INTO event(at_ms, type, subject, job, note) VALUES(?, ?, ?, ?, ?)");
    insert.bind(1, now_ms());
    insert.bind(2, event.type);
    insert.bind(3, event.subject);
    insert.bind(4, event.job);
    insert.bind(5, event.note);
    insert.run();
}

std::int64_t SqliteSession::last_event() {
    return number_in(*this,
                     "SELECT max((SELECT coalesce(max(seq), 0) FROM event), "
                     "coalesce((SELECT seq FROM sqlite_sequence WHERE name = 'event'), 0))");
}

}  // namespace leafcutter::server
