// bill.csv: what a job takes of its materials, as a table.

#include <string>

#include <fmt/format.h>

#include "fab/package/package_files.h"

namespace leafcutter::fab {

namespace {

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
