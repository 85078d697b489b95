#include "fab/recut.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "fab/cut/toolpath.h"
#include "fab/export/formats.h"
#include "fab/nest/family_nest.h"
#include "fab/nest/remnant_nest.h"
#include "fab/package/package_files.h"
#include "geometry/error.h"

namespace leafcutter::fab {

namespace {

[[noreturn]] void refuse(const char* code, const std::string& message) {
    throw geometry::Error(geometry::ErrorKind::BadOption, code, message);
}

std::string listed(const std::vector<std::string>& names) {
    constexpr std::size_t kMost = 5;
    std::string text;
    for (std::size_t i = 0; i < std::min(names.size(), kMost); ++i) {
        text += fmt::format("{}{}", i == 0 ? "" : ", ", names[i]);
    }
    return names.size() <= kMost ? text : fmt::format("{} and {} more", text, names.size() - kMost);
}

std::string sizes_of(const Material& material) {
    std::string text;
    for (const StockSheet& sheet : material.sheets) {
        text += fmt::format("{}{:g} x {:g} mm", text.empty() ? "" : " or ", sheet.size.width_mm,
                            sheet.size.height_mm);
    }
    return text;
}

Layout on_remnant(const JobResult& job, const Ring& remnant, const geometry::Context& context) {
    const auto is_of = [](Family family) {
        return [family](const Piece& piece) { return piece.family == family; };
    };
    const bool weft = std::any_of(job.pieces.begin(), job.pieces.end(), is_of(Family::Weft));
    const bool warp = std::any_of(job.pieces.begin(), job.pieces.end(), is_of(Family::Warp));
    if (weft && warp && job.weft.id != job.warp.id) {
        refuse("two-materials",
               fmt::format("recut: the pieces are of {} and {}, a remnant is of one material; cut "
                           "them one after the other or name the material for all",
                           job.weft.id, job.warp.id));
    }
    const Material& material = weft ? job.weft : job.warp;
    std::vector<const Piece*> pieces;
    for (const Piece& piece : job.pieces) {
        pieces.push_back(&piece);
    }
    Layout layout = nest_remnant(pieces, material, remnant, job.params.nesting, context);
    if (!layout.unplaced.empty()) {
        refuse("no-room",
               fmt::format("recut: no room on the remnant for {}; name fewer pieces or another "
                           "remnant",
                           listed(layout.unplaced)));
    }
    for (Sheet& sheet : layout.sheets) {
        sheet.family = weft && warp ? "both" : (weft ? "weft" : "warp");
    }
    return layout;
}

Layout on_sheets(const JobResult& job, const geometry::Context& context) {
    // The job has cut its stock.
    NestingParams fresh = job.params.nesting;
    fresh.stock.clear();
    fresh.only_stock = false;
    Layout layout = nest_families(job.pieces, {job.weft, job.warp}, fresh, context);
    if (layout.unplaced.empty()) {
        return layout;
    }
    const std::string& first = layout.unplaced.front();
    const auto piece = std::find_if(job.pieces.begin(), job.pieces.end(),
                                    [&first](const Piece& each) { return each.id == first; });
    refuse("too-large",
           fmt::format("recut: {} fit(s) on no sheet of {} with margins of {:g} mm; name a larger "
                       "sheet",
                       listed(layout.unplaced), sizes_of(job.material_of(piece->family)),
                       job.params.nesting.margin_mm));
}

void plan_programs(JobResult& job, const geometry::Context& context) {
    for (const Sheet& sheet : job.layout.sheets) {
        const Material& material = sheet.material == job.weft.id ? job.weft : job.warp;
        CutProgram program =
            plan_sheet(sheet, job.pieces, {material, job.machine, job.params.cut}, context);
        program.job = job.input.file;
        job.programs.push_back(std::move(program));
    }
    job.bill = make_bill(job);
}

Package files_of(const JobResult& job) {
    Package package;
    package.files.push_back({"report.json", recut_report_json(job)});
    package.files.push_back({"layout.json", layout_json(job)});
    package.files.push_back({"bill.csv", bill_csv(job)});
    for (const CutProgram& program : job.programs) {
        const std::string name = fmt::format("sheets/sheet-{:03}", program.sheet);
        package.files.push_back({name + ".svg", write_svg(program)});
        package.files.push_back({name + ".dxf", write_dxf(program)});
        package.files.push_back(
            {name + ".gcode", write_gcode(program, job.machine, job.params.output.dialect)});
    }
    package.files.push_back({"recut.html", recut_html(job)});
    return package;
}

}  // namespace

RecutSummary recut(const RecutInput& input, const geometry::Context& context) {
    if (input.pieces.empty()) {
        refuse("nothing-to-cut", "recut: no pieces were named");
    }
    JobResult job;
    job.params = input.params;
    job.params_json = input.params_json;
    job.machine = input.machine;
    job.input = input.input;
    job.weft = input.weft;
    job.warp = input.warp;
    job.pieces = input.pieces;
    context.report("nest", 0.0);
    job.layout =
        input.remnant.empty() ? on_sheets(job, context) : on_remnant(job, input.remnant, context);
    context.report("toolpath", 0.7);
    plan_programs(job, context);
    context.report("package", 0.9);
    RecutSummary summary;
    summary.package = files_of(job);
    summary.sheets = static_cast<int>(job.layout.sheets.size());
    summary.pieces = static_cast<int>(job.pieces.size());
    for (const CutProgram& program : job.programs) {
        summary.estimated_s += program.estimated_s;
    }
    context.check();
    return summary;
}

}  // namespace leafcutter::fab
