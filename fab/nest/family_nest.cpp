#include "fab/nest/family_nest.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "fab/material/totals.h"
#include "fab/nest/check.h"
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
    options.turns = turns_on(batch.material, params.rotation);
    options.seed = params.seed;
    options.max_evaluations = tries_in(params.time_s * share, batch.pieces);
    options.time_s = kSlowestFactor * params.time_s * share;
    return options;
}

double edges(const Material& material, const NestingParams& params) {
    return 2.0 * params.margin_mm + material.kerf_mm;
}

double area(const SheetSize& size) {
    return size.width_mm * size.height_mm;
}

// Those that margins leave something of: one at least, else Error(BadOption).
std::vector<SheetSize> usable_sizes(const Material& material, const NestingParams& params) {
    if (material.sheets.empty()) {
        throw geometry::Error(geometry::ErrorKind::BadOption, "no-sheet",
                              fmt::format("material {}: has no sheets", material.id));
    }
    std::vector<SheetSize> sizes;
    const double edge = edges(material, params);
    for (const StockSheet& sheet : material.sheets) {
        if (sheet.size.width_mm > edge && sheet.size.height_mm > edge) {
            sizes.push_back(sheet.size);
        }
    }
    if (sizes.empty()) {
        const SheetSize& sheet = material.sheets.front().size;
        throw geometry::Error(
            geometry::ErrorKind::BadOption, "sheet-too-small",
            fmt::format(
                "nesting.margin_mm: a sheet of {:g} x {:g} mm is no larger than its margins",
                sheet.width_mm, sheet.height_mm));
    }
    return sizes;
}

// What a sheet counts when sizes are compared: its price if all have one, else its area.
double worth(const Material& material, const SheetSize& size) {
    const bool priced =
        std::all_of(material.sheets.begin(), material.sheets.end(),
                    [](const StockSheet& sheet) { return sheet.price.has_value(); });
    for (const StockSheet& sheet : material.sheets) {
        if (priced && sheet.size.width_mm == size.width_mm &&
            sheet.size.height_mm == size.height_mm) {
            return *sheet.price;
        }
    }
    return area(size);
}

// A short search on each size tells which one the whole search is worth.
Layout nest_on_best_size(const Batch& batch,
                         const NestingParams& params,
                         const NestOptions& options,
                         const geometry::Context& context) {
    constexpr std::int64_t kShortShare = 8;
    constexpr double kClearlyLess = 0.95;
    const std::vector<SheetSize> sizes = usable_sizes(batch.material, params);
    const SheetSize* best = &sizes.front();
    std::size_t least_unplaced = 0;
    double least_worth = 0.0;
    geometry::Context quiet = context;
    quiet.progress = {};
    NestOptions brief = options;
    brief.max_evaluations = std::max<std::int64_t>(1, options.max_evaluations / kShortShare);
    brief.time_s = options.time_s / static_cast<double>(kShortShare);
    for (std::size_t i = 0; i < sizes.size() && sizes.size() > 1; ++i) {
        const Layout layout = nest(batch.pieces, sizes[i], brief, quiet);
        context.check();
        const double taken =
            static_cast<double>(layout.sheets.size()) * worth(batch.material, sizes[i]);
        const std::size_t unplaced = layout.unplaced.size();
        const bool better = unplaced < least_unplaced ||
                            (unplaced == least_unplaced && taken < kClearlyLess * least_worth);
        if (i == 0 || better) {
            best = &sizes[i];
            least_unplaced = unplaced;
            least_worth = taken;
        }
    }
    return nest(batch.pieces, *best, options, context);
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

PieceRoom piece_room(const Material& material, const NestingParams& params) {
    const std::vector<SheetSize> sizes = usable_sizes(material, params);
    const double edge = edges(material, params);
    const SheetSize& sheet =
        *std::max_element(sizes.begin(), sizes.end(),
                          [](const SheetSize& a, const SheetSize& b) { return area(a) < area(b); });
    PieceRoom room{{sheet.width_mm - edge, sheet.height_mm - edge}, params.rotation};
    if (material.grain_deg) {
        room.rotation = params.rotation == Rotation::Fixed ? Rotation::Fixed : Rotation::Half;
        if (*material.grain_deg > 45.0) {
            std::swap(room.size.width_mm, room.size.height_mm);
        }
    }
    return room;
}

Rotations turns_on(const Material& material, Rotation rotation) {
    if (!material.grain_deg) {
        return allowed_rotations(rotation);
    }
    const bool exact = rotation == Rotation::Fixed || rotation == Rotation::Half;
    const double tolerance = exact ? 0.0 : material.grain_tolerance_deg;
    std::vector<AngleInterval> turns;
    for (const double half : {0.0, 180.0}) {
        if (half > 0.0 && rotation == Rotation::Fixed) {
            break;
        }
        const double middle = *material.grain_deg + half;
        turns.push_back({middle - tolerance, middle + tolerance});
    }
    return Rotations(std::move(turns));
}

std::int64_t tries_in(double time_s, std::span<const Piece* const> pieces) {
    std::size_t corners = 0;
    for (const Piece* piece : pieces) {
        corners += piece->outline.size();
    }
    const double mean_corners = static_cast<double>(corners) / static_cast<double>(pieces.size());
    const double tried = time_s * kTriedPerSecondAndCorner / (4.0 + mean_corners);
    return std::max<std::int64_t>(1, std::llround(tried));
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
        append(whole, nest_on_best_size(batch, params, options, part), batch);
        done += share;
        context.check();  // A stopped search returns its best so far; here a stop is a stop.
    }
    whole.density_percent = density_percent(whole, pieces);
    return whole;
}

}  // namespace leafcutter::fab
