// A connection to PostgreSQL that never waits longer than it was told to: a server that is frozen,
// or behind a broken network, is one that is lost.

#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

struct pg_conn;
struct pg_result;

namespace leafcutter::server {

// What the server, or the way to it, refused.
class PgError : public std::runtime_error {
public:
    PgError(const std::string& what, std::string sql_state)
        : std::runtime_error(what), sql_state_(std::move(sql_state)) {}

    // The connection is of no more use, and whether the last commit was done is not known.
    bool is_lost() const { return sql_state_.empty(); }
    const std::string& sql_state() const { return sql_state_; }

private:
    std::string sql_state_;  // Five letters of the server's; empty: it did not answer.
};

using PgParameters = std::vector<std::optional<std::string>>;

// The rows of one answer.
class PgRows {
public:
    explicit PgRows(pg_result* result);
    ~PgRows();
    PgRows(PgRows&& other) noexcept;
    PgRows& operator=(PgRows&& other) noexcept;

    int size() const;
    bool is_null(int row, int column) const;
    std::string_view at(int row, int column) const;

    // Rows that a statement without an answer changed.
    int changed() const;

private:
    pg_result* result_;
};

struct PgNotice {
    std::string channel;
    std::string payload;
};

class PgConnection {
public:
    // `uri` as libpq takes it. Throws PgError.
    PgConnection(const std::string& uri, std::chrono::milliseconds patience);
    ~PgConnection();
    PgConnection(const PgConnection&) = delete;
    PgConnection& operator=(const PgConnection&) = delete;

    // One statement or several, without parameters; the rows of the last. Throws PgError.
    PgRows run(const std::string& sql);

    // With $1, $2…; prepared once. Throws PgError.
    PgRows run(const std::string& sql, const PgParameters& parameters);

    // What LISTENing brought, after at most `wait`. Throws PgError.
    std::vector<PgNotice> notices(std::chrono::milliseconds wait);

    // For people; never the password.
    std::string where() const;

private:
    pg_result* answer();
    bool wait_readable(std::chrono::steady_clock::time_point until) const;
    void flush(std::chrono::steady_clock::time_point until) const;
    [[noreturn]] void fail_lost(const std::string& what) const;

    pg_conn* connection_;
    const std::chrono::milliseconds patience_;
    std::set<std::string> prepared_;
};

}  // namespace leafcutter::server
