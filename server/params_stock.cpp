#include "server/params_stock.h"

#include <set>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "fab/nest/check.h"
#include "fab/package/records.h"
#include "server/json_reader.h"
#include "server/outline_json.h"
#include "server/params.h"
#include "server/params_names.h"

namespace leafcutter::server {

namespace {

using nlohmann::json;

constexpr const char* kFormat = "leafcutter-stock/1";
constexpr std::size_t kMostSheets = 1000;
constexpr std::size_t kMostZones = 1000;

void read_zones(ObjectReader& reader, const char* key, fab::ZoneKind kind, fab::StockItem& item) {
    const json* list = reader.get(key);
    if (list == nullptr) {
        return;
    }
    if (!list->is_array() || list->size() > kMostZones) {
        refuse_param(reader.path_of(key),
                     fmt::format("must be a list of up to {} outlines [[x, y], ...]", kMostZones));
    }
    for (std::size_t i = 0; i < list->size(); ++i) {
        const std::string path = fmt::format("{}[{}]", reader.path_of(key), i);
        item.zones.push_back({kind, read_outline((*list)[i], path)});
    }
}

void read_shape(ObjectReader& reader, fab::StockItem& item) {
    const json* outline = reader.get("outline");
    reader.number("width_mm", item.size.width_mm, kPositiveLength);
    reader.number("height_mm", item.size.height_mm, kPositiveLength);
    const bool sized = item.size.width_mm > 0.0 || item.size.height_mm > 0.0;
    if (outline != nullptr) {
        if (sized) {
            refuse_param(reader.path_of("outline"), "not together with width_mm and height_mm");
        }
        item.outline = read_outline(*outline, reader.path_of("outline"));
    } else if (!(item.size.width_mm > 0.0) || !(item.size.height_mm > 0.0)) {
        refuse_param(reader.path_of("width_mm"),
                     "is missing: a sheet has width_mm and height_mm, or an outline");
    }
    read_zones(reader, "holes", fab::ZoneKind::Hole, item);
    read_zones(reader, "defects", fab::ZoneKind::Defect, item);
    read_zones(reader, "keep_out", fab::ZoneKind::KeepOut, item);
}

}  // namespace

fab::StockItem read_stock_item(const json& entry, const std::string& path) {
    ObjectReader reader(entry, path);
    fab::StockItem item;
    reader.text("id", item.id);
    if (item.id.empty() || item.id.size() > 200) {
        refuse_param(reader.path_of("id"), "must be 1 to 200 bytes");
    }
    reader.text("material", item.material);
    read_shape(reader, item);
    if (const json* quantity = reader.get("quantity")) {
        item.quantity.reset();
        if (!quantity->is_null()) {
            item.quantity = read_integer(*quantity, reader.path_of("quantity"), {0.0, 100'000.0});
        }
    }
    reader.number("cost", item.cost, {});
    if (!item.quantity && !(item.cost > 0.0)) {
        refuse_param(reader.path_of("cost"), "must be > 0 for sheets without a quantity");
    }
    reader.finish();
    fab::move_to_origin(item);
    return item;
}
std::vector<fab::StockItem> read_stock(const json& value, const std::string& path) {
    if (!value.is_array() || value.size() > kMostSheets) {
        refuse_param(path, fmt::format("must be a list of up to {} sheets", kMostSheets));
    }
    std::vector<fab::StockItem> stock;
    std::set<std::string> ids;
    for (std::size_t i = 0; i < value.size(); ++i) {
        const std::string where = fmt::format("{}[{}]", path, i);
        stock.push_back(read_stock_item(value[i], where));
        if (!ids.insert(stock.back().id).second) {
            refuse_param(where + ".id",
                         fmt::format("{} is there twice; raise the first one's quantity, or name "
                                     "them apart",
                                     stock.back().id));
        }
    }
    return stock;
}

json stock_of_text(std::string_view text) {
    const json file = parse_params_text(text, "stock");
    json list = file;
    if (file.is_object()) {
        ObjectReader reader(file, "");
        const json* format = reader.get("format");
        if (format == nullptr || *format != kFormat) {
            refuse_param("format", fmt::format("must be {}", kFormat));
        }
        const json* stock = reader.get("stock");
        list = stock == nullptr ? json() : *stock;
        reader.finish();
    }
    read_stock(list, "stock");
    return list;
}

fab::Rotations read_rotations(const json& value, const std::string& path) {
    if (!value.is_array()) {
        const std::string name = value.is_number() ? value.dump() : read_text(value, path);
        for (const auto& choice : kRotations) {
            if (choice.name == name) {
                return fab::allowed_rotations(choice.value);
            }
        }
        refuse_param(path,
                     "must be one of free, 0,180, 0,90,180,270, 0, or a list of angles and "
                     "intervals [from, to]");
    }
    constexpr std::size_t kMost = 360;
    constexpr Range kAngle{-360.0, 360.0};
    if (value.empty() || value.size() > kMost) {
        refuse_param(path, fmt::format("must hold 1 to {} angles or intervals", kMost));
    }
    std::vector<fab::AngleInterval> intervals;
    for (std::size_t i = 0; i < value.size(); ++i) {
        const std::string where = fmt::format("{}[{}]", path, i);
        if (!value[i].is_array()) {
            const double angle = read_number(value[i], where, kAngle);
            intervals.push_back({angle, angle});
            continue;
        }
        if (value[i].size() != 2) {
            refuse_param(where, "must be an angle or [from, to]");
        }
        const double from = read_number(value[i][0], where, kAngle);
        const double to = read_number(value[i][1], where, kAngle);
        if (from > to) {
            refuse_param(where, "must go from the smaller angle to the larger one");
        }
        intervals.push_back({from, to});
    }
    return fab::Rotations(std::move(intervals));
}

json rotations_to_json(const fab::Rotations& rotations) {
    if (rotations.empty()) {
        return "free";
    }
    json list = json::array();
    for (const fab::AngleInterval& each : rotations.intervals()) {
        list.push_back(each.from_deg == each.to_deg ? json(each.from_deg)
                                                    : json({each.from_deg, each.to_deg}));
    }
    return list;
}

}  // namespace leafcutter::server
