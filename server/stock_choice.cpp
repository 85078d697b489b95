#include "server/stock_choice.h"

#include <algorithm>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "server/json_reader.h"

namespace leafcutter::server {

namespace {

using nlohmann::json;

constexpr const char* kAll = "store";

const json* stock_in(const json& params) {
    const auto nesting = params.is_object() ? params.find("nesting") : params.end();
    if (nesting == params.end() || !nesting->is_object()) {
        return nullptr;
    }
    const auto stock = nesting->find("stock");
    return stock == nesting->end() ? nullptr : &*stock;
}

// Nothing if all of it is in somebody's plan.
std::optional<json> entry_of(const StockRecord& record) {
    json entry = json::parse(record.json);
    entry["id"] = record.id;
    entry["quantity"] = nullptr;
    if (!record.material.empty()) {
        entry["material"] = record.material;
    }
    if (record.quantity) {
        const int free = *record.quantity - record.planned;
        if (free <= 0) {
            return std::nullopt;
        }
        entry["quantity"] = free;
    }
    return entry;
}

json everything(const std::vector<StockRecord>& stock) {
    constexpr std::size_t kMost = 1000;  // As many as a job takes.
    json list = json::array();
    for (const StockRecord& record : stock) {
        if (list.size() < kMost) {
            if (auto entry = entry_of(record)) {
                list.push_back(*std::move(entry));
            }
        }
    }
    return list;
}

json named(const std::string& id, const std::vector<StockRecord>& stock, const std::string& path) {
    const auto found = std::find_if(stock.begin(), stock.end(),
                                    [&id](const StockRecord& each) { return each.id == id; });
    if (found == stock.end()) {
        refuse_param(path, fmt::format("the store has no sheet {}", id));
    }
    auto entry = entry_of(*found);
    if (!entry) {
        refuse_param(path, fmt::format("all of {} is in the plans of other jobs", id));
    }
    return *std::move(entry);
}

}  // namespace

bool names_stock(const json& params) {
    const json* stock = stock_in(params);
    return stock != nullptr &&
           (stock->is_string() ||
            (stock->is_array() && std::any_of(stock->begin(), stock->end(), [](const json& entry) {
                 return entry.is_string();
             })));
}

json with_stock(json params, const std::vector<StockRecord>& stock) {
    if (!names_stock(params)) {
        return params;
    }
    json& wanted = params["nesting"]["stock"];
    if (wanted.is_string()) {
        if (wanted != kAll) {
            refuse_param("nesting.stock", "must be \"store\" or a list of sheets");
        }
        wanted = everything(stock);
        return params;
    }
    for (std::size_t i = 0; i < wanted.size(); ++i) {
        if (wanted[i].is_string()) {
            wanted[i] =
                named(wanted[i].get<std::string>(), stock, fmt::format("nesting.stock[{}]", i));
        }
    }
    return params;
}

}  // namespace leafcutter::server
