#include "server/recut_wishes.h"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "server/json_reader.h"
#include "server/outline_json.h"

namespace leafcutter::server {

namespace {

using nlohmann::json;

constexpr std::size_t kMostPieces = 20'000;

std::vector<std::string> read_names(const json& value, const std::string& path) {
    if (!value.is_array() || value.empty() || value.size() > kMostPieces) {
        refuse_param(path, fmt::format("must be a list of 1 to {} pieces", kMostPieces));
    }
    std::vector<std::string> names;
    for (std::size_t i = 0; i < value.size(); ++i) {
        names.push_back(read_text(value[i], fmt::format("{}[{}]", path, i)));
    }
    return names;
}

}  // namespace

RecutWishes wishes_from_json(const json& body) {
    RecutWishes wishes;
    ObjectReader reader(body, "");
    const json* pieces = reader.get("pieces");
    wishes.pieces = read_names(pieces == nullptr ? json::array() : *pieces, "pieces");
    reader.object("sheet", [&wishes](ObjectReader& part) {
        fab::SheetSize size;
        part.number("width_mm", size.width_mm, kPositiveLength);
        part.number("height_mm", size.height_mm, kPositiveLength);
        if (!(size.width_mm > 0.0) || !(size.height_mm > 0.0)) {
            refuse_param("sheet", "must have width_mm and height_mm");
        }
        wishes.sheet = size;
    });
    if (const json* remnant = reader.get("remnant")) {
        wishes.remnant = read_outline(*remnant, "remnant");
        if (wishes.sheet) {
            refuse_param("remnant", "not together with sheet");
        }
    }
    reader.text("material", wishes.material);
    reader.get("name");
    reader.finish();
    return wishes;
}

}  // namespace leafcutter::server
