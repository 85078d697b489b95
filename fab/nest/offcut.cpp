// An offcut is what an opening (by a disc's worth of width) leaves of the free part of a sheet.

#include "fab/nest/offcut.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include <polyclipping/clipper.hpp>

#include "fab/clipper_paths.h"
#include "fab/nest/free_rectangle.h"
#include "geometry/plane.h"

namespace leafcutter::fab {

using geometry::signed_area;

namespace {

constexpr double kUnitsPerMm = 1e5;
constexpr double kNarrowestMm = 30.0;
constexpr double kShortestMm = 60.0;
constexpr double kSimplerMm = 0.1;  // Corners may move by that much, towards the pieces.

ClipperLib::Paths clipped(const ClipperLib::Paths& subject,
                          const ClipperLib::Paths& clip,
                          ClipperLib::ClipType type) {
    ClipperLib::Clipper clipper;
    clipper.AddPaths(subject, ClipperLib::ptSubject, true);
    clipper.AddPaths(clip, ClipperLib::ptClip, true);
    ClipperLib::Paths out;
    clipper.Execute(type, out, ClipperLib::pftNonZero, ClipperLib::pftNonZero);
    return out;
}

Ring outline_of(const SheetSize& size, const Ring& outline) {
    if (!outline.empty()) {
        return outline;
    }
    return {
        {0.0, 0.0}, {size.width_mm, 0.0}, {size.width_mm, size.height_mm}, {0.0, size.height_mm}};
}

// Without its parts narrower than `width_mm`.
ClipperLib::Paths opened(const ClipperLib::Paths& paths, double width_mm) {
    const double by = width_mm / 2.0 * kUnitsPerMm;
    // A mitre may reach further than what was there.
    return clipped(mitred_offset(mitred_offset(paths, -by), by), paths, ClipperLib::ctIntersection);
}

using PieceIndex = std::map<std::string_view, const Piece*>;

ClipperLib::Paths free_part(const Sheet& sheet, const PieceIndex& index, double kerf_mm) {
    ClipperLib::Paths taken;
    for (const Placement& placement : sheet.placements) {
        Ring ring;
        for (const Eigen::Vector2d& point : index.at(placement.piece)->outline) {
            ring.push_back(placement.apply(point));
        }
        const ClipperLib::Paths grown = mitred_offset({upright_path(ring, kUnitsPerMm)},
                                                      (kerf_mm + 2.0 * kSimplerMm) * kUnitsPerMm);
        taken.insert(taken.end(), grown.begin(), grown.end());
    }
    for (const SheetZone& zone : sheet.zones) {
        if (zone.kind != ZoneKind::KeepOut) {
            taken.push_back(upright_path(zone.outline, kUnitsPerMm));
        }
    }
    return clipped({upright_path(outline_of(sheet.size, sheet.outline), kUnitsPerMm)}, taken,
                   ClipperLib::ctDifference);
}

std::optional<Ring> simpler(ClipperLib::Path path) {
    ClipperLib::CleanPolygon(path, kSimplerMm * kUnitsPerMm);
    if (path.size() < 3) {
        return std::nullopt;
    }
    return ring_of(path, kUnitsPerMm);
}

// An outer contour and the holes in it.
std::optional<Offcut> offcut_of(const ClipperLib::PolyNode& node) {
    const std::optional<Ring> outline = simpler(node.Contour);
    if (!outline) {
        return std::nullopt;
    }
    Offcut offcut;
    offcut.outline = *outline;
    offcut.area_mm2 = std::abs(signed_area(offcut.outline));
    std::vector<Ring> rings = {offcut.outline};
    for (const ClipperLib::PolyNode* child : node.Childs) {
        if (std::optional<Ring> hole = simpler(child->Contour)) {
            std::reverse(hole->begin(), hole->end());
            offcut.area_mm2 -= std::abs(signed_area(*hole));
            rings.push_back(*hole);
            offcut.holes.push_back(std::move(*hole));
        }
    }
    const FreeRectangle rectangle = largest_rectangle_in(rings);
    offcut.corner = rectangle.corner;
    offcut.rectangle = rectangle.size;
    const auto [narrow, wide] = std::minmax(rectangle.size.width_mm, rectangle.size.height_mm);
    if (narrow < kNarrowestMm || wide < kShortestMm) {
        return std::nullopt;
    }
    return offcut;
}

std::optional<Offcut> largest_offcut(const ClipperLib::Paths& paths) {
    ClipperLib::Clipper clipper;
    clipper.AddPaths(paths, ClipperLib::ptSubject, true);
    ClipperLib::PolyTree tree;
    clipper.Execute(ClipperLib::ctUnion, tree, ClipperLib::pftNonZero, ClipperLib::pftNonZero);
    std::optional<Offcut> best;
    for (const ClipperLib::PolyNode* node = tree.GetFirst(); node != nullptr;
         node = node->GetNext()) {
        if (node->IsHole()) {
            continue;
        }
        std::optional<Offcut> offcut = offcut_of(*node);
        if (offcut && (!best || offcut->area_mm2 > best->area_mm2)) {
            best = std::move(offcut);
        }
    }
    return best;
}

}  // namespace

FreeRectangle largest_rectangle(const StockItem& sheet) {
    std::vector<Ring> rings = {outline_of(sheet.size, sheet.outline)};
    for (const SheetZone& zone : sheet.zones) {
        rings.push_back(zone.outline);
    }
    return largest_rectangle_in(rings);
}

void add_offcuts(Layout& layout, std::span<const Piece* const> pieces, double kerf_mm) {
    PieceIndex index;
    for (const Piece* piece : pieces) {
        index.emplace(piece->id, piece);
    }
    for (Sheet& sheet : layout.sheets) {
        sheet.offcut = largest_offcut(opened(free_part(sheet, index, kerf_mm), kNarrowestMm));
    }
}

}  // namespace leafcutter::fab
