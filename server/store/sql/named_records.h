// Named records in SQL, one table for each kind.

#pragma once

#include <string>
#include <utility>
#include <vector>

#include "server/store/named_records.h"

namespace leafcutter::server {

class SqlDatabase;

class SqlNamedRecords final : public NamedRecords {
public:
    // The table has the columns id and record.
    SqlNamedRecords(SqlDatabase& database, std::string table)
        : database_(database), table_(std::move(table)) {}

    std::vector<NamedRecord> list() const override;
    std::optional<NamedRecord> find(const std::string& id) const override;
    bool put(const NamedRecord& record) override;
    void put_all(const std::vector<NamedRecord>& records) override;
    bool remove(const std::string& id) override;

private:
    SqlDatabase& database_;
    const std::string table_;
};

}  // namespace leafcutter::server
