#include "fab/nest/instance_proof.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include <fmt/format.h>

#include "fab/nest/exact.h"
#include "fab/nest/instance_check.h"
#include "fab/nest/shape.h"
#include "geometry/error.h"
#include "geometry/plane.h"

namespace leafcutter::fab {

using geometry::signed_area;

namespace {

Ring placed_ring(const NestInstance& instance, const InstancePlacement& placement) {
    return moved(instance.items[placement.item].outline,
                 {placement.rotation_deg, placement.offset});
}

void prove_strip(const NestInstance& instance,
                 InstanceSolution& solution,
                 double unit,
                 std::span<const PlacedRing> rings) {
    const auto far = std::numeric_limits<std::int64_t>::max();
    prove_within(rings, {0, 0}, {far, std::llround(std::floor(instance.strip_height / unit))});
    std::int64_t right = 0;
    for (const PlacedRing& placed : rings) {
        for (const WholePoint& p : placed.ring) {
            right = std::max(right, p.x);
        }
    }
    solution.strip_width = static_cast<double>(right) * unit;
}

void prove_bin(const NestInstance& instance,
               const InstanceLayout& layout,
               double unit,
               std::span<const PlacedRing> rings) {
    const InstanceBin& bin = instance.bins[*layout.bin];
    prove_inside(rings, to_whole(bin.outline, unit));
    for (const InstanceZone& zone : bin.zones) {
        const PlacedRing obstacle{
            fmt::format("a zone of quality {} of bin {}", zone.quality, bin.id),
            to_whole(zone.outline, unit)};
        for (std::size_t i = 0; i < rings.size(); ++i) {
            const InstanceItem& item = instance.items[layout.placed[i].item];
            const bool binds =
                zone.quality <= 0 || !item.min_quality || *item.min_quality > zone.quality;
            if (binds) {
                prove_clear(rings.subspan(i, 1), obstacle);
            }
        }
    }
}

void prove_rotation(const InstanceItem& item, double rotation_deg) {
    constexpr double kToleranceDeg = 1e-9;
    if (!item.allowed_deg.allows(rotation_deg, kToleranceDeg)) {
        throw geometry::Error(
            geometry::ErrorKind::SelfCheck, "nest-proof",
            fmt::format("nest: item {} lies at a rotation that is not allowed", item.id));
    }
}

}  // namespace

void prove_solution(const NestInstance& instance, InstanceSolution& solution) {
    const double scale = largest_length(instance);
    double smallest = std::numeric_limits<double>::infinity();
    double area = 0.0;
    double room = 0.0;
    for (InstanceLayout& layout : solution.layouts) {
        double extent = 0.0;
        for (const InstancePlacement& placement : layout.placed) {
            for (const Eigen::Vector2d& p : placed_ring(instance, placement)) {
                extent = std::max(extent, p.cwiseAbs().maxCoeff());
            }
        }
        const double unit = exact_unit(std::max(extent, scale));
        std::vector<PlacedRing> rings;
        double used = 0.0;
        for (const InstancePlacement& placement : layout.placed) {
            const InstanceItem& item = instance.items[placement.item];
            prove_rotation(item, placement.rotation_deg);
            rings.push_back({fmt::format("item {}", item.id),
                             to_whole(placed_ring(instance, placement), unit)});
            used += std::abs(signed_area(item.outline));
        }
        smallest = std::min(smallest, prove_apart(rings, 0) * unit);
        if (layout.bin) {
            prove_bin(instance, layout, unit, rings);
        } else {
            prove_strip(instance, solution, unit, rings);
        }
        const double whole = layout.bin ? bin_area(instance.bins[*layout.bin])
                                        : solution.strip_width * instance.strip_height;
        layout.density = used / whole;
        area += used;
        room += whole;
    }
    solution.density = room > 0.0 ? area / room : 0.0;
    solution.smallest_gap = std::isfinite(smallest) ? smallest : 0.0;
}

double bin_area(const InstanceBin& bin) {
    double area = std::abs(signed_area(bin.outline));
    for (const InstanceZone& zone : bin.zones) {
        area -= zone.quality <= 0 ? std::abs(signed_area(zone.outline)) : 0.0;
    }
    return area;
}

}  // namespace leafcutter::fab
