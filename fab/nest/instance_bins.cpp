#include "fab/nest/instance_bins.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "fab/nest/grow.h"
#include "fab/nest/instance_check.h"
#include "fab/nest/instance_proof.h"
#include "fab/nest/sheet_search.h"
#include "geometry/error.h"

namespace leafcutter::fab {

namespace {

// Outlines grow by this share of the largest length, so that rounding never makes two overlap.
constexpr double kGuard = 1e-6;

// An irregular outline is handed to the search as what surrounds it, in so many cells each way.
constexpr int kFrameCells = 4;

Ring shifted(const Ring& ring, const Eigen::Vector2d& by) {
    Ring out = ring;
    for (Eigen::Vector2d& point : out) {
        point += by;
    }
    return out;
}

SheetKind kind_of(const InstanceBin& bin) {
    const Box box = bounds(bin.outline);
    const Eigen::Vector2d size = box.size();
    SheetKind kind;
    kind.width = size.x();
    kind.height = size.y();
    kind.quantity = bin.stock;
    kind.cost = bin.cost;
    kind.area = bin_area(bin);
    const Ring outline = shifted(bin.outline, -box.low);
    for (Ring& ring : outside_of({&outline, 1}, Eigen::Vector2d::Zero(), size, kFrameCells)) {
        kind.fixed.push_back({std::move(ring), 0, true});
    }
    for (const InstanceZone& zone : bin.zones) {
        kind.fixed.push_back({shifted(zone.outline, -box.low), zone.quality, zone.quality <= 0});
    }
    return kind;
}

class BinSearch {
public:
    explicit BinSearch(const NestInstance& instance) : instance_(instance) {
        const double grow = kGuard * largest_length(instance);
        for (std::size_t i = 0; i < instance.items.size(); ++i) {
            const InstanceItem& item = instance.items[i];
            NestPart part = make_part(item.outline, grow, item.allowed_deg);
            part.min_quality = item.min_quality.value_or(std::numeric_limits<int>::max());
            problem_.parts.push_back(std::move(part));
            problem_.part_of.insert(problem_.part_of.end(), static_cast<std::size_t>(item.demand),
                                    i);
        }
        for (std::size_t i = 0; i < instance.bins.size(); ++i) {
            if (instance.bins[i].stock > 0) {
                problem_.kinds.push_back(kind_of(instance.bins[i]));
                bin_of_.push_back(i);
            }
        }
    }

    InstanceSolution run(const CompactionOptions& options,
                         const geometry::Context& context,
                         const std::function<void(const InstanceSolution&)>& improved) {
        InstanceSolution best;
        search_sheets(problem_, options, context, [&](const SheetPacking& packing) {
            try {
                best = solution_of(packing);
            } catch (const geometry::Error&) {
                return false;
            }
            if (improved) {
                improved(best);
            }
            return true;
        });
        return best;
    }

private:
    InstancePlacement placement_of(std::size_t copy, const Position& at, std::size_t bin) const {
        InstancePlacement out;
        out.item = problem_.part_of[copy];
        out.rotation_deg = at.angle_deg;
        const Eigen::Vector2d& origin = problem_.parts[out.item].origin;
        const Ring turned = moved({origin}, {at.angle_deg, Eigen::Vector2d::Zero()});
        out.offset =
            Eigen::Vector2d(at.x, at.y) - turned.front() + bounds(instance_.bins[bin].outline).low;
        return out;
    }

    InstanceSolution solution_of(const SheetPacking& packing) const {
        InstanceSolution solution;
        for (const std::size_t kind : packing.kinds) {
            solution.layouts.emplace_back();
            solution.layouts.back().bin = bin_of_[kind];
        }
        for (std::size_t copy = 0; copy < packing.positions.size(); ++copy) {
            const Position& at = packing.positions[copy];
            if (at.bin < 0) {
                solution.unplaced.push_back(problem_.part_of[copy]);
                continue;
            }
            InstanceLayout& layout = solution.layouts[static_cast<std::size_t>(at.bin)];
            layout.placed.push_back(placement_of(copy, at, *layout.bin));
        }
        prove_solution(instance_, solution);
        return solution;
    }

    const NestInstance& instance_;
    SheetProblem problem_;
    std::vector<std::size_t> bin_of_;  // [kind]
};

}  // namespace

InstanceSolution solve_bins(const NestInstance& instance,
                            const CompactionOptions& options,
                            const geometry::Context& context,
                            const std::function<void(const InstanceSolution&)>& improved) {
    return BinSearch(instance).run(options, context, improved);
}

}  // namespace leafcutter::fab
