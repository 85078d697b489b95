#include "fab/nest/check.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string_view>

#include <fmt/format.h>

#include "fab/nest/collision.h"
#include "geometry/error.h"

namespace leafcutter::fab {

namespace {

// Half the last digit that any file of ours drops.
constexpr double kToleranceMm = 1e-6;

[[noreturn]] void fail(const std::string& message) {
    throw geometry::Error(geometry::ErrorKind::SelfCheck, "nest-proof", "nest: " + message);
}

void check_rotation(const Placement& placement, const std::vector<double>& allowed) {
    const bool fine =
        allowed.empty() || std::any_of(allowed.begin(), allowed.end(), [&](double angle) {
            return std::abs(std::remainder(placement.rotation_deg - angle, 360.0)) < 1e-9;
        });
    if (!fine || placement.mirrored) {
        fail(fmt::format("piece {} lies at a rotation that is not allowed", placement.piece));
    }
}

Ring placed_outline(const Piece& piece, const Placement& placement) {
    Ring ring;
    ring.reserve(piece.outline.size());
    for (const Eigen::Vector2d& point : piece.outline) {
        ring.push_back(placement.apply(point));
    }
    return ring;
}

void check_margin(const Ring& ring, const Sheet& sheet, const NestOptions& options) {
    const double margin = options.margin_mm + options.kerf_mm / 2.0 - kToleranceMm;
    const Box box = bounds(ring);
    if (box.low.minCoeff() < margin || box.high.x() > sheet.size.width_mm - margin ||
        box.high.y() > sheet.size.height_mm - margin) {
        fail(fmt::format("a piece leaves the margin of sheet {}", sheet.id));
    }
}

using PieceIndex = std::map<std::string_view, const Piece*>;

// Smallest gap on a sheet, infinite for a single piece. The search reaches as far as any pair so
// far.
double check_sheet(const Sheet& sheet,
                   const PieceIndex& index,
                   const NestOptions& options,
                   double reach_mm) {
    const std::vector<double> allowed = allowed_rotations(options.rotation);
    const double wanted = options.spacing_mm + options.kerf_mm;
    PlacedOutlines outlines({sheet.size.width_mm, sheet.size.height_mm});
    double smallest = reach_mm;
    for (const Placement& placement : sheet.placements) {
        const auto piece = index.find(placement.piece);
        if (piece == index.end()) {
            fail(fmt::format("piece {} was never asked for", placement.piece));
        }
        check_rotation(placement, allowed);
        const Ring ring = placed_outline(*piece->second, placement);
        check_margin(ring, sheet, options);
        const double gap = outlines.distance(ring, smallest);
        if (gap < wanted - kToleranceMm) {
            fail(fmt::format("piece {} on sheet {} is {:.6f} mm from a neighbour, wanted {:.6f}",
                             placement.piece, sheet.id, gap, wanted));
        }
        smallest = std::min(smallest, gap);
        outlines.add(ring);
    }
    return smallest;
}

void check_each_once(const Layout& layout, const PieceIndex& index) {
    std::map<std::string_view, int> times;
    for (const Sheet& sheet : layout.sheets) {
        for (const Placement& placement : sheet.placements) {
            ++times[placement.piece];
        }
    }
    for (const std::string& id : layout.unplaced) {
        ++times[id];
    }
    for (const auto& [id, piece] : index) {
        if (times[id] != 1) {
            fail(fmt::format("piece {} is placed {} times", id, times[id]));
        }
    }
}

}  // namespace

std::vector<double> allowed_rotations(Rotation rotation) {
    switch (rotation) {
        case Rotation::Free:
            return {};
        case Rotation::Half:
            return {0.0, 180.0};
        case Rotation::Quarter:
            return {0.0, 90.0, 180.0, 270.0};
        case Rotation::Fixed:
            break;
    }
    return {0.0};
}

double prove_layout(const Layout& layout,
                    std::span<const Piece* const> pieces,
                    const NestOptions& options) {
    PieceIndex index;
    for (const Piece* piece : pieces) {
        index.emplace(piece->id, piece);
    }
    check_each_once(layout, index);
    // A few gaps' reach finds the smallest at once on any crowded sheet; a sparse one needs all of
    // it.
    double smallest = std::numeric_limits<double>::infinity();
    for (const Sheet& sheet : layout.sheets) {
        const double diagonal = std::hypot(sheet.size.width_mm, sheet.size.height_mm);
        const double first = std::min(diagonal, 4.0 * (options.spacing_mm + options.kerf_mm) + 1.0);
        double found = check_sheet(sheet, index, options, std::min(first, smallest));
        if (found >= first && first < smallest) {
            found = check_sheet(sheet, index, options, std::min(diagonal, smallest));
            found = found >= diagonal ? std::numeric_limits<double>::infinity() : found;
        }
        smallest = std::min(smallest, found);
    }
    return std::isfinite(smallest) ? smallest : 0.0;
}

}  // namespace leafcutter::fab
