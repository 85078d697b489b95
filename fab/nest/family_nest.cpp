#include "fab/nest/family_nest.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "fab/material/totals.h"
#include "fab/nest/check.h"
#include "fab/nest/nest.h"
#include "fab/nest/offcut.h"
#include "geometry/error.h"
#include "geometry/plane.h"

namespace leafcutter::fab {

using geometry::signed_area;

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

const char* name_of(Family family) {
    return family == Family::Weft ? "weft" : "warp";
}

// What was said of the piece itself, else of its strip, else of its family.
const PieceTurns* turns_of(const Piece& piece, const std::vector<PieceTurns>& wanted) {
    for (const std::string_view name : {std::string_view(piece.id), std::string_view(piece.strip),
                                        std::string_view(name_of(piece.family))}) {
        for (const PieceTurns& turns : wanted) {
            if (turns.of == name) {
                return &turns;
            }
        }
    }
    return nullptr;
}

NestOptions nest_options(const NestingParams& params, const Batch& batch, double share) {
    NestOptions options;
    options.spacing_mm = params.spacing_mm;
    options.margin_mm = params.margin_mm;
    options.kerf_mm = batch.material.kerf_mm;
    options.turns = turns_on(batch.material, params);
    options.seed = params.seed;
    options.max_evaluations = tries_in(params.time_s * share, batch.pieces);
    options.time_s = kSlowestFactor * params.time_s * share;
    for (const Piece* piece : batch.pieces) {
        if (const PieceTurns* own = turns_of(*piece, params.piece_turns)) {
            options.piece_turns[piece->id] =
                own->turns.shifted(batch.material.grain_deg.value_or(0.0));
        }
    }
    return options;
}

double edges(const Material& material, const NestingParams& params) {
    return 2.0 * params.margin_mm + material.kerf_mm;
}

double area(const SheetSize& size) {
    return size.width_mm * size.height_mm;
}

// Those that margins leave something of: one at least, else Error(BadOption).
std::vector<StockSheet> usable_sheets(const Material& material, const NestingParams& params) {
    if (material.sheets.empty()) {
        throw geometry::Error(geometry::ErrorKind::BadOption, "no-sheet",
                              fmt::format("material {}: has no sheets", material.id));
    }
    std::vector<StockSheet> sheets;
    const double edge = edges(material, params);
    for (const StockSheet& sheet : material.sheets) {
        if (sheet.size.width_mm > edge && sheet.size.height_mm > edge) {
            sheets.push_back(sheet);
        }
    }
    if (sheets.empty()) {
        const SheetSize& sheet = material.sheets.front().size;
        throw geometry::Error(
            geometry::ErrorKind::BadOption, "sheet-too-small",
            fmt::format(
                "nesting.margin_mm: a sheet of {:g} x {:g} mm is no larger than its margins",
                sheet.width_mm, sheet.height_mm));
    }
    return sheets;
}

// New sheets cost their price if all sizes have one, else their area; the size preferred comes
// first and wins where another one is not clearly better.
std::vector<StockItem> new_sheets(const Material& material, const NestingParams& params) {
    constexpr double kNotPreferred = 1.05;
    const std::vector<StockSheet> sheets = usable_sheets(material, params);
    const bool priced = std::all_of(sheets.begin(), sheets.end(), [](const StockSheet& sheet) {
        return sheet.price.value_or(0.0) > 0.0;
    });
    std::vector<StockItem> items;
    for (const StockSheet& sheet : sheets) {
        StockItem item;
        item.size = sheet.size;
        item.quantity.reset();
        item.cost =
            priced ? *sheet.price : area(sheet.size) * (items.empty() ? 1.0 : kNotPreferred);
        items.push_back(std::move(item));
    }
    return items;
}

// What may be nested on: first what is left of the stock, then new sheets.
std::vector<StockItem> sheets_for(const Material& material,
                                  const NestingParams& params,
                                  const std::vector<StockItem>& stock) {
    std::vector<StockItem> sheets;
    for (const StockItem& item : stock) {
        const bool fits = item.material.empty() || item.material == material.id;
        if (fits && item.quantity.value_or(1) > 0) {
            sheets.push_back(item);
        }
    }
    if (!params.only_stock) {
        std::vector<StockItem> fresh = new_sheets(material, params);
        std::move(fresh.begin(), fresh.end(), std::back_inserter(sheets));
    }
    return sheets;
}

void take_from(std::vector<StockItem>& stock, const Layout& layout) {
    for (const Sheet& sheet : layout.sheets) {
        for (StockItem& item : stock) {
            if (!sheet.stock.empty() && item.id == sheet.stock && item.quantity) {
                --*item.quantity;
            }
        }
    }
}

void check_stock(const std::vector<StockItem>& stock) {
    std::set<std::string_view> ids;
    for (const StockItem& item : stock) {
        if (item.id.empty() || !ids.insert(item.id).second) {
            throw geometry::Error(
                geometry::ErrorKind::BadOption, "bad-stock",
                fmt::format("nesting.stock: each sheet needs an id of its own; {} is there twice",
                            item.id.empty() ? "an empty one" : item.id));
        }
    }
}

double density_percent(const Layout& layout, std::span<const Piece> pieces) {
    std::map<std::string_view, double> areas;
    for (const Piece& piece : pieces) {
        areas[piece.id] = signed_area(piece.outline);
    }
    double used = 0.0;
    double whole = 0.0;
    for (const Sheet& sheet : layout.sheets) {
        whole += sheet_area_mm2(sheet);
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
        if (sheet.offcut) {
            sheet.offcut->id = fmt::format("offcut-{:03}", sheet.id);
        }
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
    const double edge = edges(material, params);
    SheetSize largest;
    for (const StockItem& sheet : sheets_for(material, params, params.stock)) {
        const SheetSize size = sheet.outline.empty() && sheet.zones.empty()
                                   ? sheet.size
                                   : largest_rectangle(sheet).size;
        largest = area(size) > area(largest) ? size : largest;
    }
    if (!(largest.width_mm > edge) || !(largest.height_mm > edge)) {
        throw geometry::Error(
            geometry::ErrorKind::BadOption, "no-sheet",
            fmt::format("nesting.stock: no sheet of {} leaves room within its margins; add one or "
                        "let new sheets be taken (nesting.only_stock)",
                        material.id));
    }
    PieceRoom room{{largest.width_mm - edge, largest.height_mm - edge}, params.rotation};
    if (material.grain_deg) {
        room.rotation = params.rotation == Rotation::Fixed ? Rotation::Fixed : Rotation::Half;
        if (*material.grain_deg > 45.0) {
            std::swap(room.size.width_mm, room.size.height_mm);
        }
    }
    return room;
}

Rotations turns_on(const Material& material, const NestingParams& params) {
    if (params.turns) {
        return params.turns->shifted(material.grain_deg.value_or(0.0));
    }
    if (!material.grain_deg) {
        return allowed_rotations(params.rotation);
    }
    const Rotation rotation = params.rotation;
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
    check_stock(params.stock);
    std::vector<StockItem> stock = params.stock;
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
        const std::vector<StockItem> sheets = sheets_for(batch.material, params, stock);
        Layout layout = nest(batch.pieces, sheets, options, part);
        add_offcuts(layout, batch.pieces, batch.material.kerf_mm);
        take_from(stock, layout);
        append(whole, std::move(layout), batch);
        done += share;
        context.check();  // A stopped search returns its best so far; here a stop is a stop.
    }
    whole.density_percent = density_percent(whole, pieces);
    return whole;
}

}  // namespace leafcutter::fab
