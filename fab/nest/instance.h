// A nesting problem on its own, as the public instances state it, and its solution. Any unit of
// length.

#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "fab/nest/compaction.h"
#include "fab/nest/rotations.h"
#include "fab/strips/strip.h"
#include "geometry/context.h"

namespace leafcutter::fab {

struct InstanceItem {
    int id = 0;
    int demand = 1;
    Ring outline;  // Simple, in either orientation.
    Rotations allowed_deg;
    std::optional<int> min_quality;  // None: may lie nowhere but on faultless material.
};

struct InstanceZone {
    int quality = 0;  // 0: a hole.
    Ring outline;
};

struct InstanceBin {
    int id = 0;
    int stock = 1;
    double cost = 1.0;
    Ring outline;
    std::vector<InstanceZone> zones;  // Holes, too.
};

// Either a strip of fixed height and free width, or bins.
struct NestInstance {
    std::string name;
    std::vector<InstanceItem> items;
    double strip_height = 0.0;  // 0: bins.
    std::vector<InstanceBin> bins;
};

struct InstancePlacement {
    std::size_t item = 0;  // Index into the items.
    double rotation_deg = 0.0;
    Eigen::Vector2d offset = Eigen::Vector2d::Zero();  // After the rotation about the origin.
};

struct InstanceLayout {
    std::optional<std::size_t> bin;  // Index into the bins.
    std::vector<InstancePlacement> placed;
    double density = 0.0;  // Of the items, in the strip or the bin (without holes).
};

struct InstanceSolution {
    double strip_width = 0.0;  // Of strips.
    double density = 0.0;      // Of all items in the strip or in all bins used.
    std::vector<InstanceLayout> layouts;
    std::vector<std::size_t> unplaced;  // Items, once for each copy that fits nowhere.
    double smallest_gap = 0.0;          // Of two items, proven.
    std::int64_t evaluations = 0;
};

// Every layout is proven in whole numbers before it counts. `improved` hears of each better one.
//
// Throws Error(BadOption) if an item is no simple polygon or nothing is to be placed, naming it;
// Cancelled if stopped before there is any layout.
InstanceSolution solve(const NestInstance& instance,
                       const CompactionOptions& options,
                       const geometry::Context& context,
                       const std::function<void(const InstanceSolution&)>& improved = {});

}  // namespace leafcutter::fab
