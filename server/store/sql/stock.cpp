#include "server/store/sql/stock.h"

#include <fmt/format.h>

#include "server/store/sql/events.h"
#include "server/store/sql/session.h"

namespace leafcutter::server {

namespace {

constexpr const char* kSelectStock =
    "SELECT id, record, material, quantity, note, from_job, from_sheet, created_ms, updated_ms, "
    "(SELECT count(*) FROM sheet JOIN job ON job.id = sheet.job WHERE sheet.stock = stock.id AND "
    "sheet.stock <> '' AND sheet.cut = 0 AND job.state = 'ready') FROM stock ";

StockRecord stock_from(SqlStatement& row) {
    StockRecord stock;
    stock.id = row.column(0).text();
    stock.json = row.column(1).text();
    stock.material = row.column(2).text();
    if (!row.column(3).is_null()) {
        stock.quantity = row.column(3).integer();
    }
    stock.note = row.column(4).text();
    stock.from_job = row.column(5).text();
    stock.from_sheet = row.column(6).integer();
    stock.created_ms = row.column(7).int64();
    stock.updated_ms = row.column(8).int64();
    stock.planned = row.column(9).integer();
    return stock;
}

std::optional<StockRecord> find_stock(SqlSession& session, const std::string& id) {
    SqlStatement query(session, fmt::format("{}WHERE id = ?", kSelectStock));
    query.bind(1, id);
    return query.step() ? std::optional(stock_from(query)) : std::nullopt;
}

void tell_stock(SqlSession& session, const std::string& id, std::string note) {
    EventRecord event;
    event.type = "stock";
    event.subject = id;
    event.note = std::move(note);
    append_event(session, event);
}

bool put_stock(SqlSession& session, const StockRecord& stock) {
    const auto old = find_stock(session, stock.id);
    const std::int64_t now = session.now_ms();
    SqlStatement upsert(
        session,
        "INSERT INTO stock(id, record, material, quantity, note, from_job, from_sheet, "
        "created_ms, updated_ms) VALUES(?, ?, ?, ?, ?, ?, ?, ?, ?) ON CONFLICT(id) DO UPDATE SET "
        "record = excluded.record, material = excluded.material, quantity = excluded.quantity, "
        "note = excluded.note, from_job = excluded.from_job, from_sheet = excluded.from_sheet, "
        "created_ms = excluded.created_ms, updated_ms = excluded.updated_ms");
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
    upsert.run();
    tell_stock(session, stock.id, old ? "changed" : "added");
    return !old;
}

bool remove_stock(SqlSession& session, const std::string& id) {
    SqlStatement erase(session, "DELETE FROM stock WHERE id = ?");
    erase.bind(1, id);
    const bool removed = erase.run() > 0;
    if (removed) {
        tell_stock(session, id, "removed");
    }
    return removed;
}

void take_one(SqlSession& session, const std::string& id) {
    auto stock = find_stock(session, id);
    if (!stock || !stock->quantity) {
        return;
    }
    --*stock->quantity;
    if (*stock->quantity <= 0) {
        remove_stock(session, id);
        return;
    }
    put_stock(session, *stock);
}

}  // namespace

void book_cut_sheet(SqlSession& session, const std::string& job, int sheet) {
    SqlStatement query(session,
                       "SELECT material, stock, offcut FROM sheet WHERE job = ? AND "
                       "number = ? AND (stock <> '' OR offcut <> '')");
    query.bind(1, job);
    query.bind(2, sheet);
    if (!query.step()) {
        return;
    }
    StockRecord offcut;
    offcut.material = query.column(0).text();
    const std::string taken = query.column(1).text();
    offcut.json = query.column(2).text();
    query.reset();
    if (!taken.empty()) {
        take_one(session, taken);
    }
    if (!offcut.json.empty()) {
        offcut.id = fmt::format("offcut-{}-{}", job.substr(job.size() - 8), sheet);
        offcut.quantity = 1;
        offcut.from_job = job;
        offcut.from_sheet = sheet;
        put_stock(session, offcut);
    }
}

std::vector<StockRecord> SqlStockStore::list() const {
    std::vector<StockRecord> stock;
    database_.read([&](SqlSession& session) {
        SqlStatement query(session, fmt::format("{}ORDER BY id", kSelectStock));
        while (query.step()) {
            stock.push_back(stock_from(query));
        }
    });
    return stock;
}

std::optional<StockRecord> SqlStockStore::find(const std::string& id) const {
    std::optional<StockRecord> stock;
    database_.read([&](SqlSession& session) { stock = find_stock(session, id); });
    return stock;
}

bool SqlStockStore::put(const StockRecord& record) {
    bool added = false;
    database_.write([&](SqlSession& session) { added = put_stock(session, record); });
    return added;
}

void SqlStockStore::put_all(const std::vector<StockRecord>& records) {
    database_.write([&](SqlSession& session) {
        for (const StockRecord& record : records) {
            put_stock(session, record);
        }
    });
}

bool SqlStockStore::remove(const std::string& id) {
    bool removed = false;
    database_.write([&](SqlSession& session) { removed = remove_stock(session, id); });
    return removed;
}

}  // namespace leafcutter::server
