#include "fab/nest/instance.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <map>
#include <optional>
#include <thread>

#include "fab/nest/bend_order.h"
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

// Whether each part fits between the edges of an endless strip.
bool all_fit(const BoardPlan& plan) {
    const BoardPlan::Room& room = plan.rooms.front();
    return std::all_of(plan.parts.begin(), plan.parts.end(), [&](const NestPart& part) {
        return fitting_angle(make_shape(part.outline), {room.width, room.height}, part.allowed_deg)
            .has_value();
    });
}

// Of a long strip: what bends alike is laid on the same sheet, or near each other.
std::vector<std::size_t> heap_order(const BoardPlan& plan, double area) {
    constexpr double kFilled = 0.5;  // Of a sheet, by a heap.
    constexpr std::size_t kLeast = 8;
    const BoardPlan::Room& sheet = plan.rooms.front();
    const auto sheets = static_cast<std::size_t>(area / (kFilled * sheet.width * sheet.height));
    return sheets < 2 ? std::vector<std::size_t>{} : by_bend(plan, std::max(sheets, kLeast));
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
    Packing packing = heap_start(plan, 1, options.seed, context, heap_order(plan, area)).packing;
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

// A strip in stretches, each with items and a sheet of its own.
struct Stretches {
    std::vector<std::vector<std::size_t>> items;
    std::vector<Packing> packings;
    std::vector<BoardPlan> plans;
};

Stretches stretches_of(const BoardPlan& plan, const Packing& start) {
    const auto count = static_cast<std::size_t>(start.extent.bins);
    Stretches out{std::vector<std::vector<std::size_t>>(count), std::vector<Packing>(count),
                  std::vector<BoardPlan>(count)};
    for (std::size_t item = 0; item < start.positions.size(); ++item) {
        out.items[static_cast<std::size_t>(start.positions[item].bin)].push_back(item);
    }
    for (std::size_t k = 0; k < count; ++k) {
        BoardPlan& own = out.plans[k];
        own.rooms = {plan.rooms[k]};
        for (const std::size_t item : out.items[k]) {
            own.part_of.push_back(own.parts.size());
            own.parts.push_back(plan.part(item));
            own.turned.push_back(plan.turned[plan.part_of[item]]);
            out.packings[k].positions.push_back(start.positions[item]);
            out.packings[k].positions.back().bin = 0;
        }
        const bool last = k + 1 == count;
        out.packings[k].extent = {1, last ? start.extent.last_width : plan.rooms[k].width};
    }
    return out;
}

// Calls `work` for both, at once if two threads may be used; the first by the calling thread.
template <typename Work>
void for_both(std::size_t first, std::size_t second, bool at_once, Work work) {
    std::exception_ptr failure;
    {
        std::jthread other;
        const auto guarded = [&] {
            try {
                work(second);
            } catch (...) {
                failure = std::current_exception();
            }
        };
        if (at_once && second != first) {
            other = std::jthread(guarded);
        }
        work(first);
        if (!at_once && second != first) {
            guarded();
        }
    }
    if (failure) {
        std::rethrow_exception(failure);
    }
}

// The stretches are searched with equal shares of the work: few one by one, each by two searches,
// many in pairs, by one search each from one start, since they have little time.
Packing compact_stretches(const BoardPlan& plan,
                          const Packing& start,
                          const CompactionOptions& options,
                          const geometry::Context& context,
                          const Judge& judge) {
    constexpr std::size_t kMany = 4;
    const Stretches whole = stretches_of(plan, start);
    const std::size_t count = whole.plans.size();
    const std::size_t step = count >= kMany ? 2 : 1;
    const bool at_once = step == 2 && context.threads > 1;
    CompactionOptions share = options;
    share.searches = step == 2 ? 1 : options.searches;
    share.starts = step == 2 ? 1 : options.starts;
    share.max_evaluations = options.max_evaluations / start.extent.bins;
    const double rounds = std::ceil(static_cast<double>(count) / (at_once ? 2.0 : 1.0));
    share.time_s = options.time_s / rounds;
    std::vector<Packing> found = whole.packings;
    judge.accept(in_a_row(found, whole.items));
    for (std::size_t k = 0; k < count && !context.stop.stop_requested(); k += step) {
        const std::vector<Packing> before = found;
        const std::size_t next = std::min(k + step, count);
        for_both(k, next - 1, at_once, [&](std::size_t i) {
            geometry::Context part = context;
            part.threads = step == 2 ? 1 : context.threads;
            part.progress = nullptr;
            if (i == k) {
                part.progress = [&](std::string_view stage, double fraction) {
                    const double done = fraction * static_cast<double>(next - k);
                    context.report(stage,
                                   (static_cast<double>(k) + done) / static_cast<double>(count));
                };
            }
            found[i] = compact(whole.plans[i], before[i], share, part, [&](const Packing& better) {
                return judge.sound(alone(better, whole.items[i], start.positions.size()));
            });
        });
        if (!judge.accept(in_a_row(found, whole.items))) {
            found = before;
        }
    }
    return in_a_row(found, whole.items);
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
