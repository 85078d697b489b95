#include "fab/nest/check.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string_view>

#include <fmt/format.h>

#include "fab/nest/exact.h"
#include "geometry/error.h"

namespace leafcutter::fab {

namespace {

// Half the last digit that any file of ours drops.
constexpr double kToleranceMm = 1e-6;

[[noreturn]] void fail(const std::string& message) {
    throw geometry::Error(geometry::ErrorKind::SelfCheck, "nest-proof", "nest: " + message);
}

void check_rotation(const Placement& placement, const Rotations& allowed) {
    constexpr double kToleranceDeg = 1e-9;
    if (!allowed.allows(placement.rotation_deg, kToleranceDeg) || placement.mirrored) {
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

const char* name_of(ZoneKind kind) {
    switch (kind) {
        case ZoneKind::Hole:
            return "a hole of the sheet";
        case ZoneKind::KeepOut:
            return "a zone to keep out of";
        case ZoneKind::Defect:
            break;
    }
    return "a defect of the sheet";
}

using PieceIndex = std::map<std::string_view, const Piece*>;

// Smallest gap on a sheet, infinite for a single piece.
double check_sheet(const Sheet& sheet, const PieceIndex& index, const NestOptions& options) {
    const double unit = exact_unit(std::max(sheet.size.width_mm, sheet.size.height_mm));
    const auto units = [&](double mm) { return std::llround(mm / unit); };
    std::vector<PlacedRing> rings;
    for (const Placement& placement : sheet.placements) {
        const auto piece = index.find(placement.piece);
        if (piece == index.end()) {
            fail(fmt::format("piece {} was never asked for", placement.piece));
        }
        check_rotation(placement, allowed_rotations(options, *piece->second));
        rings.push_back({fmt::format("piece {}", placement.piece),
                         to_whole(placed_outline(*piece->second, placement), unit)});
    }
    const double margin_mm = edge_gap_mm(options) - kToleranceMm;
    prove_within(rings, {units(margin_mm), units(margin_mm)},
                 {units(sheet.size.width_mm - margin_mm), units(sheet.size.height_mm - margin_mm)});
    const auto gap_units = [&](double mm) {
        return std::max<std::int64_t>(0, units(mm - kToleranceMm));
    };
    if (!sheet.outline.empty()) {
        prove_inside(rings, to_whole(sheet.outline, unit), gap_units(edge_gap_mm(options)));
    }
    for (const SheetZone& zone : sheet.zones) {
        prove_clear(rings, {name_of(zone.kind), to_whole(zone.outline, unit)},
                    gap_units(zone_gap_mm(zone.kind, options)));
    }
    const double gap_mm = options.spacing_mm + options.kerf_mm - kToleranceMm;
    return unit * prove_apart(rings, std::max<std::int64_t>(0, units(gap_mm)));
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

double edge_gap_mm(const NestOptions& options) {
    return options.margin_mm + options.kerf_mm / 2.0;
}

double zone_gap_mm(ZoneKind kind, const NestOptions& options) {
    switch (kind) {
        case ZoneKind::Hole:
            return edge_gap_mm(options);
        case ZoneKind::KeepOut:
            return options.spacing_mm + options.kerf_mm;
        case ZoneKind::Defect:
            break;
    }
    return 0.0;
}

Rotations allowed_rotations(Rotation rotation) {
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

Rotations allowed_rotations(const NestOptions& options, const Piece& piece) {
    const auto own = options.piece_turns.find(piece.id);
    if (own != options.piece_turns.end()) {
        return own->second;
    }
    return options.turns.empty() ? allowed_rotations(options.rotation) : options.turns;
}

double prove_layout(const Layout& layout,
                    std::span<const Piece* const> pieces,
                    const NestOptions& options) {
    PieceIndex index;
    for (const Piece* piece : pieces) {
        index.emplace(piece->id, piece);
    }
    check_each_once(layout, index);
    double smallest = std::numeric_limits<double>::infinity();
    for (const Sheet& sheet : layout.sheets) {
        smallest = std::min(smallest, check_sheet(sheet, index, options));
    }
    return std::isfinite(smallest) ? smallest : 0.0;
}

}  // namespace leafcutter::fab
