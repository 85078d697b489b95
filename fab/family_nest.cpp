#include "fab/family_nest.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "fab/nest/nest.h"
#include "fab/totals.h"
#include "geometry/error.h"

namespace leafcutter::fab {

namespace {

// Places tried in a second on an ordinary machine. Work, not time, bounds the search, so that equal
// input gives equal layouts.
constexpr double kEvaluationsPerSecond = 200'000.0;

struct Batch {
    const Material& material;
    const char* family;
    std::vector<const Piece*> pieces;
};

NestOptions nest_options(const NestingParams& params, const Material& material, double share) {
    NestOptions options;
    options.spacing_mm = params.spacing_mm;
    options.margin_mm = params.margin_mm;
    options.kerf_mm = material.kerf_mm;
    options.rotation = params.rotation;
    options.seed = params.seed;
    options.max_evaluations = std::max<std::int64_t>(
        1, static_cast<std::int64_t>(params.time_s * kEvaluationsPerSecond * share));
    return options;
}

double density_percent(const Layout& layout, std::span<const Piece> pieces) {
    std::map<std::string_view, double> areas;
    for (const Piece& piece : pieces) {
        areas[piece.id] = ring_area(piece.outline);
    }
    double used = 0.0;
    double whole = 0.0;
    for (const Sheet& sheet : layout.sheets) {
        whole += sheet.size.width_mm * sheet.size.height_mm;
        for (const Placement& placement : sheet.placements) {
            used += areas[placement.piece];
        }
    }
    return whole > 0.0 ? 100.0 * used / whole : 0.0;
}

void append(Layout& whole, Layout part, const Batch& batch) {
    for (Sheet& sheet : part.sheets) {
        sheet.id = static_cast<int>(whole.sheets.size()) + 1;
        sheet.material = batch.material.id;
        sheet.family = batch.family;
        whole.sheets.push_back(std::move(sheet));
    }
    whole.unplaced.insert(whole.unplaced.end(), part.unplaced.begin(), part.unplaced.end());
    // A sheet with a single piece has no gap.
    if (std::isfinite(part.smallest_gap_mm) && part.smallest_gap_mm > 0.0) {
        whole.smallest_gap_mm = whole.smallest_gap_mm > 0.0
                                    ? std::min(whole.smallest_gap_mm, part.smallest_gap_mm)
                                    : part.smallest_gap_mm;
    }
}

}  // namespace

SheetSize usable_sheet(const Material& material, const NestingParams& params) {
    if (material.sheets.empty()) {
        throw geometry::Error(geometry::ErrorKind::BadOption, "no-sheet",
                              fmt::format("material {}: has no sheets", material.id));
    }
    const SheetSize& sheet = material.sheets.front();
    const double edge = 2.0 * params.margin_mm + material.kerf_mm;
    const SheetSize usable{sheet.width_mm - edge, sheet.height_mm - edge};
    if (!(usable.width_mm > 0.0) || !(usable.height_mm > 0.0)) {
        throw geometry::Error(
            geometry::ErrorKind::BadOption, "sheet-too-small",
            fmt::format(
                "nesting.margin_mm: a sheet of {:g} x {:g} mm is no larger than its margins",
                sheet.width_mm, sheet.height_mm));
    }
    return usable;
}

Layout nest_families(std::span<const Piece> pieces,
                     const FamilyMaterials& materials,
                     const NestingParams& params,
                     const geometry::Context& context) {
    const bool shared = materials.weft.id == materials.warp.id;
    std::vector<Batch> batches = {{materials.weft, shared ? "both" : "weft", {}}};
    if (!shared) {
        batches.push_back({materials.warp, "warp", {}});
    }
    for (const Piece& piece : pieces) {
        batches[shared || piece.family == Family::Weft ? 0 : 1].pieces.push_back(&piece);
    }
    Layout whole;
    for (const Batch& batch : batches) {
        if (batch.pieces.empty()) {
            continue;
        }
        const double share =
            static_cast<double>(batch.pieces.size()) / static_cast<double>(pieces.size());
        const NestOptions options = nest_options(params, batch.material, share);
        append(whole, nest(batch.pieces, batch.material.sheets.front(), options, context), batch);
        context.check();  // A stopped search returns its best so far; here a stop is a stop.
    }
    whole.density_percent = density_percent(whole, pieces);
    return whole;
}

}  // namespace leafcutter::fab
