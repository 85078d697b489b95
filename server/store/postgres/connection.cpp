#include "server/store/postgres/connection.h"

#include <array>
#include <libpq-fe.h>
#include <poll.h>
#include <utility>

#include <fmt/format.h>

namespace leafcutter::server {

namespace {

using Clock = std::chrono::steady_clock;

std::string first_line(const char* message) {
    const std::string_view text = message;
    return std::string(text.substr(0, text.find('\n')));
}

// False at the deadline.
bool wait_for(int socket, short events, Clock::time_point until) {
    while (true) {
        const auto left =
            std::chrono::duration_cast<std::chrono::milliseconds>(until - Clock::now()).count();
        pollfd watched{socket, events, 0};
        const int ready = ::poll(&watched, 1, left > 0 ? static_cast<int>(left) : 0);
        if (ready > 0) {
            return true;
        }
        if (left <= 0) {
            return false;
        }
    }
}

// A frozen client gives its locks back, a broken network shows itself, and a commit is on disk when
// it is answered, whatever the server's own settings.
constexpr const char* kSettings =
    "SET client_min_messages = warning;"
    "SET idle_in_transaction_session_timeout = '2s';"
    "SET statement_timeout = '30s';"
    "SET extra_float_digits = 1;"
    "SELECT set_config('synchronous_commit', 'on', false) "
    "WHERE current_setting('synchronous_commit') = 'off'";

pg_conn* begun_connection(const std::string& uri) {
    constexpr std::array<const char*, 8> kNames{
        "dbname",           "application_name", "keepalives_idle", "keepalives_interval",
        "keepalives_count", "tcp_user_timeout", "client_encoding", nullptr};
    const std::array<const char*, 8> values{uri.c_str(), "leafcutter", "5",    "2",
                                            "3",         "5000",       "UTF8", nullptr};
    return PQconnectStartParams(kNames.data(), values.data(), 1);
}

}  // namespace

PgRows::PgRows(pg_result* result) : result_(result) {}

PgRows::~PgRows() {
    PQclear(result_);
}

PgRows::PgRows(PgRows&& other) noexcept : result_(std::exchange(other.result_, nullptr)) {}

PgRows& PgRows::operator=(PgRows&& other) noexcept {
    std::swap(result_, other.result_);
    return *this;
}

int PgRows::size() const {
    return PQntuples(result_);
}

bool PgRows::is_null(int row, int column) const {
    return PQgetisnull(result_, row, column) != 0;
}

std::string_view PgRows::at(int row, int column) const {
    return {PQgetvalue(result_, row, column),
            static_cast<std::size_t>(PQgetlength(result_, row, column))};
}

int PgRows::changed() const {
    const std::string_view count = PQcmdTuples(result_);
    return count.empty() ? 0 : std::stoi(std::string(count));
}

PgConnection::PgConnection(const std::string& uri, std::chrono::milliseconds patience)
    : connection_(begun_connection(uri)), patience_(patience) {
    const Clock::time_point until = Clock::now() + patience_;
    try {
        PostgresPollingStatusType wanted = PGRES_POLLING_WRITING;
        while (wanted != PGRES_POLLING_OK) {
            if (PQstatus(connection_) == CONNECTION_BAD || wanted == PGRES_POLLING_FAILED) {
                fail_lost(first_line(PQerrorMessage(connection_)));
            }
            const short events = wanted == PGRES_POLLING_READING ? POLLIN : POLLOUT;
            if (!wait_for(PQsocket(connection_), events, until)) {
                fail_lost("the database does not answer");
            }
            wanted = PQconnectPoll(connection_);
        }
        PQsetnonblocking(connection_, 1);
        PQsetNoticeProcessor(
            connection_, [](void*, const char*) {}, nullptr);
        run(kSettings);
    } catch (...) {
        PQfinish(connection_);
        throw;
    }
}

PgConnection::~PgConnection() {
    PQfinish(connection_);
}

void PgConnection::fail_lost(const std::string& what) const {
    throw PgError(what.empty() ? "the connection to the database is lost" : what, "");
}

bool PgConnection::wait_readable(Clock::time_point until) const {
    return wait_for(PQsocket(connection_), POLLIN, until);
}

void PgConnection::flush(Clock::time_point until) const {
    while (true) {
        const int left = PQflush(connection_);
        if (left == 0) {
            return;
        }
        if (left < 0) {
            fail_lost(first_line(PQerrorMessage(connection_)));
        }
        if (!wait_for(PQsocket(connection_), POLLIN | POLLOUT, until)) {
            fail_lost("the database does not answer");
        }
        if (PQconsumeInput(connection_) == 0) {
            fail_lost(first_line(PQerrorMessage(connection_)));
        }
    }
}

// The last of the results that one call brings.
pg_result* PgConnection::answer() {
    const Clock::time_point until = Clock::now() + patience_;
    flush(until);
    pg_result* last = nullptr;
    while (true) {
        while (PQisBusy(connection_) != 0) {
            if (!wait_readable(until)) {
                PQclear(last);
                fail_lost("the database does not answer");
            }
            if (PQconsumeInput(connection_) == 0) {
                PQclear(last);
                fail_lost(first_line(PQerrorMessage(connection_)));
            }
        }
        pg_result* next = PQgetResult(connection_);
        if (next == nullptr) {
            break;
        }
        const bool failed_before = last != nullptr && PQresultStatus(last) == PGRES_FATAL_ERROR;
        PQclear(failed_before ? next : last);
        last = failed_before ? last : next;
    }
    if (last == nullptr || PQstatus(connection_) == CONNECTION_BAD) {
        PQclear(last);
        fail_lost(first_line(PQerrorMessage(connection_)));
    }
    if (PQresultStatus(last) == PGRES_FATAL_ERROR) {
        const char* state = PQresultErrorField(last, PG_DIAG_SQLSTATE);
        const std::string code = state == nullptr ? "" : state;
        const std::string what = first_line(PQresultErrorMessage(last));
        PQclear(last);
        throw PgError(what, code);
    }
    return last;
}

PgRows PgConnection::run(const std::string& sql) {
    if (PQsendQuery(connection_, sql.c_str()) == 0) {
        fail_lost(first_line(PQerrorMessage(connection_)));
    }
    return PgRows(answer());
}

PgRows PgConnection::run(const std::string& sql, const PgParameters& parameters) {
    const std::string name = fmt::format("s{:x}", std::hash<std::string>{}(sql));
    if (prepared_.count(name) == 0) {
        if (PQsendPrepare(connection_, name.c_str(), sql.c_str(), 0, nullptr) == 0) {
            fail_lost(first_line(PQerrorMessage(connection_)));
        }
        PQclear(answer());
        prepared_.insert(name);
    }
    std::vector<const char*> values;
    values.reserve(parameters.size());
    for (const auto& parameter : parameters) {
        values.push_back(parameter ? parameter->c_str() : nullptr);
    }
    if (PQsendQueryPrepared(connection_, name.c_str(), static_cast<int>(values.size()),
                            values.data(), nullptr, nullptr, 0) == 0) {
        fail_lost(first_line(PQerrorMessage(connection_)));
    }
    return PgRows(answer());
}

std::vector<PgNotice> PgConnection::notices(std::chrono::milliseconds wait) {
    std::vector<PgNotice> found;
    const Clock::time_point until = Clock::now() + wait;
    while (true) {
        while (PGnotify* notice = PQnotifies(connection_)) {
            found.push_back({notice->relname, notice->extra});
            PQfreemem(notice);
        }
        if (!found.empty() || !wait_readable(until)) {
            return found;
        }
        if (PQconsumeInput(connection_) == 0) {
            fail_lost(first_line(PQerrorMessage(connection_)));
        }
    }
}

std::string PgConnection::where() const {
    return fmt::format("{} on {}", PQdb(connection_), PQhost(connection_));
}

}  // namespace leafcutter::server
