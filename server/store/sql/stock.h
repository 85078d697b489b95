// Sheets and remnants in SQL.

#pragma once

#include "server/store/stock_store.h"

namespace leafcutter::server {

class SqlDatabase;
class SqlSession;

class SqlStockStore final : public StockStore {
public:
    explicit SqlStockStore(SqlDatabase& database) : database_(database) {}

    std::vector<StockRecord> list() const override;
    std::optional<StockRecord> find(const std::string& id) const override;
    bool put(const StockRecord& record) override;
    void put_all(const std::vector<StockRecord>& records) override;
    bool remove(const std::string& id) override;

private:
    SqlDatabase& database_;
};

// Within a transaction: books that a sheet of a job was cut. One of the stock it was planned on is
// gone, and its offcut is there; both or, for a sheet that knows neither, nothing.
void book_cut_sheet(SqlSession& session, const std::string& job, int sheet);

}  // namespace leafcutter::server
