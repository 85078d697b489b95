#include "server/material_json.h"

#include <algorithm>
#include <cctype>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "fab/package/records.h"
#include "geometry/error.h"
#include "server/json_reader.h"
#include "server/params.h"

namespace leafcutter::server {

namespace {

using nlohmann::json;

constexpr const char* kFormat = "leafcutter-materials/1";
constexpr Range kPercent{0.0, 100.0};
constexpr Range kFeed{0.0, 1e6, true};
constexpr Range kPrice{0.0, 1e9};
constexpr Range kHandLength{0.0, 10'000.0};

// Ids and machines: in file names, comments of programs and addresses.
void check_name(const std::string& name, const std::string& path) {
    constexpr std::size_t kLongest = 64;
    const auto plain = [](unsigned char letter) {
        return (letter < 0x80 && std::isalnum(letter) != 0) || letter == '-' || letter == '_' ||
               letter == '.';
    };
    if (name.empty() || name.size() > kLongest || !std::all_of(name.begin(), name.end(), plain) ||
        name.front() == '.') {
        refuse_param(path, "must be 1 to 64 letters, digits, - _ or . without a dot in front");
    }
}

void check_colour(const std::string& colour, const std::string& path) {
    const bool fine = colour.size() == 7 && colour.front() == '#' &&
                      colour.find_first_not_of("0123456789abcdefABCDEF", 1) == std::string::npos;
    if (!fine) {
        refuse_param(path, "must be a colour like #2f5d9b");
    }
}

void check_line(const std::string& text, const std::string& path, std::size_t longest) {
    const auto control = [](unsigned char letter) { return letter < 0x20 || letter == 0x7f; };
    if (text.empty() || text.size() > longest || std::any_of(text.begin(), text.end(), control)) {
        refuse_param(path, fmt::format("must be one line of 1 to {} bytes", longest));
    }
}

// null takes away what the record is like.
void read_optional(ObjectReader& reader,
                   const char* key,
                   std::optional<double>& target,
                   const Range& range) {
    if (const json* value = reader.get(key)) {
        target.reset();
        if (!value->is_null()) {
            target = read_number(*value, reader.path_of(key), range);
        }
    }
}

void read_laser(ObjectReader& reader, const char* key, fab::LaserSettings& laser) {
    reader.object(key, [&laser](ObjectReader& part) {
        part.number("power_percent", laser.power_percent, kPercent);
        part.number("feed_mm_per_min", laser.feed_mm_per_min, kFeed);
        part.integer("passes", laser.passes, {1.0, 100.0});
    });
    if (!(laser.feed_mm_per_min > 0.0)) {
        refuse_param(reader.path_of(key), "is missing: power_percent, feed_mm_per_min, passes");
    }
}

// Each entry of a list, by an object reader of its own.
template <typename Read>
void read_list(ObjectReader& reader, const char* key, std::size_t most, const Read& read) {
    const json* list = reader.get(key);
    if (list == nullptr) {
        return;
    }
    if (!list->is_array() || list->size() > most) {
        refuse_param(reader.path_of(key), fmt::format("must be a list of up to {}", most));
    }
    for (std::size_t i = 0; i < list->size(); ++i) {
        ObjectReader entry((*list)[i], fmt::format("{}[{}]", reader.path_of(key), i));
        read(entry);
        entry.finish();
    }
}

void read_sheets(ObjectReader& reader, fab::Material& material) {
    constexpr std::size_t kMost = 50;
    if (reader.get("sheets") != nullptr) {
        material.sheets.clear();
    }
    read_list(reader, "sheets", kMost, [&material](ObjectReader& entry) {
        fab::StockSheet sheet;
        for (const char* side : {"width_mm", "height_mm"}) {
            if (entry.get(side) == nullptr) {
                refuse_param(entry.path_of(side), "is missing");
            }
        }
        entry.number("width_mm", sheet.size.width_mm, kPositiveLength);
        entry.number("height_mm", sheet.size.height_mm, kPositiveLength);
        read_optional(entry, "price", sheet.price, kPrice);
        material.sheets.push_back(sheet);
    });
    if (material.sheets.empty()) {
        refuse_param(reader.path_of("sheets"), "must hold at least one size");
    }
}

void read_settings(ObjectReader& reader, fab::Material& material) {
    constexpr std::size_t kMost = 100;
    if (reader.get("settings") != nullptr) {
        material.settings.clear();
    }
    read_list(reader, "settings", kMost, [&material](ObjectReader& entry) {
        fab::MachineSettings settings;
        entry.text("machine", settings.machine);
        check_name(settings.machine, entry.path_of("machine"));
        for (const fab::MachineSettings& other : material.settings) {
            if (other.machine == settings.machine) {
                refuse_param(entry.path_of("machine"), "is there twice");
            }
        }
        read_optional(entry, "kerf_mm", settings.kerf_mm, {0.0, 5.0});
        read_laser(entry, "cut", settings.cut);
        read_laser(entry, "score", settings.score);
        read_laser(entry, "engrave", settings.engrave);
        material.settings.push_back(std::move(settings));
    });
}

void read_grain(ObjectReader& reader, fab::Material& material) {
    read_optional(reader, "grain_deg", material.grain_deg, {0.0, 90.0});
    if (material.grain_deg && *material.grain_deg != 0.0 && *material.grain_deg != 90.0) {
        refuse_param(reader.path_of("grain_deg"),
                     "must be 0 (along a sheet's width) or 90 (along its height)");
    }
    reader.number("grain_tolerance_deg", material.grain_tolerance_deg, {0.0, 45.0});
}

void read_fields(ObjectReader& reader, fab::Material& material) {
    reader.text("name", material.name);
    material.name = material.name.empty() ? material.id : material.name;
    check_line(material.name, reader.path_of("name"), 200);
    reader.text("colour", material.colour);
    check_colour(material.colour, reader.path_of("colour"));
    reader.number("thickness_mm", material.thickness_mm, {0.0, 20.0, true});
    reader.number("weight_g_per_m2", material.weight_g_per_m2, {0.0, 50'000.0, true});
    reader.number("kerf_mm", material.kerf_mm, {0.0, 5.0});
    reader.number("min_strip_width_mm", material.min_strip_width_mm, kHandLength);
    reader.number("min_radius_mm", material.min_radius_mm, kHandLength);
    reader.number("min_length_mm", material.min_length_mm, kHandLength);
    read_grain(reader, material);
    read_sheets(reader, material);
    read_optional(reader, "price_per_m2", material.price_per_m2, kPrice);
    reader.text("currency", material.currency);
    check_line(material.currency, reader.path_of("currency"), 12);
    read_laser(reader, "cut", material.cut);
    read_laser(reader, "score", material.score);
    read_laser(reader, "engrave", material.engrave);
    read_settings(reader, material);
}

}  // namespace

fab::Material material_from_json(const json& record,
                                 const std::string& path,
                                 std::span<const fab::Material> known) {
    if (!record.is_object()) {
        refuse_param(path.empty() ? "material" : path, "must be an object");
    }
    ObjectReader reader(record, path);
    fab::Material material;
    std::string like;
    reader.text("like", like);
    if (!like.empty()) {
        const fab::Material* model = fab::find_material(known, like);
        if (model == nullptr) {
            refuse_param(reader.path_of("like"), "there is no material of that id");
        }
        material = *model;
    } else {
        // What a record of its own can't do without.
        for (const char* key : {"thickness_mm", "weight_g_per_m2", "kerf_mm"}) {
            if (reader.get(key) == nullptr) {
                refuse_param(reader.path_of(key), "is missing");
            }
        }
    }
    material.id.clear();
    reader.text("id", material.id);
    check_name(material.id, reader.path_of("id"));
    read_fields(reader, material);
    reader.finish();
    return material;
}

std::vector<fab::Material> materials_from_text(std::string_view text,
                                               std::span<const fab::Material> known) {
    const json file = parse_params_text(text, "materials");
    const json* list = &file;
    if (file.is_object()) {
        ObjectReader reader(file, "");
        const json* format = reader.get("format");
        if (format == nullptr || *format != kFormat) {
            refuse_param("format", fmt::format("must be {}", kFormat));
        }
        list = reader.get("materials");
        reader.finish();
    }
    if (list == nullptr || !list->is_array()) {
        refuse_param("materials", "must be a list of records");
    }
    std::vector<fab::Material> seen(known.begin(), known.end());
    std::vector<fab::Material> added;
    for (std::size_t i = 0; i < list->size(); ++i) {
        const std::string path = fmt::format("materials[{}]", i);
        fab::Material material = material_from_json((*list)[i], path, seen);
        if (fab::find_material(added, material.id) != nullptr) {
            refuse_param(path + ".id", fmt::format("{} is there twice", material.id));
        }
        added.push_back(std::move(material));
        seen = with_materials(seen, {&added.back(), 1});
    }
    return added;
}

std::vector<fab::Material> materials_from_records(const std::vector<std::string>& records) {
    std::vector<fab::Material> materials;
    for (const std::string& record : records) {
        materials.push_back(material_from_json(parse_params_text(record, "material"), "", {}));
    }
    return materials;
}

std::vector<fab::Material> with_materials(std::span<const fab::Material> base,
                                          std::span<const fab::Material> added) {
    std::vector<fab::Material> all(base.begin(), base.end());
    for (const fab::Material& material : added) {
        const auto same = std::find_if(all.begin(), all.end(), [&material](const auto& each) {
            return each.id == material.id;
        });
        if (same == all.end()) {
            all.push_back(material);
        } else {
            *same = material;
        }
    }
    return all;
}

json material_to_json(const fab::Material& material) {
    return fab::material_record(material);
}

std::string materials_to_text(std::span<const fab::Material> materials) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const fab::Material& material : materials) {
        list.push_back(fab::material_record(material));
    }
    const nlohmann::ordered_json file = {{"format", kFormat}, {"materials", std::move(list)}};
    return file.dump(1) + "\n";
}

}  // namespace leafcutter::server
