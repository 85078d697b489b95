#include "server/test_card.h"

#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "fab/cut/test_card.h"
#include "fab/package/test_card_package.h"
#include "server/json_reader.h"
#include "server/material_json.h"
#include "server/params_names.h"
#include "server/weave_compute.h"

namespace leafcutter::server {

namespace {

using nlohmann::json;

constexpr Range kCells{1.0, 20.0};
constexpr Range kCellMm{2.0, 50.0};

fab::KerfCard read_kerf_card(ObjectReader& reader) {
    fab::KerfCard card;
    reader.integer("cells", card.cells, kCells);
    reader.number("cell_mm", card.cell_mm, kCellMm);
    reader.number("largest_kerf_mm", card.largest_kerf_mm, {0.1, 2.0});
    if (card.largest_kerf_mm > card.cell_mm / 4.0) {
        refuse_param("largest_kerf_mm", "must be a quarter of cell_mm at most");
    }
    return card;
}

void read_range(ObjectReader& reader,
                const char* key,
                const Range& allowed,
                std::array<double, 2>& range) {
    const json* value = reader.get(key);
    if (value == nullptr) {
        return;
    }
    if (!value->is_array() || value->size() != 2) {
        refuse_param(key, "must be [from, to]");
    }
    for (std::size_t i = 0; i < 2; ++i) {
        range.at(i) = read_number((*value)[i], fmt::format("{}[{}]", key, i), allowed);
    }
}

// Half and twice what the material has for the operation, where nothing is said.
fab::PowerCard read_power_card(ObjectReader& reader, const fab::Material& material) {
    static constexpr ObjectReader::Choice<fab::Operation> kOperations[] = {
        {"engrave", fab::Operation::Engrave},
        {"score", fab::Operation::Score},
        {"cut", fab::Operation::Cut}};
    constexpr double kFull = 100.0;
    fab::PowerCard card;
    reader.choice<fab::Operation>("operation", card.operation, kOperations);
    const fab::LaserSettings& usual = card.operation == fab::Operation::Cut     ? material.cut
                                      : card.operation == fab::Operation::Score ? material.score
                                                                                : material.engrave;
    card.power_percent = {usual.power_percent / 2.0, std::min(kFull, usual.power_percent * 2.0)};
    card.feed_mm_per_min = {usual.feed_mm_per_min / 2.0, usual.feed_mm_per_min * 2.0};
    card.passes = std::max(1, usual.passes);
    read_range(reader, "power_percent", {0.0, kFull, true}, card.power_percent);
    read_range(reader, "feed_mm_per_min", {1.0, 100'000.0}, card.feed_mm_per_min);
    reader.integer("powers", card.powers, kCells);
    reader.integer("feeds", card.feeds, kCells);
    reader.integer("passes", card.passes, {1.0, 20.0});
    reader.number("cell_mm", card.cell_mm, kCellMm);
    return card;
}

fab::Material read_material(ObjectReader& reader, std::span<const fab::Material> materials) {
    std::string id;
    std::string machine;
    reader.text("material", id);
    reader.text("machine", machine);
    const fab::Material* material = fab::find_material(materials, id);
    if (material == nullptr) {
        refuse_param("material",
                     id.empty() ? "name one" : fmt::format("there is no material {}", id));
    }
    return fab::on_machine(*material, machine);
}

}  // namespace

ComputeOutput test_card_from(const json& wish, std::span<const fab::Material> materials) {
    ObjectReader reader(wish, "");
    const fab::Material material = read_material(reader, materials);
    enum class Kind { None, Kerf, Power };
    static constexpr ObjectReader::Choice<Kind> kKinds[] = {{"kerf", Kind::Kerf},
                                                            {"power", Kind::Power}};
    Kind kind = Kind::None;
    reader.choice<Kind>("kind", kind, kKinds);
    if (kind == Kind::None) {
        refuse_param("kind", "must be one of kerf, power");
    }
    fab::Dialect dialect = fab::Dialect::Grbl;
    reader.choice<fab::Dialect>("dialect", dialect, kDialects);
    const fab::TestCard card = kind == Kind::Kerf
                                   ? fab::TestCard(read_kerf_card(reader))
                                   : fab::TestCard(read_power_card(reader, material));
    reader.get("name");
    reader.finish();
    const fab::MachineProfile machine;
    const fab::CutProgram program = fab::plan_test_card(card, material, machine);
    ComputeOutput output;
    output.package = fab::test_card_package(card, program, machine, dialect);
    output.sheets = sheets_in(output.package);
    const json summary = {{"quads", 0},
                          {"strips", 0},
                          {"pieces", 0},
                          {"sheets", 1},
                          {"estimated_s", program.estimated_s},
                          {"warnings", json::array()},
                          {"test", kind == Kind::Kerf ? "kerf" : "power"},
                          {"reading", fab::reading_of(card)}};
    output.summary_json = summary.dump();
    return output;
}

ComputeOutput make_test_card(const std::string& wish_json,
                             const std::vector<std::string>& material_records) {
    const std::vector<fab::Material> materials =
        with_materials(fab::built_in_materials(), materials_from_records(material_records));
    return test_card_from(json::parse(wish_json), materials);
}

}  // namespace leafcutter::server
