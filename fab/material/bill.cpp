#include "fab/material/bill.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string_view>

#include "fab/cut/motion.h"
#include "fab/job_result.h"
#include "fab/material/totals.h"
#include "geometry/plane.h"

namespace leafcutter::fab {

using geometry::signed_area;

namespace {

bool same_size(const SheetSize& a, const SheetSize& b) {
    return a.width_mm == b.width_mm && a.height_mm == b.height_mm;
}

// None if nobody knows.
std::optional<double> price_of(const Material& material, const SheetSize& size) {
    const auto stock =
        std::find_if(material.sheets.begin(), material.sheets.end(),
                     [&size](const StockSheet& each) { return same_size(each.size, size); });
    if (stock != material.sheets.end() && stock->price) {
        return stock->price;
    }
    if (material.price_per_m2) {
        return *material.price_per_m2 * size.width_mm * size.height_mm * 1e-6;
    }
    return std::nullopt;
}

using PieceAreas = std::map<std::string_view, double>;

void add_sheet(const Sheet& sheet,
               const Material& material,
               const PieceAreas& areas,
               BillLine& line) {
    ++line.sheets;
    line.sheets_area_mm2 += sheet.outline.empty() ? sheet.size.width_mm * sheet.size.height_mm
                                                  : std::abs(signed_area(sheet.outline));
    for (const Placement& placement : sheet.placements) {
        if (const auto area = areas.find(placement.piece); area != areas.end()) {
            ++line.pieces;
            line.strips_area_mm2 += area->second;
        }
    }
    // What is at hand costs what it was put down for, though it may be a size that is sold, too.
    const std::optional<double> price = sheet.stock.empty() ? price_of(material, sheet.size)
                                        : sheet.cost > 0.0  ? std::optional(sheet.cost)
                                                            : std::nullopt;
    if (price) {
        line.cost += *price;
        line.currency = material.currency;
    }
}

void add_program(const CutProgram& program, BillLine& line) {
    line.machine_s += program.estimated_s;
    for (const CutPath& path : program.paths) {
        double length = 0.0;
        for (std::size_t i = 1; i < path.points.size(); ++i) {
            length += (path.points[i] - path.points[i - 1]).norm();
        }
        length *= std::max(1, settings_of(program, path).passes);
        switch (path.operation) {
            case Operation::Engrave:
                line.engrave_mm += length;
                break;
            case Operation::Score:
                line.score_mm += length;
                break;
            case Operation::Cut:
                line.cut_mm += length;
                break;
        }
    }
}

BillLine line_of(const JobResult& job, const Material& material, const PieceAreas& areas) {
    BillLine line;
    line.material = material.id;
    line.name = material.name;
    for (const Sheet& sheet : job.layout.sheets) {
        if (sheet.material == material.id) {
            add_sheet(sheet, material, areas, line);
        }
    }
    for (const CutProgram& program : job.programs) {
        if (program.material == material.id) {
            add_program(program, line);
        }
    }
    line.weight_g = line.strips_area_mm2 * 1e-6 * material.weight_g_per_m2;
    return line;
}

}  // namespace

Bill make_bill(const JobResult& job) {
    PieceAreas areas;
    for (const Piece& piece : job.pieces) {
        areas.emplace(piece.id, signed_area(piece.outline));
    }
    Bill bill;
    bill.lines.push_back(line_of(job, job.weft, areas));
    if (job.warp.id != job.weft.id) {
        bill.lines.push_back(line_of(job, job.warp, areas));
    }
    return bill;
}

}  // namespace leafcutter::fab
