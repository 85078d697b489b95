#include "server/store/sql/named_records.h"

#include <fmt/format.h>

#include "server/store/sql/session.h"

namespace leafcutter::server {

namespace {

bool erase(SqlSession& session, const std::string& table, const std::string& id) {
    SqlStatement statement(session, fmt::format("DELETE FROM {} WHERE id = ?", table));
    statement.bind(1, id);
    return statement.run() > 0;
}

void insert(SqlSession& session, const std::string& table, const NamedRecord& record) {
    SqlStatement statement(session, fmt::format("INSERT INTO {}(id, record) VALUES(?, ?)", table));
    statement.bind(1, record.id);
    statement.bind(2, record.json);
    statement.run();
}

}  // namespace

std::vector<NamedRecord> SqlNamedRecords::list() const {
    std::vector<NamedRecord> records;
    database_.read([&](SqlSession& session) {
        SqlStatement query(session, fmt::format("SELECT id, record FROM {} ORDER BY id", table_));
        while (query.step()) {
            records.push_back({query.column(0).text(), query.column(1).text()});
        }
    });
    return records;
}

std::optional<NamedRecord> SqlNamedRecords::find(const std::string& id) const {
    std::optional<NamedRecord> record;
    database_.read([&](SqlSession& session) {
        SqlStatement query(session, fmt::format("SELECT id, record FROM {} WHERE id = ?", table_));
        query.bind(1, id);
        if (query.step()) {
            record = {query.column(0).text(), query.column(1).text()};
        }
    });
    return record;
}

bool SqlNamedRecords::put(const NamedRecord& record) {
    bool added = false;
    database_.write([&](SqlSession& session) {
        added = !erase(session, table_, record.id);
        insert(session, table_, record);
    });
    return added;
}

void SqlNamedRecords::put_all(const std::vector<NamedRecord>& records) {
    database_.write([&](SqlSession& session) {
        for (const NamedRecord& record : records) {
            erase(session, table_, record.id);
            insert(session, table_, record);
        }
    });
}

bool SqlNamedRecords::remove(const std::string& id) {
    bool removed = false;
    database_.write([&](SqlSession& session) { removed = erase(session, table_, id); });
    return removed;
}

}  // namespace leafcutter::server
