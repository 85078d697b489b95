#include "server/store/sqlite/stock.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>

#include "server/store/ids.h"
#include "server/store/sqlite/database.h"
#include "server/store/sqlite/events.h"

namespace leafcutter::server {

namespace {

constexpr const char* kSelectStock =
    "SELECT id, record, material, quantity, note, from_job, from_sheet, created_ms, updated_ms, "
    "(SELECT count(*) FROM sheet JOIN job ON job.id = sheet.job WHERE sheet.stock = stock.id AND "
    "sheet.stock <> '' AND sheet.cut = 0 AND job.state = 'ready') FROM stock ";

StockRecord stock_from(SQLite::Statement& row) {
    StockRecord stock;
    stock.id = row.getColumn(0).getString();
    stock.json = row.getColumn(1).getString();
    stock.material = row.getColumn(2).getString();
    if (!row.getColumn(3).isNull()) {
        stock.quantity = row.getColumn(3).getInt();
    }
    stock.note = row.getColumn(4).getString();
    stock.from_job = row.getColumn(5).getString();
    stock.from_sheet = row.getColumn(6).getInt();
    stock.created_ms = row.getColumn(7).getInt64();
    stock.updated_ms = row.getColumn(8).getInt64();
    stock.planned = row.getColumn(9).getInt();
    return stock;
}

std::optional<StockRecord> find_stock(SQLite::Database& database, const std::string& id) {
    SQLite::Statement query(database, fmt::format("{}WHERE id = ?", kSelectStock));
    query.bind(1, id);
    return query.executeStep() ? std::optional(stock_from(query)) : std::nullopt;
}

void tell_stock(SQLite::Database& database, const std::string& id, std::string note) {
    EventRecord event;
    event.type = "stock";
    event.subject = id;
    event.note = std::move(note);
    append_event(database, event);
}

bool put_stock(SQLite::Database& database, const StockRecord& stock) {
    const auto old = find_stock(database, stock.id);
    const std::int64_t now = wall_clock_ms();
    SQLite::Statement upsert(
        database,
        "INSERT OR REPLACE INTO stock(id, record, material, quantity, note, from_job, from_sheet, "
        "created_ms, updated_ms) VALUES(?, ?, ?, ?, ?, ?, ?, ?, ?)");
    upsert.bind(1, stock.id);
    upsert.bind(2, stock.json);
    upsert.bind(3, stock.material);
    if (stock.quantity) {
        upsert.bind(4, *stock.quantity);
    } else {
        upsert.bind(4);
    }
    upsert.bind(5, stock.note);
    upsert.bind(6, stock.from_job);
    upsert.bind(7, stock.from_sheet);
    upsert.bind(8, old ? old->created_ms : now);
    upsert.bind(9, now);
    upsert.exec();
    tell_stock(database, stock.id, old ? "changed" : "added");
    return !old;
}

bool remove_stock(SQLite::Database& database, const std::string& id) {
    SQLite::Statement erase(database, "DELETE FROM stock WHERE id = ?");
    erase.bind(1, id);
    const bool removed = erase.exec() > 0;
    if (removed) {
        tell_stock(database, id, "removed");
    }
    return removed;
}

void take_one(SQLite::Database& database, const std::string& id) {
    auto stock = find_stock(database, id);
    if (!stock || !stock->quantity) {
        return;
    }
    --*stock->quantity;
    if (*stock->quantity <= 0) {
        remove_stock(database, id);
        return;
    }
    put_stock(database, *stock);
}

}  // namespace

void book_cut_sheet(SQLite::Database& database, const std::string& job, int sheet) {
    SQLite::Statement query(database,
                            "SELECT material, stock, offcut FROM sheet WHERE job = ? AND "
                            "number = ? AND (stock <> '' OR offcut <> '')");
    query.bind(1, job);
    query.bind(2, sheet);
    if (!query.executeStep()) {
        return;
    }
    StockRecord offcut;
    offcut.material = query.getColumn(0).getString();
    const std::string taken = query.getColumn(1).getString();
    offcut.json = query.getColumn(2).getString();
    query.reset();
    if (!taken.empty()) {
        take_one(database, taken);
    }
    if (!offcut.json.empty()) {
        offcut.id = fmt::format("offcut-{}-{}", job.substr(job.size() - 8), sheet);
        offcut.quantity = 1;
        offcut.from_job = job;
        offcut.from_sheet = sheet;
        put_stock(database, offcut);
    }
}

std::vector<StockRecord> SqliteStockStore::list() const {
    std::vector<StockRecord> stock;
    database_.read([&](SQLite::Database& database) {
        SQLite::Statement query(database, fmt::format("{}ORDER BY id", kSelectStock));
        while (query.executeStep()) {
            stock.push_back(stock_from(query));
        }
    });
    return stock;
}

std::optional<StockRecord> SqliteStockStore::find(const std::string& id) const {
    std::optional<StockRecord> stock;
    database_.read([&](SQLite::Database& database) { stock = find_stock(database, id); });
    return stock;
}

bool SqliteStockStore::put(const StockRecord& record) {
    bool added = false;
    database_.write([&](SQLite::Database& database) { added = put_stock(database, record); });
    return added;
}

void SqliteStockStore::put_all(const std::vector<StockRecord>& records) {
    database_.write([&](SQLite::Database& database) {
        for (const StockRecord& record : records) {
            put_stock(database, record);
        }
    });
}

bool SqliteStockStore::remove(const std::string& id) {
    bool removed = false;
    database_.write([&](SQLite::Database& database) { removed = remove_stock(database, id); });
    return removed;
}

}  // namespace leafcutter::server
