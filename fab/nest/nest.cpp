// Pieces and sheets made ready for the search (sheet_search.h), and its layouts proven.

#include "fab/nest/nest.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "fab/material/totals.h"
#include "fab/nest/check.h"
#include "fab/nest/sheet_kind.h"
#include "fab/nest/sheet_search.h"
#include "fab/nest/simple_ring.h"
#include "geometry/error.h"
#include "geometry/plane.h"

namespace leafcutter::fab {

using geometry::signed_area;

namespace {

void check_options(const NestOptions& options) {
    const auto refuse = [](const char* path) {
        throw geometry::Error(geometry::ErrorKind::BadOption, "bad-option",
                              fmt::format("{}: must be a number and not below 0", path));
    };
    if (!(options.spacing_mm >= 0.0) || !std::isfinite(options.spacing_mm)) {
        refuse("nesting.spacing_mm");
    }
    if (!(options.margin_mm >= 0.0) || !std::isfinite(options.margin_mm)) {
        refuse("nesting.margin_mm");
    }
    if (!(options.kerf_mm >= 0.0) || !std::isfinite(options.kerf_mm)) {
        refuse("material.kerf_mm");
    }
}

void check_pieces(std::span<const Piece* const> pieces) {
    const auto refuse = [](const Piece& piece, const std::string& fault) {
        throw geometry::Error(geometry::ErrorKind::BadOption, "bad-piece",
                              fmt::format("piece {}: {}", piece.id, fault));
    };
    std::set<std::string_view> ids;
    for (const Piece* piece : pieces) {
        if (const std::string fault = ring_fault(piece->outline); !fault.empty()) {
            refuse(*piece, fault);
        }
        if (!ids.insert(piece->id).second) {
            refuse(*piece, "this id is there twice");
        }
    }
}

class Nesting {
public:
    Nesting(std::span<const Piece* const> pieces,
            std::span<const StockItem> stock,
            const NestOptions& options)
        : pieces_(pieces), stock_(stock), options_(options) {
        check_options(options);
        check_pieces(pieces);
        growth_ = growth_of(options);
        for (const StockItem& sheet : stock) {
            problem_.kinds.push_back(sheet_kind(sheet, options));
        }
        for (const Piece* piece : pieces) {
            problem_.part_of.push_back(problem_.parts.size());
            problem_.parts.push_back(
                make_part(piece->outline, growth_.grow_mm, allowed_rotations(options, *piece)));
        }
    }

    Layout run(const geometry::Context& context) {
        Layout best;
        if (pieces_.empty() || problem_.kinds.empty()) {
            for (const Piece* piece : pieces_) {
                best.unplaced.push_back(piece->id);
            }
            return best;
        }
        CompactionOptions search;
        search.seed = options_.seed;
        // A few pieces are soon laid as well as can be.
        constexpr std::int64_t kPerPiece = 100'000;
        const auto count = static_cast<std::int64_t>(pieces_.size());
        search.max_evaluations = std::min(options_.max_evaluations, kPerPiece * count * count);
        search.time_s = options_.time_s;
        search_sheets(problem_, search, context, [&](const SheetPacking& packing) {
            try {
                Layout layout = layout_of(packing);
                layout.smallest_gap_mm = prove_layout(layout, pieces_, options_);
                best = std::move(layout);
                return true;
            } catch (const geometry::Error&) {
                return false;
            }
        });
        return best;
    }

private:
    Placement placement_of(std::size_t item, const Position& at) const {
        const double shift_mm = growth_.edge_mm - growth_.grow_mm;
        const Eigen::Vector2d& middle = problem_.parts[item].origin;
        const Ring origin = moved({middle}, {at.angle_deg, Eigen::Vector2d::Zero()});
        const Eigen::Vector2d p =
            Eigen::Vector2d(at.x + shift_mm, at.y + shift_mm) - origin.front();
        return {pieces_[item]->id, p.x(), p.y(), at.angle_deg, false};
    }

    Layout layout_of(const SheetPacking& packing) const {
        Layout layout;
        double whole_mm2 = 0.0;
        for (const std::size_t kind : packing.kinds) {
            const StockItem& stock = stock_[kind];
            Sheet sheet;
            sheet.id = static_cast<int>(layout.sheets.size()) + 1;
            sheet.size = stock.size;
            sheet.outline = stock.outline;
            sheet.stock = stock.id;
            sheet.cost = stock.cost;
            sheet.zones = stock.zones;
            whole_mm2 += sheet_area_mm2(sheet);
            layout.sheets.push_back(std::move(sheet));
        }
        double area_mm2 = 0.0;
        for (std::size_t item = 0; item < packing.positions.size(); ++item) {
            const Position& at = packing.positions[item];
            if (at.bin < 0) {
                layout.unplaced.push_back(pieces_[item]->id);
                continue;
            }
            layout.sheets[static_cast<std::size_t>(at.bin)].placements.push_back(
                placement_of(item, at));
            area_mm2 += std::abs(signed_area(pieces_[item]->outline));
        }
        layout.density_percent = whole_mm2 > 0.0 ? 100.0 * area_mm2 / whole_mm2 : 0.0;
        return layout;
    }

    std::span<const Piece* const> pieces_;
    std::span<const StockItem> stock_;
    const NestOptions& options_;
    SheetGrowth growth_;
    SheetProblem problem_;
};

}  // namespace

double sheet_area_mm2(const Sheet& sheet) {
    return sheet.outline.empty() ? sheet.size.width_mm * sheet.size.height_mm
                                 : std::abs(signed_area(sheet.outline));
}

Layout nest(std::span<const Piece* const> pieces,
            std::span<const StockItem> stock,
            const NestOptions& options,
            const geometry::Context& context) {
    return Nesting(pieces, stock, options).run(context);
}

Layout nest(std::span<const Piece* const> pieces,
            const SheetSize& size,
            const NestOptions& options,
            const geometry::Context& context) {
    StockItem sheet;
    sheet.size = size;
    sheet.quantity.reset();
    sheet.cost = 1.0;
    return nest(pieces, {&sheet, 1}, options, context);
}

}  // namespace leafcutter::fab
