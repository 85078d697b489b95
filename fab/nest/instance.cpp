#include "fab/nest/instance.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "fab/nest/heap_start.h"
#include "fab/nest/instance_bins.h"
#include "fab/nest/instance_check.h"
#include "fab/nest/instance_proof.h"
#include "geometry/error.h"

namespace leafcutter::fab {

namespace {

// Outlines grow by this share of the largest length, so that rounding never makes two overlap.
constexpr double kGuard = 1e-6;

struct Problem {
    const NestInstance& instance;
    BoardPlan plan;
    std::vector<std::size_t> item_of;  // [copy]
    Eigen::Vector2d corner;            // Of the board, in the strip's coordinates.
    double scale = 0.0;
    double grow = 0.0;
};

void add_strip(Problem& problem) {
    const NestInstance& instance = problem.instance;
    // Side by side, everything fits in a strip of this width.
    double width = 0.0;
    for (const InstanceItem& item : instance.items) {
        width += item.demand * (bounds(item.outline).size().norm() + problem.scale * 1e-3);
    }
    problem.plan.rooms.push_back({width, instance.strip_height + 2.0 * problem.grow});
    problem.corner = Eigen::Vector2d(-problem.grow, -problem.grow);
}

Problem make_problem(const NestInstance& instance) {
    Problem problem{instance, {}, {}, {}, largest_length(instance), 0.0};
    problem.grow = kGuard * problem.scale;
    for (std::size_t i = 0; i < instance.items.size(); ++i) {
        const InstanceItem& item = instance.items[i];
        NestPart part = make_part(item.outline, problem.grow, item.allowed_deg);
        std::vector<TurnedPart> turned(item.allowed_deg.is_list() ? item.allowed_deg.size() : 0);
        for (std::size_t k = 0; k < turned.size(); ++k) {
            turn_part(part, item.allowed_deg[k], turned[k]);
        }
        problem.plan.parts.push_back(std::move(part));
        problem.plan.turned.push_back(std::move(turned));
        for (int copy = 0; copy < item.demand; ++copy) {
            problem.plan.part_of.push_back(i);
            problem.item_of.push_back(i);
        }
    }
    add_strip(problem);
    return problem;
}

InstancePlacement placement_of(const Problem& problem, std::size_t copy, const Position& at) {
    InstancePlacement out;
    out.item = problem.item_of[copy];
    out.rotation_deg = at.angle_deg;
    const Eigen::Vector2d& origin = problem.plan.part(copy).origin;
    const Ring turned = moved({origin}, {at.angle_deg, Eigen::Vector2d::Zero()});
    out.offset = Eigen::Vector2d(at.x, at.y) - turned.front() + problem.corner;
    return out;
}

InstanceSolution solution_of(const Problem& problem, const Packing& packing) {
    InstanceSolution solution;
    std::map<int, InstanceLayout> layouts;
    for (std::size_t copy = 0; copy < packing.positions.size(); ++copy) {
        const Position& at = packing.positions[copy];
        if (at.bin < 0) {
            solution.unplaced.push_back(problem.item_of[copy]);
            continue;
        }
        InstanceLayout& layout = layouts[at.bin];
        layout.placed.push_back(placement_of(problem, copy, at));
    }
    for (auto& [bin, layout] : layouts) {
        solution.layouts.push_back(std::move(layout));
    }
    prove_solution(problem.instance, solution);
    return solution;
}

// Leaves out the copies that found no room, for the search to go on without them.
void leave_out_unplaced(Problem& problem, Packing& packing, InstanceSolution& solution) {
    std::size_t kept = 0;
    for (std::size_t copy = 0; copy < packing.positions.size(); ++copy) {
        if (packing.positions[copy].bin < 0) {
            solution.unplaced.push_back(problem.item_of[copy]);
            continue;
        }
        packing.positions[kept] = packing.positions[copy];
        problem.item_of[kept] = problem.item_of[copy];
        problem.plan.part_of[kept] = problem.plan.part_of[copy];
        ++kept;
    }
    packing.positions.resize(kept);
    problem.item_of.resize(kept);
    problem.plan.part_of.resize(kept);
}

// Whether all parts turn freely and most are long bands: those stack well in heaps.
bool is_banded(const BoardPlan& plan) {
    std::size_t bands = 0;
    for (const std::size_t part : plan.part_of) {
        const NestPart& p = plan.parts[part];
        if (!p.turns_freely()) {
            return false;
        }
        bands += p.is_band() ? 1 : 0;
    }
    return 2 * bands > plan.part_of.size();
}

// Whether each part fits between the edges of an endless strip.
bool all_fit(const BoardPlan& plan) {
    const BoardPlan::Room& room = plan.rooms.front();
    return std::all_of(plan.parts.begin(), plan.parts.end(), [&](const NestPart& part) {
        return fitting_angle(make_shape(part.outline), {room.width, room.height}, part.allowed_deg)
            .has_value();
    });
}

// Heaps on sheets as wide as a strip is searched at once: a raster of an endless strip would be
// coarse, and a search that moves everything at once would get nowhere.
Packing banded_layout(BoardPlan& plan,
                      const CompactionOptions& options,
                      const geometry::Context& context) {
    const BoardPlan::Room endless = plan.rooms.front();
    double area = 0.0;
    double longest = 0.0;
    for (const std::size_t part : plan.part_of) {
        area += plan.parts[part].area;
        longest = std::max(longest, plan.parts[part].diameter);
    }
    const double wanted =
        std::max(1.5 * longest, std::min(3.0 * area / endless.height, 2.0 * endless.height));
    plan.rooms.front().width = std::min(endless.width, wanted);
    Packing packing = heap_start(plan, 1, options.seed, context).packing;
    plan.rooms.assign(static_cast<std::size_t>(packing.extent.bins), plan.rooms.front());
    return packing;
}

// One behind the other, what lay on sheets of their own.
Packing in_a_row(const std::vector<Packing>& stretches,
                 const std::vector<std::vector<std::size_t>>& items) {
    Packing whole;
    for (std::size_t k = 0; k < stretches.size(); ++k) {
        for (std::size_t i = 0; i < items[k].size(); ++i) {
            const std::size_t item = items[k][i];
            whole.positions.resize(std::max(whole.positions.size(), item + 1));
            Position& at = whole.positions[item];
            at = stretches[k].positions[i];
            at.bin = 0;
            at.x += whole.extent.last_width;
        }
        whole.extent.last_width += stretches[k].extent.last_width;
        whole.evaluations += stretches[k].evaluations;
    }
    return whole;
}

// One stretch of `count` items in all; the others are left out.
Packing alone(const Packing& stretch, const std::vector<std::size_t>& items, std::size_t count) {
    Packing packing;
    packing.extent = stretch.extent;
    packing.positions.resize(count);
    for (Position& at : packing.positions) {
        at.bin = -1;
    }
    for (std::size_t i = 0; i < items.size(); ++i) {
        packing.positions[items[i]] = stretch.positions[i];
    }
    return packing;
}

// What is thought of a packing.
struct Judge {
    std::function<bool(const Packing&)> sound;   // Of some of the items.
    std::function<bool(const Packing&)> accept;  // Of all: sound, and taken as the best so far.
};

// A strip in stretches that are searched one by one, each with its share of the work.
Packing compact_stretches(const BoardPlan& plan,
                          const Packing& start,
                          const CompactionOptions& options,
                          const geometry::Context& context,
                          const Judge& judge) {
    const auto count = static_cast<std::size_t>(start.extent.bins);
    std::vector<std::vector<std::size_t>> items(count);
    for (std::size_t item = 0; item < start.positions.size(); ++item) {
        items[static_cast<std::size_t>(start.positions[item].bin)].push_back(item);
    }
    std::vector<Packing> stretches(count);
    std::vector<BoardPlan> plans(count);
    for (std::size_t k = 0; k < count; ++k) {
        plans[k].rooms = {plan.rooms[k]};
        for (const std::size_t item : items[k]) {
            plans[k].part_of.push_back(plans[k].parts.size());
            plans[k].parts.push_back(plan.part(item));
            plans[k].turned.push_back(plan.turned[plan.part_of[item]]);
            stretches[k].positions.push_back(start.positions[item]);
            stretches[k].positions.back().bin = 0;
        }
        stretches[k].extent = {1, k + 1 == count ? start.extent.last_width : plan.rooms[k].width};
    }
    judge.accept(in_a_row(stretches, items));
    CompactionOptions share = options;
    share.max_evaluations = options.max_evaluations / start.extent.bins;
    share.time_s = options.time_s / start.extent.bins;
    for (std::size_t k = 0; k < count && !context.stop.stop_requested(); ++k) {
        geometry::Context part = context;
        part.progress = [&](std::string_view stage, double fraction) {
            context.report(stage, (static_cast<double>(k) + fraction) / static_cast<double>(count));
        };
        const Packing before = stretches[k];
        stretches[k] = compact(plans[k], before, share, part, [&](const Packing& better) {
            return judge.sound(alone(better, items[k], start.positions.size()));
        });
        if (!judge.accept(in_a_row(stretches, items))) {
            stretches[k] = before;
        }
    }
    return in_a_row(stretches, items);
}

}  // namespace

InstanceSolution solve(const NestInstance& instance,
                       const CompactionOptions& options,
                       const geometry::Context& context,
                       const std::function<void(const InstanceSolution&)>& improved) {
    check_instance(instance);
    if (!instance.bins.empty()) {
        return solve_bins(instance, options, context, improved);
    }
    Problem problem = make_problem(instance);
    const bool banded = is_banded(problem.plan) && all_fit(problem.plan);
    Packing packing = banded ? banded_layout(problem.plan, options, context)
                             : first_packing(problem.plan, {.seed = options.seed}, context);
    InstanceSolution none;
    leave_out_unplaced(problem, packing, none);
    if (packing.positions.empty()) {
        return none;
    }
    InstanceSolution best;
    const auto proven = [&](const Packing& laid) -> std::optional<InstanceSolution> {
        try {
            return solution_of(problem, laid);
        } catch (const geometry::Error&) {
            return std::nullopt;
        }
    };
    const auto accept = [&](const Packing& better) {
        std::optional<InstanceSolution> solution = proven(better);
        if (!solution) {
            return false;
        }
        best = std::move(*solution);
        best.unplaced = none.unplaced;
        if (improved) {
            improved(best);
        }
        return true;
    };
    const auto prove_first = [&] {
        if (!accept(packing)) {
            throw geometry::Error(geometry::ErrorKind::SelfCheck, "nest-proof",
                                  "nest: the first layout is not sound");
        }
    };
    Packing found;
    if (banded && packing.extent.bins > 1) {
        const Judge judge{[&](const Packing& part) { return proven(part).has_value(); }, accept};
        found = compact_stretches(problem.plan, packing, options, context, judge);
    } else {
        prove_first();
        found = compact(problem.plan, packing, options, context, accept);
    }
    best.evaluations = found.evaluations;
    return best;
}

}  // namespace leafcutter::fab
