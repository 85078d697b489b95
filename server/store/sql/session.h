// What the stores ask of a database: statements inside a transaction, in the SQL that SQLite and
// PostgreSQL both speak. Each engine is one implementation of these classes.

#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "server/store/records.h"

namespace leafcutter::server {

// A statement of an engine. Parameters count from 1, columns from 0. All throw what their engine
// throws; SqlDatabase makes StoreErrors of it.
class SqlCursor {
public:
    virtual ~SqlCursor() = default;

    virtual void bind_null(int parameter) = 0;
    virtual void bind_number(int parameter, std::int64_t value) = 0;
    virtual void bind_real(int parameter, double value) = 0;
    virtual void bind_text(int parameter, std::string_view value) = 0;

    // The next row, if there is one.
    virtual bool step() = 0;

    // For statements without rows; returns how many rows they changed. May be repeated.
    virtual int run() = 0;

    // To begin again; what is bound stays bound.
    virtual void reset() = 0;

    virtual bool is_null(int column) const = 0;
    virtual std::int64_t number(int column) const = 0;
    virtual double real(int column) const = 0;
    virtual std::string text(int column) const = 0;
};

// One transaction on one connection, as the work inside it sees it.
class SqlSession {
public:
    virtual ~SqlSession() = default;

    // `text` has ? or ?N for its parameters.
    virtual std::unique_ptr<SqlCursor> prepare(std::string_view text) = 0;

    // Milliseconds since 1970 by the one clock of all who share the database.
    virtual std::int64_t now_ms() = 0;

    // Puts an event into the log with the transaction. Its number and time are given there.
    virtual void tell(const EventRecord& event) = 0;

    // The newest number ever given to an event; 0: none.
    virtual std::int64_t last_event() = 0;

    // Rows were put in with numbers of their own: the next ones count on from the greatest.
    virtual void count_on() = 0;

    // What makes a SELECT take its row for this transaction and pass by those that others took.
    virtual std::string_view for_update_of_free_rows() const = 0;
};

// A value of the current row.
class SqlColumn {
public:
    SqlColumn(const SqlCursor& cursor, int index) : cursor_(cursor), index_(index) {}

    bool is_null() const { return cursor_.is_null(index_); }
    int integer() const { return static_cast<int>(cursor_.number(index_)); }
    std::int64_t int64() const { return cursor_.number(index_); }
    double real() const { return cursor_.real(index_); }
    std::string text() const { return cursor_.text(index_); }

private:
    const SqlCursor& cursor_;
    int index_;
};

class SqlStatement {
public:
    SqlStatement(SqlSession& session, std::string_view text) : cursor_(session.prepare(text)) {}

    void bind(int parameter) { cursor_->bind_null(parameter); }
    void bind(int parameter, int value) { cursor_->bind_number(parameter, value); }
    void bind(int parameter, std::int64_t value) { cursor_->bind_number(parameter, value); }
    void bind(int parameter, double value) { cursor_->bind_real(parameter, value); }
    void bind(int parameter, std::string_view value) { cursor_->bind_text(parameter, value); }

    bool step() { return cursor_->step(); }
    int run() { return cursor_->run(); }
    void reset() { cursor_->reset(); }
    SqlColumn column(int index) const { return {*cursor_, index}; }

private:
    std::unique_ptr<SqlCursor> cursor_;
};

// The first number of the first row; 0 if there is none.
inline std::int64_t number_in(SqlSession& session, std::string_view query) {
    SqlStatement statement(session, query);
    return statement.step() ? statement.column(0).int64() : 0;
}

// Whether work that writes may run beside that of other processes. Beside: it takes only rows that
// nobody else changes at the same time, each by a compare-and-set.
enum class WriteOrder { Alone, Beside };

class SqlDatabase {
public:
    using Work = std::function<void(SqlSession&)>;

    virtual ~SqlDatabase() = default;

    // Returns when `work` is on disk; throws what it threw, with nothing of it done. It may be run
    // twice: the first time without effect. Throws StoreError.
    virtual void write(const Work& work, WriteOrder order) = 0;
    void write(const Work& work) { write(work, WriteOrder::Alone); }

    // For what may be lost: returns at once where writing would have to wait for a network. Only
    // the newest work of a `key` counts.
    virtual void write_soon(const std::string& key, const Work& work) = 0;

    // Runs `work` in one consistent view that changes nothing. Throws StoreError.
    virtual void read(const Work& work) const = 0;
};

}  // namespace leafcutter::server
