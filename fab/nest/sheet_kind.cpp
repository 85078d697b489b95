#include "fab/nest/sheet_kind.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "fab/clipper_paths.h"
#include "fab/nest/check.h"
#include "fab/nest/grow.h"
#include "fab/nest/shape.h"
#include "fab/nest/simple_ring.h"
#include "geometry/error.h"

namespace leafcutter::fab {

namespace {

// Kept above the wanted gap: numbers are rounded on their way into files and in the search.
constexpr double kGapGuardMm = 2e-4;
constexpr double kEdgeGuardMm = 5e-4;

constexpr double kUnitsPerMm = 1e6;
constexpr double kLargestMm = 1e6;

// An irregular outline is handed to the search as what surrounds it, in so many cells each way.
constexpr int kFrameCells = 6;

[[noreturn]] void refuse(const char* code, const std::string& what) {
    throw geometry::Error(geometry::ErrorKind::BadOption, code, what);
}

void check_sheet(const StockItem& sheet) {
    const std::string name = name_of(sheet);
    const auto is_length = [](double mm) { return mm > 0.0 && mm <= kLargestMm; };
    if (!is_length(sheet.size.width_mm) || !is_length(sheet.size.height_mm)) {
        refuse("bad-sheet", fmt::format("{}: width and height must be above 0 mm, at most {:g} mm",
                                        name, kLargestMm));
    }
    if (!(sheet.cost >= 0.0) || !std::isfinite(sheet.cost)) {
        refuse("bad-sheet", fmt::format("{}: cost must be a number and not below 0", name));
    }
    if (!sheet.outline.empty()) {
        if (const std::string fault = ring_fault(sheet.outline); !fault.empty()) {
            refuse("bad-remnant", fmt::format("{}: its outline {}", name, fault));
        }
    }
    for (std::size_t i = 0; i < sheet.zones.size(); ++i) {
        if (const std::string fault = ring_fault(sheet.zones[i].outline); !fault.empty()) {
            refuse("bad-sheet", fmt::format("{}: hole, defect or zone {} {}", name, i + 1, fault));
        }
    }
}

[[noreturn]] void refuse_too_small(const StockItem& sheet) {
    refuse(sheet.outline.empty() ? "sheet-too-small" : "remnant-too-small",
           fmt::format("nesting.margin_mm: {} is no larger than its margins", name_of(sheet)));
}

// What is left of the outline `by_mm` inside of it; by_mm < 0: outside.
std::vector<Ring> inset(const Ring& ring, double by_mm) {
    std::vector<Ring> rings;
    for (const ClipperLib::Path& part :
         mitred_offset({upright_path(ring, kUnitsPerMm)}, -by_mm * kUnitsPerMm)) {
        Ring out = ring_of(part, kUnitsPerMm);
        if (out.size() >= 3) {
            rings.push_back(std::move(out));
        }
    }
    return rings;
}

void shift(Ring& ring, double by_mm) {
    for (Eigen::Vector2d& point : ring) {
        point.array() += by_mm;
    }
}

void add_fixed(Ring ring, SheetKind& kind) {
    if (ring_fault(ring).empty()) {
        kind.fixed.push_back({std::move(ring), 0, true});
    }
}

void add_outside(const StockItem& sheet, double inset_mm, SheetKind& kind) {
    // Never outwards: mitres there would let grown pieces lean into the notches of an outline,
    // nearer to their inner corners than allowed.
    std::vector<Ring> rooms = inset(sheet.outline, std::max(0.0, inset_mm) + kEdgeGuardMm);
    if (rooms.empty()) {
        refuse_too_small(sheet);
    }
    for (Ring& room : rooms) {
        shift(room, -inset_mm);
    }
    for (Ring& ring :
         outside_of(rooms, Eigen::Vector2d::Zero(), {kind.width, kind.height}, kFrameCells)) {
        add_fixed(std::move(ring), kind);
    }
}

}  // namespace

std::string name_of(const StockItem& sheet) {
    return sheet.id.empty()
               ? fmt::format("a sheet of {:g} x {:g} mm", sheet.size.width_mm, sheet.size.height_mm)
               : fmt::format("sheet {}", sheet.id);
}

SheetGrowth growth_of(const NestOptions& options) {
    return {(options.spacing_mm + options.kerf_mm) / 2.0 + kGapGuardMm, edge_gap_mm(options)};
}

SheetKind sheet_kind(const StockItem& sheet, const NestOptions& options) {
    check_sheet(sheet);
    const SheetGrowth growth = growth_of(options);
    const double inset_mm = growth.edge_mm - growth.grow_mm;
    SheetKind kind;
    kind.width = sheet.size.width_mm - 2.0 * inset_mm;
    kind.height = sheet.size.height_mm - 2.0 * inset_mm;
    kind.quantity = sheet.quantity;
    kind.cost = sheet.cost;
    const double room = std::min(sheet.size.width_mm, sheet.size.height_mm) - 2.0 * growth.edge_mm;
    if (!(room > 0.0)) {
        refuse_too_small(sheet);
    }
    if (!sheet.outline.empty()) {
        add_outside(sheet, inset_mm, kind);
    }
    for (const SheetZone& zone : sheet.zones) {
        const double beyond = zone_gap_mm(zone.kind, options) - growth.grow_mm;
        Ring ring = grown(zone.outline, std::max(0.0, beyond) + kEdgeGuardMm);
        shift(ring, -inset_mm);
        add_fixed(std::move(ring), kind);
    }
    kind.area = std::max(usable_area(sheet), 1e-6 * kind.width * kind.height);
    return kind;
}

}  // namespace leafcutter::fab
