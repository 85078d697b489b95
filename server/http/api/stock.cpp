// Sheets and remnants at hand.

#include <algorithm>
#include <array>
#include <string_view>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "fab/material/material.h"
#include "fab/package/records.h"
#include "server/app.h"
#include "server/http/api/handlers.h"
#include "server/http/api/lookup.h"
#include "server/http/json_body.h"
#include "server/http/problem.h"
#include "server/material_json.h"
#include "server/params_stock.h"
#include "server/store/ids.h"

namespace leafcutter::server {

namespace {

using nlohmann::json;

constexpr std::size_t kLongestNote = 1000;

json view_of(const StockRecord& record) {
    json view = json::parse(record.json);
    view["id"] = record.id;
    view["material"] = record.material;
    view["quantity"] = record.quantity ? json(*record.quantity) : json();
    view["kind"] = record.from_job.empty() && view.count("outline") == 0 ? "sheet" : "remnant";
    view["planned"] = record.planned;
    view["note"] = record.note;
    view["from_job"] = record.from_job.empty() ? json() : json(record.from_job);
    view["from_sheet"] = record.from_sheet == 0 ? json() : json(record.from_sheet);
    view["created_at"] = rfc3339(record.created_ms);
    view["updated_at"] = rfc3339(record.updated_ms);
    return view;
}

// What a view says besides the sheet itself.
constexpr std::array<std::string_view, 6> kSaidByUs = {"kind",       "planned",    "from_job",
                                                       "from_sheet", "created_at", "updated_at"};

std::string taken_note(json& entry) {
    const auto note = entry.find("note");
    if (note == entry.end() || note->is_null()) {
        entry.erase("note");
        return {};
    }
    if (!note->is_string() || note->get_ref<const std::string&>().size() > kLongestNote) {
        throw HttpProblem(422, "bad-field",
                          fmt::format("note: must be a text of up to {} bytes", kLongestNote));
    }
    std::string text = note->get<std::string>();
    entry.erase(note);
    return text;
}

void check_material(App& app, const std::string& material, const std::string& path) {
    const auto all = with_materials(fab::built_in_materials(),
                                    materials_from_records(texts_of(app.store().materials.list())));
    if (!material.empty() && fab::find_material(all, material) == nullptr) {
        throw HttpProblem(422, "bad-field",
                          fmt::format("{}: there is no material {}", path, material));
    }
}

StockRecord record_from(App& app, json entry, const std::string& path) {
    if (!entry.is_object()) {
        throw HttpProblem(422, "bad-field", fmt::format("{}: must be an object", path));
    }
    for (const std::string_view key : kSaidByUs) {
        entry.erase(std::string(key));
    }
    StockRecord record;
    record.note = taken_note(entry);
    const fab::StockItem item = read_stock_item(entry, path);
    check_material(app, item.material, path.empty() ? "material" : path + ".material");
    record.id = item.id;
    record.material = item.material;
    record.quantity = item.quantity;
    record.json = fab::stock_record(item).dump();
    if (const auto old = app.store().stock.find(record.id)) {
        record.from_job = old->from_job;
        record.from_sheet = old->from_sheet;
    }
    return record;
}

StockRecord find_stock(App& app, const Request& request) {
    auto record = app.store().stock.find(request.capture("id"));
    if (!record) {
        throw HttpProblem(404, "no-such-stock", "there is no sheet of that id in stock");
    }
    return *std::move(record);
}

json all_stock(App& app) {
    json list = json::array();
    for (const StockRecord& record : app.store().stock.list()) {
        list.push_back(view_of(record));
    }
    return {{"format", "leafcutter-stock/1"}, {"stock", std::move(list)}};
}

}  // namespace

Response list_stock(App& app, Request&) {
    return json_response(all_stock(app));
}

Response import_stock(App& app, Request& request) {
    const json body = parse_json(read_body(request, kMostBulkBytes));
    const auto list = body.is_object() ? body.find("stock") : body.end();
    if (list == body.end() || !list->is_array()) {
        throw HttpProblem(422, "bad-field", "stock: must be a list, as GET /stock shows it");
    }
    std::vector<StockRecord> records;
    for (std::size_t i = 0; i < list->size(); ++i) {
        records.push_back(record_from(app, (*list)[i], fmt::format("stock[{}]", i)));
    }
    app.store().stock.put_all(records);
    return json_response(all_stock(app));
}

Response show_stock(App& app, Request& request) {
    return json_response(view_of(find_stock(app, request)));
}

Response put_stock(App& app, Request& request) {
    const std::string& id = request.capture("id");
    json body = read_json_object(request);
    const auto named = body.emplace("id", id);
    if (!named.second && *named.first != id) {
        throw HttpProblem(422, "bad-field", "id: must be the one of the address, or be left out");
    }
    const bool is_new = app.store().stock.put(record_from(app, std::move(body), ""));
    return json_response(view_of(find_stock(app, request)), is_new ? 201 : 200);
}

Response delete_stock(App& app, Request& request) {
    if (!app.store().stock.remove(find_stock(app, request).id)) {
        throw HttpProblem(404, "no-such-stock", "there is no sheet of that id in stock");
    }
    Response gone;
    gone.status = 204;
    return gone;
}

}  // namespace leafcutter::server
