#include "server/store/postgres/session.h"

#include <charconv>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "server/store/sql/columns.h"

namespace leafcutter::server {

namespace {

class PgCursor final : public SqlCursor {
public:
    PgCursor(PgConnection& connection, std::string_view text)
        : connection_(connection), text_(with_numbered_parameters(text)) {}

    void bind_null(int parameter) override { place(parameter) = std::nullopt; }
    void bind_number(int parameter, std::int64_t value) override {
        place(parameter) = std::to_string(value);
    }
    void bind_real(int parameter, double value) override {
        place(parameter) = fmt::format("{}", value);  // The shortest that reads back the same.
    }
    void bind_text(int parameter, std::string_view value) override {
        // PostgreSQL's text has no NUL; what comes after one in a file's name is of no use.
        place(parameter) = std::string(value.substr(0, value.find('\0')));
    }

    bool step() override {
        if (!rows_) {
            rows_ = connection_.run(text_, parameters_);
            row_ = -1;
        }
        return ++row_ < rows_->size();
    }
    int run() override { return connection_.run(text_, parameters_).changed(); }
    void reset() override { rows_.reset(); }

    bool is_null(int column) const override { return rows().is_null(row_, column); }
    std::int64_t number(int column) const override {
        const std::string_view text = rows().at(row_, column);
        if (text == "t" || text == "f") {
            return text == "t" ? 1 : 0;
        }
        std::int64_t value = 0;
        std::from_chars(text.data(), text.data() + text.size(), value);
        return value;
    }
    double real(int column) const override {
        const std::string_view text = rows().at(row_, column);
        double value = 0.0;
        std::from_chars(text.data(), text.data() + text.size(), value);
        return value;
    }
    std::string text(int column) const override { return std::string(rows().at(row_, column)); }

private:
    std::optional<std::string>& place(int parameter) {
        const auto index = static_cast<std::size_t>(parameter);
        if (parameters_.size() < index) {
            parameters_.resize(index);
        }
        return parameters_[index - 1];
    }
    const PgRows& rows() const { return rows_.value(); }

    PgConnection& connection_;
    const std::string text_;
    PgParameters parameters_;
    std::optional<PgRows> rows_;
    int row_ = -1;
};

}  // namespace

std::string with_numbered_parameters(std::string_view text) {
    std::string result;
    int next = 1;
    bool quoted = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        quoted = quoted != (text[i] == '\'');
        if (text[i] != '?' || quoted) {
            result += text[i];
            continue;
        }
        const bool numbered = i + 1 < text.size() && text[i + 1] >= '1' && text[i + 1] <= '9';
        result += numbered ? std::string("$") : fmt::format("${}", next++);
    }
    return result;
}

std::unique_ptr<SqlCursor> PgSession::prepare(std::string_view text) {
    return std::make_unique<PgCursor>(connection_, text);
}

std::int64_t PgSession::now_ms() {
    if (!now_ms_) {
        now_ms_ =
            number_in(*this, "SELECT CAST(extract(epoch FROM clock_timestamp()) * 1000 AS bigint)");
    }
    return *now_ms_;
}

std::int64_t PgSession::last_event() {
    return number_in(*this, "SELECT last FROM event_counter");
}

void PgSession::count_on() {
    for (const SqlTable& table : kSqlTables) {
        if (!table.counted.empty()) {
            connection_.run(fmt::format(
                "SELECT setval(pg_get_serial_sequence('{0}', '{1}'), coalesce(max({1}), 0) + 1, "
                "false) FROM {0}",
                table.name, table.counted));
        }
    }
    connection_.run("UPDATE event_counter SET last = (SELECT coalesce(max(seq), 0) FROM event)");
}

bool PgSession::write_events() {
    if (events_.empty()) {
        return false;
    }
    const auto count = static_cast<std::int64_t>(events_.size());
    std::string rows;
    PgParameters parameters{std::to_string(count), std::to_string(now_ms())};
    for (std::size_t i = 0; i < events_.size(); ++i) {
        const std::size_t first = parameters.size() + 1;
        rows += fmt::format("{}({}::bigint, ${}::text, ${}::text, ${}::text, ${}::text)",
                            i == 0 ? "" : ", ", i + 1, first, first + 1, first + 2, first + 3);
        for (const std::string* text :
             {&events_[i].type, &events_[i].subject, &events_[i].job, &events_[i].note}) {
            parameters.emplace_back(text->substr(0, text->find('\0')));
        }
    }
    connection_.run(
        fmt::format("WITH counted AS (UPDATE event_counter SET last = last + $1 RETURNING last) "
                    "INSERT INTO event(seq, at_ms, type, subject, job, note) "
                    "SELECT counted.last - $1 + told.place, $2::bigint, told.type, told.subject, "
                    "told.job, told.note FROM counted, (VALUES {}) AS "
                    "told(place, type, subject, job, note)",
                    rows),
        parameters);
    events_.clear();
    return true;
}

}  // namespace leafcutter::server
