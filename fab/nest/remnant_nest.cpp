#include "fab/nest/remnant_nest.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "fab/clipper_paths.h"
#include "fab/material/totals.h"
#include "fab/nest/exact.h"
#include "fab/nest/family_nest.h"
#include "fab/nest/grow.h"
#include "fab/nest/instance.h"
#include "fab/nest/shape.h"
#include "fab/nest/simple_ring.h"
#include "geometry/error.h"

namespace leafcutter::fab {

namespace {

constexpr double kGuardMm = 2e-4;  // Kept above the wanted gap, for rounding.
constexpr double kUnitsPerMm = 1e6;

Ring at_origin(const Ring& outline) {
    const Eigen::Vector2d low = bounds(outline).low;
    Ring moved_ring = outline;
    for (Eigen::Vector2d& point : moved_ring) {
        point -= low;
    }
    return moved_ring;
}

// What is left of a ring `by` from its edge inwards; by < 0: outwards. Counter-clockwise rings.
std::vector<Ring> inset(const Ring& ring, double by) {
    const ClipperLib::Paths left =
        mitred_offset({upright_path(ring, kUnitsPerMm)}, -by * kUnitsPerMm);
    std::vector<Ring> rings;
    for (const ClipperLib::Path& part : left) {
        Ring out = ring_of(part, kUnitsPerMm);
        if (ring_fault(out).empty()) {
            rings.push_back(std::move(out));
        }
    }
    return rings;
}

class RemnantNesting {
public:
    RemnantNesting(std::span<const Piece* const> pieces,
                   const Material& material,
                   const Ring& outline,
                   const NestingParams& params)
        : pieces_(pieces), material_(material), params_(params) {
        if (const std::string fault = ring_fault(outline); !fault.empty()) {
            throw geometry::Error(geometry::ErrorKind::BadOption, "bad-remnant",
                                  fmt::format("remnant: {}", fault));
        }
        outline_ = at_origin(outline);
        gap_mm_ = params.spacing_mm + material.kerf_mm;
        edge_mm_ = params.margin_mm + material.kerf_mm / 2.0;
        grow_mm_ = gap_mm_ / 2.0 + kGuardMm;
    }

    Layout run(const geometry::Context& context) const {
        const NestInstance problem = instance();
        CompactionOptions search;
        search.seed = params_.seed;
        // A few pieces are soon laid as well as can be.
        constexpr std::int64_t kPerPiece = 100'000;
        const auto count = static_cast<std::int64_t>(pieces_.size());
        search.max_evaluations =
            std::min(tries_in(params_.time_s, pieces_), kPerPiece * count * count);
        search.time_s = 4.0 * params_.time_s;
        Layout layout = layout_of(solve(problem, search, context));
        context.check();
        prove(layout);
        return layout;
    }

private:
    // Outlines grown by half the gap may come as near to the edge as that takes away.
    NestInstance instance() const {
        NestInstance problem;
        problem.name = "remnant";
        const Rotations turns = turns_on(material_, params_.rotation);
        for (const Piece* piece : pieces_) {
            InstanceItem item;
            item.id = static_cast<int>(problem.items.size());
            item.outline = grown(piece->outline, grow_mm_);
            item.allowed_deg = turns;
            problem.items.push_back(std::move(item));
        }
        for (Ring& ring : inset(outline_, edge_mm_ - grow_mm_ + kGuardMm)) {
            InstanceBin bin;
            bin.id = static_cast<int>(problem.bins.size());
            bin.outline = std::move(ring);
            problem.bins.push_back(std::move(bin));
        }
        if (problem.bins.empty()) {
            throw geometry::Error(geometry::ErrorKind::BadOption, "remnant-too-small",
                                  "remnant: is no larger than its margins (nesting.margin_mm)");
        }
        return problem;
    }

    Layout layout_of(const InstanceSolution& solution) const {
        Layout layout;
        Sheet sheet;
        sheet.material = material_.id;
        sheet.outline = outline_;
        const Eigen::Vector2d extent = bounds(outline_).high;
        sheet.size = {extent.x(), extent.y()};
        double area_mm2 = 0.0;
        for (const InstanceLayout& part : solution.layouts) {
            for (const InstancePlacement& at : part.placed) {
                const Piece& piece = *pieces_[at.item];
                sheet.placements.push_back(
                    {piece.id, at.offset.x(), at.offset.y(), at.rotation_deg, false});
                area_mm2 += ring_area(piece.outline);
            }
        }
        for (const std::size_t item : solution.unplaced) {
            layout.unplaced.push_back(pieces_[item]->id);
        }
        layout.density_percent = 100.0 * area_mm2 / std::abs(ring_area(outline_));
        if (!sheet.placements.empty()) {
            layout.sheets.push_back(std::move(sheet));
        }
        return layout;
    }

    // From the pieces' own outlines alone.
    void prove(Layout& layout) const {
        if (layout.sheets.empty()) {
            return;
        }
        const Sheet& sheet = layout.sheets.front();
        constexpr double kToleranceMm = 1e-3;
        const double unit = exact_unit(std::max(sheet.size.width_mm, sheet.size.height_mm));
        std::map<std::string_view, const Piece*> index;
        for (const Piece* piece : pieces_) {
            index.emplace(piece->id, piece);
        }
        std::vector<PlacedRing> rings;
        for (const Placement& placement : sheet.placements) {
            Ring ring;
            for (const Eigen::Vector2d& point : index.at(placement.piece)->outline) {
                ring.push_back(placement.apply(point));
            }
            rings.push_back({fmt::format("piece {}", placement.piece), to_whole(ring, unit)});
        }
        const double gap_units = std::floor((gap_mm_ - kToleranceMm) / unit);
        const auto gap = std::max<std::int64_t>(0, static_cast<std::int64_t>(gap_units));
        const double smallest = unit * prove_apart(rings, gap);
        layout.smallest_gap_mm = std::isfinite(smallest) ? smallest : 0.0;
        for (PlacedRing& ring : rings) {
            prove_on_remnant(ring, unit);
        }
    }

    void prove_on_remnant(const PlacedRing& ring, double unit) const {
        constexpr double kToleranceMm = 1e-3;
        std::string why = "leaves the remnant's margin";
        for (const Ring& room : inset(outline_, edge_mm_ - kToleranceMm)) {
            try {
                prove_inside({&ring, 1}, to_whole(room, unit));
                return;
            } catch (const geometry::Error& error) {
                why = error.what();
            }
        }
        throw geometry::Error(geometry::ErrorKind::SelfCheck, "nest-proof", why);
    }

    std::span<const Piece* const> pieces_;
    const Material& material_;
    const NestingParams& params_;
    Ring outline_;
    double gap_mm_ = 0.0;
    double edge_mm_ = 0.0;
    double grow_mm_ = 0.0;
};

}  // namespace

Layout nest_remnant(std::span<const Piece* const> pieces,
                    const Material& material,
                    const Ring& outline,
                    const NestingParams& params,
                    const geometry::Context& context) {
    return RemnantNesting(pieces, material, outline, params).run(context);
}

}  // namespace leafcutter::fab
