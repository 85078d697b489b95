#include "fab/package/test_card_package.h"

#include <string>

#include <nlohmann/json.hpp>

#include "fab/export/formats.h"
#include "fab/package/package_files.h"
#include "fab/package/records.h"

namespace leafcutter::fab {

namespace {

using json = nlohmann::ordered_json;

json card_record(const TestCard& card) {
    json record;
    if (const auto* kerf = std::get_if<KerfCard>(&card)) {
        record = {{"kind", "kerf"},
                  {"cells", kerf->cells},
                  {"cell_mm", kerf->cell_mm},
                  {"largest_kerf_mm", kerf->largest_kerf_mm}};
    } else {
        const auto& power = std::get<PowerCard>(card);
        static constexpr const char* kNames[] = {"engrave", "score", "cut"};
        record = {{"kind", "power"},
                  {"operation", kNames[static_cast<std::size_t>(power.operation)]},
                  {"power_percent", power.power_percent},
                  {"feed_mm_per_min", power.feed_mm_per_min},
                  {"powers", power.powers},
                  {"feeds", power.feeds},
                  {"passes", power.passes},
                  {"cell_mm", power.cell_mm}};
    }
    record["reading"] = reading_of(card);
    return record;
}

}  // namespace

Package test_card_package(const TestCard& card,
                          const CutProgram& program,
                          const MachineProfile& machine,
                          Dialect dialect) {
    JobResult job;
    job.programs = {program};
    Sheet sheet;
    sheet.material = program.material;
    sheet.size = program.size;
    job.layout.sheets = {sheet};
    const json report = {{"format", "leafcutter-report/1"},
                         {"test", card_record(card)},
                         {"machine", machine_record(machine, dialect)},
                         {"cut", cut_record(job)},
                         {"warnings", json::array()}};
    Package package;
    package.files = {{"report.json", report_text(report)},
                     {"layout.json", layout_json(job)},
                     {"sheets/sheet-001.svg", write_svg(program)},
                     {"sheets/sheet-001.dxf", write_dxf(program)},
                     {"sheets/sheet-001.gcode", write_gcode(program, machine, dialect)}};
    return package;
}

}  // namespace leafcutter::fab
