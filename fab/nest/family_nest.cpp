#include "fab/nest/family_nest.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "fab/material/totals.h"
#include "fab/nest/nest.h"
#include "geometry/error.h"

namespace leafcutter::fab {

namespace {

// What two threads of an ordinary machine try in a second, for each corner of an average outline.
// Work, not time, bounds the search, so that equal input gives equal layouts; only a machine that
// is far slower is stopped by the clock.
constexpr double kTriedPerSecondAndCorner = 16e6;
constexpr double kSlowestFactor = 4.0;

struct Batch {
    const Material& material;
    const char* family;
    std::vector<const Piece*> pieces;
};

NestOptions nest_options(const NestingParams& params, const Batch& batch, double share) {
    NestOptions options;
    options.spacing_mm = params.spacing_mm;
    options.margin_mm = params.margin_mm;
    options.kerf_mm = batch.material.kerf_mm;
    options.rotation = params.rotation;
    options.seed = params.seed;
    std::size_t corners = 0;
    for (const Piece* piece : batch.pieces) {
        corners += piece->outline.size();
    }
    const double mean_corners =
        static_cast<double>(corners) / static_cast<double>(batch.pieces.size());
    const double tried = params.time_s * share * kTriedPerSecondAndCorner / (4.0 + mean_corners);
    options.max_evaluations = std::max<std::int64_t>(1, std::llround(tried));
    options.time_s = kSlowestFactor * params.time_s * share;
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
    const SheetSize& sheet = material.sheets.front().size;
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
    double done = 0.0;
    for (const Batch& batch : batches) {
        if (batch.pieces.empty()) {
            continue;
        }
        const double share =
            static_cast<double>(batch.pieces.size()) / static_cast<double>(pieces.size());
        const NestOptions options = nest_options(params, batch, share);
        geometry::Context part = context;
        part.progress = [&](std::string_view stage, double fraction) {
            context.report(stage, done + share * fraction);
        };
        append(whole, nest(batch.pieces, batch.material.sheets.front().size, options, part), batch);
        done += share;
        context.check();  // A stopped search returns its best so far; here a stop is a stop.
    }
    whole.density_percent = density_percent(whole, pieces);
    return whole;
}

}  // namespace leafcutter::fab
