#include "fab/nest/instance_check.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include <fmt/format.h>

#include "fab/nest/shape.h"
#include "fab/nest/simple_ring.h"
#include "geometry/error.h"

namespace leafcutter::fab {

namespace {

// Beyond it, differences of coordinates lose what a layout is about.
constexpr double kLargestCoordinate = 1e9;

constexpr int kMostItems = 1'000'000;

[[noreturn]] void refuse(const std::string& what) {
    throw geometry::Error(geometry::ErrorKind::BadOption, "bad-instance", what);
}

void check_ring(const Ring& ring, const std::string& whose) {
    for (const Eigen::Vector2d& point : ring) {
        if (!(point.cwiseAbs().maxCoeff() <= kLargestCoordinate)) {
            refuse(fmt::format("{}: coordinates must lie within ±{:g}; scale the problem", whose,
                               kLargestCoordinate));
        }
    }
    if (const std::string fault = ring_fault(ring); !fault.empty()) {
        refuse(fmt::format("{}: {}", whose, fault));
    }
}

template <typename Things>
void check_ids(const Things& things, const char* what) {
    std::set<int> ids;
    for (const auto& thing : things) {
        if (!ids.insert(thing.id).second) {
            refuse(
                fmt::format("{} {}: this id is there twice; number them differently, or raise "
                            "the first one's {}",
                            what, thing.id, what[0] == 'i' ? "demand" : "stock"));
        }
    }
}

void check_items(const NestInstance& instance) {
    int count = 0;
    for (const InstanceItem& item : instance.items) {
        check_ring(item.outline, fmt::format("item {}", item.id));
        if (item.demand < 0 || item.demand > kMostItems - count) {
            refuse(fmt::format("item {}: demand must not be below 0, nor all together above {}",
                               item.id, kMostItems));
        }
        count += item.demand;
    }
    if (count == 0) {
        refuse("items: there is nothing to nest; some demand must be above 0");
    }
    check_ids(instance.items, "item");
}

void check_strip(const NestInstance& instance) {
    if (!(instance.strip_height > 0.0) || instance.strip_height > kLargestCoordinate) {
        refuse(fmt::format("strip_height: must be above 0, at most {:g}", kLargestCoordinate));
    }
    for (const InstanceItem& item : instance.items) {
        // As long as it likes.
        const double length = 4.0 * bounds(item.outline).size().norm();
        const bool fits = fitting_angle(make_shape(item.outline), {length, instance.strip_height},
                                        item.allowed_deg)
                              .has_value();
        if (item.demand > 0 && !fits) {
            const Eigen::Vector2d size = bounds(item.outline).size();
            refuse(
                fmt::format("item {}: {:g} x {:g} is too large for a strip of height {:g} at "
                            "every allowed rotation; raise strip_height or allow more rotations",
                            item.id, size.x(), size.y(), instance.strip_height));
        }
    }
}

void check_bins(const NestInstance& instance) {
    int stock = 0;
    for (const InstanceBin& bin : instance.bins) {
        const std::string name = fmt::format("bin {}", bin.id);
        check_ring(bin.outline, name);
        for (std::size_t i = 0; i < bin.zones.size(); ++i) {
            const bool hole = bin.zones[i].quality <= 0;
            check_ring(bin.zones[i].outline,
                       fmt::format("{}: {} {}", name, hole ? "hole" : "zone", i + 1));
        }
        if (!(bin.cost >= 0.0) || bin.cost > 1e12) {
            refuse(fmt::format("{}: cost must be a number and not below 0", name));
        }
        stock += std::clamp(bin.stock, 0, kMostItems);
    }
    if (stock == 0) {
        refuse("bins: there is nothing to nest on; some stock must be above 0");
    }
    check_ids(instance.bins, "bin");
}

}  // namespace

double largest_length(const NestInstance& instance) {
    double scale = instance.strip_height;
    for (const InstanceItem& item : instance.items) {
        scale = std::max(scale, bounds(item.outline).size().norm());
    }
    for (const InstanceBin& bin : instance.bins) {
        scale = std::max(scale, bounds(bin.outline).size().maxCoeff());
    }
    return scale;
}

void check_instance(const NestInstance& instance) {
    check_items(instance);
    if (instance.bins.empty()) {
        if (instance.strip_height == 0.0) {
            refuse("strip_height or bins: there is nothing to nest on");
        }
        check_strip(instance);
    } else {
        check_bins(instance);
    }
}

}  // namespace leafcutter::fab
