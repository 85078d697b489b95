// What report.json says of more than one kind of job.

#include "fab/package/records.h"

#include <cmath>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "fab/export/formats.h"
#include "geometry/error.h"

namespace leafcutter::fab {

namespace {

using json = nlohmann::ordered_json;

json laser_record(const LaserSettings& laser) {
    return {{"power_percent", laser.power_percent},
            {"feed_mm_per_min", laser.feed_mm_per_min},
            {"passes", laser.passes}};
}

json sheets_record(const Material& material) {
    json sheets = json::array();
    for (const StockSheet& sheet : material.sheets) {
        json record = {{"width_mm", sheet.size.width_mm}, {"height_mm", sheet.size.height_mm}};
        if (sheet.price) {
            record["price"] = *sheet.price;
        }
        sheets.push_back(std::move(record));
    }
    return sheets;
}

json settings_record(const Material& material) {
    json list = json::array();
    for (const MachineSettings& settings : material.settings) {
        json record = {{"machine", settings.machine}};
        if (settings.kerf_mm) {
            record["kerf_mm"] = *settings.kerf_mm;
        }
        record["cut"] = laser_record(settings.cut);
        record["score"] = laser_record(settings.score);
        record["engrave"] = laser_record(settings.engrave);
        list.push_back(std::move(record));
    }
    return list;
}

// A number that is none is a mistake of ours; JSON would hide it as null.
void check_finite(const json& value, const std::string& path) {
    if (value.is_number_float() && !std::isfinite(value.get<double>())) {
        throw geometry::Error(geometry::ErrorKind::SelfCheck, "report-not-finite",
                              "report: " + path + " is not a finite number");
    }
    if (value.is_object()) {
        for (const auto& item : value.items()) {
            check_finite(item.value(), path + "." + item.key());
        }
    } else if (value.is_array()) {
        for (std::size_t i = 0; i < value.size(); ++i) {
            check_finite(value[i], fmt::format("{}[{}]", path, i));
        }
    }
}

}  // namespace

nlohmann::ordered_json material_record(const Material& material) {
    json record = {{"id", material.id},
                   {"name", material.name},
                   {"colour", material.colour},
                   {"thickness_mm", material.thickness_mm},
                   {"weight_g_per_m2", material.weight_g_per_m2},
                   {"kerf_mm", material.kerf_mm},
                   {"min_strip_width_mm", material.min_strip_width_mm},
                   {"min_radius_mm", material.min_radius_mm},
                   {"min_length_mm", material.min_length_mm}};
    if (material.grain_deg) {
        record["grain_deg"] = *material.grain_deg;
        record["grain_tolerance_deg"] = material.grain_tolerance_deg;
    }
    record["sheets"] = sheets_record(material);
    if (material.price_per_m2) {
        record["price_per_m2"] = *material.price_per_m2;
    }
    record["currency"] = material.currency;
    record["cut"] = laser_record(material.cut);
    record["score"] = laser_record(material.score);
    record["engrave"] = laser_record(material.engrave);
    record["settings"] = settings_record(material);
    return record;
}

nlohmann::ordered_json bill_record(const Bill& bill) {
    json lines = json::array();
    for (const BillLine& line : bill.lines) {
        json record = {{"material", line.material},
                       {"name", line.name},
                       {"sheets", line.sheets},
                       {"pieces", line.pieces},
                       {"strips_area_mm2", line.strips_area_mm2},
                       {"sheets_area_mm2", line.sheets_area_mm2},
                       {"weight_g", line.weight_g},
                       {"engrave_mm", line.engrave_mm},
                       {"score_mm", line.score_mm},
                       {"cut_mm", line.cut_mm},
                       {"machine_s", line.machine_s}};
        if (!line.currency.empty()) {
            record["cost"] = line.cost;
            record["currency"] = line.currency;
        }
        lines.push_back(std::move(record));
    }
    return lines;
}

nlohmann::ordered_json machine_record(const MachineProfile& machine, Dialect dialect) {
    return {{"rapid_mm_per_min", machine.rapid_mm_per_min},
            {"acceleration_mm_per_s2", machine.acceleration_mm_per_s2},
            {"s_max", full_power(machine, dialect)}};
}

nlohmann::ordered_json input_record(const InputFacts& input) {
    return {{"file", input.file},
            {"vertices", input.vertices},
            {"faces", input.faces},
            {"scale", input.scale}};
}

nlohmann::ordered_json nesting_record(const Layout& layout) {
    json stock = json::array();
    json offcuts = json::array();
    for (const Sheet& sheet : layout.sheets) {
        if (!sheet.stock.empty()) {
            stock.push_back({{"id", sheet.stock}, {"sheet", sheet.id}});
        }
        if (sheet.offcut) {
            offcuts.push_back(
                {{"id", sheet.offcut->id},
                 {"sheet", sheet.id},
                 {"material", sheet.material},
                 {"area_mm2", sheet.offcut->area_mm2},
                 {"rectangle_mm",
                  {sheet.offcut->rectangle.width_mm, sheet.offcut->rectangle.height_mm}}});
        }
    }
    return {{"density_percent", layout.density_percent},
            {"sheets", layout.sheets.size()},
            {"smallest_gap_mm", layout.smallest_gap_mm},
            {"unplaced", layout.unplaced.size()},
            {"unplaced_pieces", layout.unplaced},
            {"from_stock", std::move(stock)},
            {"offcuts", std::move(offcuts)}};
}

namespace {

// Of the options that were asked for.
void add_facts(const CutFacts& facts, const CutParams& wishes, json& record) {
    if (wishes.lead_in_mm > 0.0) {
        record["lead_ins"] = {{"whole", facts.lead_ins},
                              {"shortened", facts.lead_ins_shortened},
                              {"dropped", facts.lead_ins_dropped}};
    }
    if (wishes.tabs > 0) {
        record["tabs"] = {{"left", facts.tabs}, {"dropped", facts.tabs_dropped}};
    }
    if (wishes.common_edges) {
        record["common_edges_mm"] = facts.common_edges_mm;
    }
    if (wishes.heat > 0.0) {
        record["peak_heat"] = facts.peak_heat;
        record["peak_heat_shortest_way"] = facts.peak_heat_shortest_way;
    }
}

}  // namespace

nlohmann::ordered_json cut_record(const JobResult& job) {
    double burn = 0.0;
    double travel = 0.0;
    double seconds = 0.0;
    json sheets = json::array();
    for (const CutProgram& program : job.programs) {
        burn += program.burn_mm;
        travel += program.travel_mm;
        seconds += program.estimated_s;
        sheets.push_back({{"sheet", program.sheet},
                          {"material", program.material},
                          {"burn_mm", program.burn_mm},
                          {"travel_mm", program.travel_mm},
                          {"estimated_s", program.estimated_s}});
        add_facts(program.facts, job.params.cut, sheets.back());
    }
    return {{"burn_mm", burn},
            {"travel_mm", travel},
            {"estimated_s", seconds},
            {"sheets", std::move(sheets)}};
}

void add_makings(const JobResult& job, nlohmann::ordered_json& file) {
    file["bill"] = bill_record(job.bill);
    file["materials"] = json::array({material_record(job.weft)});
    if (job.warp.id != job.weft.id) {
        file["materials"].push_back(material_record(job.warp));
    }
    file["machine"] = machine_record(job.machine, job.params.output.dialect);
    if (!job.params_json.empty()) {
        file["params"] = json::parse(job.params_json);
    }
}

std::string report_text(const nlohmann::ordered_json& report) {
    check_finite(report, "");
    return report.dump(1, ' ', false, json::error_handler_t::replace) + "\n";
}

}  // namespace leafcutter::fab
