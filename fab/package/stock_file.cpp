// stock.json: the sheets and remnants at hand once a job is cut: what it was given, less what it
// took, and its offcuts. The next job may take them.

#include <algorithm>
#include <set>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "fab/package/package_files.h"
#include "fab/package/records.h"

namespace leafcutter::fab {

namespace {

using json = nlohmann::ordered_json;

json points(const Ring& ring) {
    json list = json::array();
    for (const Eigen::Vector2d& point : ring) {
        list.push_back({point.x(), point.y()});
    }
    return list;
}

// The file's name without its ending, of letters that ids may have.
std::string stem(const std::string& file) {
    std::string name = file.substr(0, file.rfind('.'));
    for (char& letter : name) {
        const bool plain = (letter >= '0' && letter <= '9') || (letter >= 'a' && letter <= 'z') ||
                           (letter >= 'A' && letter <= 'Z') || letter == '-' || letter == '_';
        letter = plain ? letter : '-';
    }
    return name;
}

StockItem offcut_item(const Sheet& sheet) {
    StockItem item;
    item.material = sheet.material;
    item.outline = sheet.offcut->outline;
    for (const Ring& hole : sheet.offcut->holes) {
        item.zones.push_back({ZoneKind::Hole, hole});
    }
    move_to_origin(item);
    return item;
}

void add_rings(const StockItem& item, ZoneKind kind, const char* key, json& record) {
    for (const SheetZone& zone : item.zones) {
        if (zone.kind == kind) {
            record[key].push_back(points(zone.outline));
        }
    }
}

}  // namespace

json stock_record(const StockItem& item) {
    json record = {{"id", item.id}};
    if (!item.material.empty()) {
        record["material"] = item.material;
    }
    if (item.outline.empty()) {
        record["width_mm"] = item.size.width_mm;
        record["height_mm"] = item.size.height_mm;
    } else {
        record["outline"] = points(item.outline);
    }
    add_rings(item, ZoneKind::Hole, "holes", record);
    add_rings(item, ZoneKind::Defect, "defects", record);
    add_rings(item, ZoneKind::KeepOut, "keep_out", record);
    record["quantity"] = item.quantity ? json(*item.quantity) : json();
    record["cost"] = item.cost;
    return record;
}

std::string stock_json(const JobResult& job) {
    json list = json::array();
    std::set<std::string> ids;
    for (StockItem item : job.params.nesting.stock) {
        const auto used = std::count_if(
            job.layout.sheets.begin(), job.layout.sheets.end(),
            [&item](const Sheet& sheet) { return !item.id.empty() && sheet.stock == item.id; });
        ids.insert(item.id);
        if (item.quantity) {
            *item.quantity -= static_cast<int>(used);
        }
        if (item.quantity.value_or(1) > 0) {
            list.push_back(stock_record(item));
        }
    }
    for (const Sheet& sheet : job.layout.sheets) {
        if (!sheet.offcut) {
            continue;
        }
        StockItem item = offcut_item(sheet);
        const std::string id = fmt::format("{}-{}", stem(job.input.file), sheet.offcut->id);
        item.id = id;
        for (int i = 2; !ids.insert(item.id).second; ++i) {
            item.id = fmt::format("{}-{}", id, i);
        }
        list.push_back(stock_record(item));
    }
    const json file = {{"format", "leafcutter-stock/1"}, {"stock", std::move(list)}};
    return file.dump(1) + "\n";
}

}  // namespace leafcutter::fab
