// Named records in SQLite, one table for each kind.

#pragma once

#include <string>
#include <utility>
#include <vector>

#include "server/store/named_records.h"

namespace leafcutter::server {

class Database;

class SqliteNamedRecords final : public NamedRecords {
public:
    // The table has the columns id and record.
    SqliteNamedRecords(Database& database, std::string table)
        : database_(database), table_(std::move(table)) {}

    std::vector<NamedRecord> list() const override;
    std::optional<NamedRecord> find(const std::string& id) const override;
    bool put(const NamedRecord& record) override;
    void put_all(const std::vector<NamedRecord>& records) override;
    bool remove(const std::string& id) override;

private:
    Database& database_;
    const std::string table_;
};

}  // namespace leafcutter::server
