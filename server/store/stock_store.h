// Sheets and remnants at hand. What a cut takes and what it leaves is booked with the sheet that is
// done, in one transaction: see CutStore::finish_sheet().

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/store/records.h"

namespace leafcutter::server {

class StockStore {
public:
    virtual ~StockStore() = default;

    // By id.
    virtual std::vector<StockRecord> list() const = 0;
    virtual std::optional<StockRecord> find(const std::string& id) const = 0;

    // True if there was none of that id. Sets neither times nor `planned`.
    virtual bool put(const StockRecord& record) = 0;

    // All or, if one fails, none.
    virtual void put_all(const std::vector<StockRecord>& records) = 0;

    // False if there is none.
    virtual bool remove(const std::string& id) = 0;
};

}  // namespace leafcutter::server
