#include "server/store/sql/copy.h"

#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "server/store/blobs.h"
#include "server/store/sql/columns.h"
#include "server/store/sql/session.h"

namespace leafcutter::server {

namespace {

enum class Kind { Number, Real, Text };

struct Column {
    std::string name;
    Kind kind = Kind::Text;
};

std::vector<Column> columns_of(const SqlTable& table) {
    std::vector<Column> columns;
    std::string_view words = table.columns;
    while (!words.empty()) {
        const std::string_view word = words.substr(0, words.find(' '));
        words.remove_prefix(std::min(word.size() + 1, words.size()));
        const std::string_view kind = word.substr(word.find(':') + 1);
        columns.push_back(
            {std::string(word.substr(0, word.find(':'))), kind == "number" ? Kind::Number
                                                          : kind == "real" ? Kind::Real
                                                                           : Kind::Text});
    }
    return columns;
}

std::string names_of(const std::vector<Column>& columns) {
    std::vector<std::string> names;
    names.reserve(columns.size());
    for (const Column& column : columns) {
        names.push_back(column.name);
    }
    return fmt::format("{}", fmt::join(names, ", "));
}

std::string select_all(const SqlTable& table) {
    return fmt::format("SELECT {} FROM {} ORDER BY {}", names_of(columns_of(table)), table.name,
                       table.key);
}

void bind_as(SqlStatement& target, int parameter, const SqlColumn& value, Kind kind) {
    if (value.is_null()) {
        target.bind(parameter);
    } else if (kind == Kind::Number) {
        target.bind(parameter, value.int64());
    } else if (kind == Kind::Real) {
        target.bind(parameter, value.real());
    } else {
        target.bind(parameter, value.text());
    }
}

std::int64_t copy_table(SqlSession& from, SqlSession& to, const SqlTable& table) {
    const std::vector<Column> columns = columns_of(table);
    const std::vector<std::string> places(columns.size(), "?");
    SqlStatement query(from, select_all(table));
    SqlStatement insert(to, fmt::format("INSERT INTO {}({}) VALUES({})", table.name,
                                        names_of(columns), fmt::join(places, ", ")));
    std::int64_t rows = 0;
    for (; query.step(); ++rows) {
        for (std::size_t i = 0; i < columns.size(); ++i) {
            const int index = static_cast<int>(i);
            bind_as(insert, index + 1, query.column(index), columns[i].kind);
        }
        insert.run();
    }
    return rows;
}

// The digests of its rows, chained.
std::string digest_of(SqlSession& session, const SqlTable& table) {
    const std::vector<Column> columns = columns_of(table);
    SqlStatement query(session, select_all(table));
    std::string digest;
    while (query.step()) {
        std::string row = digest;
        for (std::size_t i = 0; i < columns.size(); ++i) {
            const SqlColumn value = query.column(static_cast<int>(i));
            const std::string text =
                value.is_null()                   ? "-"
                : columns[i].kind == Kind::Number ? fmt::format("{}", value.int64())
                : columns[i].kind == Kind::Real   ? fmt::format("{}", value.real())
                                                  : value.text();
            row +=
                fmt::format("{}:{};", value.is_null() ? -1 : static_cast<int>(text.size()), text);
        }
        digest = sha256_of(row);
    }
    return digest;
}

void check_empty(SqlSession& session) {
    for (const SqlTable& table : kSqlTables) {
        // A fresh database has the simulated machine and nothing else.
        const std::int64_t allowed = table.name == "device" ? 1 : 0;
        if (number_in(session, fmt::format("SELECT count(*) FROM {}", table.name)) > allowed) {
            throw CopyRefused(fmt::format(
                "the database to copy to is in use: its table {} has rows. Take an empty one",
                table.name));
        }
    }
    SqlStatement(session, "DELETE FROM device").run();
}

// Whoever held it does not exist where the rows go.
void free_leases(SqlSession& session) {
    SqlStatement(session,
                 "UPDATE job SET owner = '', lease_until_ms = CASE WHEN state = 'computing' THEN 1 "
                 "ELSE 0 END WHERE owner <> '' OR state = 'computing'")
        .run();
    SqlStatement(session, "UPDATE cut SET owner = '', fence = 0 WHERE owner <> ''").run();
    SqlStatement(session, "UPDATE device SET station = '' WHERE station <> ''").run();
}

}  // namespace

std::vector<CopiedTable> copy_all_rows(const SqlDatabase& from, SqlDatabase& to) {
    std::vector<CopiedTable> copied;
    to.write([&](SqlSession& target) {
        copied.clear();
        check_empty(target);
        from.read([&](SqlSession& source) {
            for (const SqlTable& table : kSqlTables) {
                copied.push_back({std::string(table.name), copy_table(source, target, table)});
                if (digest_of(source, table) != digest_of(target, table)) {
                    throw CopyRefused(fmt::format(
                        "the table {} reads back differently: nothing was kept", table.name));
                }
            }
        });
        free_leases(target);
        target.count_on();
    });
    return copied;
}

}  // namespace leafcutter::server
