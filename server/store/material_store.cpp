#include "server/store/material_store.h"

#include <SQLiteCpp/SQLiteCpp.h>

#include "server/store/database.h"

namespace leafcutter::server {

namespace {

bool erase(SQLite::Database& database, const std::string& id) {
    SQLite::Statement statement(database, "DELETE FROM material WHERE id = ?");
    statement.bind(1, id);
    return statement.exec() > 0;
}

}  // namespace

std::vector<std::string> MaterialStore::records() const {
    std::vector<std::string> records;
    database_.read([&records](SQLite::Database& database) {
        SQLite::Statement query(database, "SELECT record FROM material ORDER BY id");
        while (query.executeStep()) {
            records.push_back(query.getColumn(0).getString());
        }
    });
    return records;
}

bool MaterialStore::put(const std::string& id, const std::string& record_json) {
    bool added = false;
    database_.write([&](SQLite::Database& database) {
        added = !erase(database, id);
        SQLite::Statement insert(database, "INSERT INTO material(id, record) VALUES(?, ?)");
        insert.bind(1, id);
        insert.bind(2, record_json);
        insert.exec();
    });
    return added;
}

bool MaterialStore::remove(const std::string& id) {
    bool removed = false;
    database_.write([&](SQLite::Database& database) { removed = erase(database, id); });
    return removed;
}

}  // namespace leafcutter::server
