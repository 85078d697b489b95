// Materials and what a job takes of them: bill.csv and the records of report.json.

#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "fab/package/package_files.h"
#include "fab/package/records.h"

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

// A field of a table: in quotes where it needs some.
std::string csv_field(const std::string& text) {
    if (text.find_first_of(",\"\r\n") == std::string::npos) {
        return text;
    }
    std::string quoted = "\"";
    for (const char letter : text) {
        quoted += letter == '"' ? std::string("\"\"") : std::string(1, letter);
    }
    return quoted + "\"";
}

std::string csv_line(const BillLine& line) {
    const std::string cost = line.currency.empty() ? "" : fmt::format("{:.2f}", line.cost);
    return fmt::format("{},{},{},{},{:.1f},{:.1f},{:.2f},{:.0f},{:.0f},{:.0f},{:.0f},{},{}\r\n",
                       csv_field(line.material), csv_field(line.name), line.sheets, line.pieces,
                       line.strips_area_mm2 / 100.0, line.sheets_area_mm2 / 100.0, line.weight_g,
                       line.engrave_mm, line.score_mm, line.cut_mm, line.machine_s, cost,
                       csv_field(line.currency));
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

nlohmann::ordered_json machine_record(const MachineProfile& machine) {
    return {{"rapid_mm_per_min", machine.rapid_mm_per_min},
            {"acceleration_mm_per_s2", machine.acceleration_mm_per_s2},
            {"s_max", machine.s_max}};
}

std::string bill_csv(const JobResult& job) {
    std::string text =
        "material,name,sheets,pieces,strips_cm2,sheets_cm2,weight_g,engrave_mm,score_mm,cut_mm,"
        "machine_s,cost,currency\r\n";
    for (const BillLine& line : job.bill.lines) {
        text += csv_line(line);
    }
    return text;
}

}  // namespace leafcutter::fab
