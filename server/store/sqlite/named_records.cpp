#include "server/store/sqlite/named_records.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>

#include "server/store/sqlite/database.h"

namespace leafcutter::server {

namespace {

bool erase(SQLite::Database& database, const std::string& table, const std::string& id) {
    SQLite::Statement statement(database, fmt::format("DELETE FROM {} WHERE id = ?", table));
    statement.bind(1, id);
    return statement.exec() > 0;
}

void insert(SQLite::Database& database, const std::string& table, const NamedRecord& record) {
    SQLite::Statement statement(database,
                                fmt::format("INSERT INTO {}(id, record) VALUES(?, ?)", table));
    statement.bind(1, record.id);
    statement.bind(2, record.json);
    statement.exec();
}

}  // namespace

std::vector<NamedRecord> SqliteNamedRecords::list() const {
    std::vector<NamedRecord> records;
    database_.read([&](SQLite::Database& database) {
        SQLite::Statement query(database,
                                fmt::format("SELECT id, record FROM {} ORDER BY id", table_));
        while (query.executeStep()) {
            records.push_back({query.getColumn(0).getString(), query.getColumn(1).getString()});
        }
    });
    return records;
}

std::optional<NamedRecord> SqliteNamedRecords::find(const std::string& id) const {
    std::optional<NamedRecord> record;
    database_.read([&](SQLite::Database& database) {
        SQLite::Statement query(database,
                                fmt::format("SELECT id, record FROM {} WHERE id = ?", table_));
        query.bind(1, id);
        if (query.executeStep()) {
            record = {query.getColumn(0).getString(), query.getColumn(1).getString()};
        }
    });
    return record;
}

bool SqliteNamedRecords::put(const NamedRecord& record) {
    bool added = false;
    database_.write([&](SQLite::Database& database) {
        added = !erase(database, table_, record.id);
        insert(database, table_, record);
    });
    return added;
}

void SqliteNamedRecords::put_all(const std::vector<NamedRecord>& records) {
    database_.write([&](SQLite::Database& database) {
        for (const NamedRecord& record : records) {
            erase(database, table_, record.id);
            insert(database, table_, record);
        }
    });
}

bool SqliteNamedRecords::remove(const std::string& id) {
    bool removed = false;
    database_.write([&](SQLite::Database& database) { removed = erase(database, table_, id); });
    return removed;
}

}  // namespace leafcutter::server
