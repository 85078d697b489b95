#include "fab/nest/compaction.h"

#include <algorithm>
#include <exception>
#include <limits>
#include <memory>
#include <numeric>
#include <thread>

#include "fab/nest/explorer.h"
#include "fab/nest/search.h"
#include "fab/nest/shake_and_press.h"
#include "geometry/error.h"

namespace leafcutter::fab {

namespace {

constexpr std::int64_t kEpoch = 20'000;
constexpr std::int64_t kPressedEpoch = 200'000;
constexpr double kSharedFrom = 0.5;  // From then on none stays behind,
constexpr double kBehind = 0.003;    // by more than this share of the area.
// How dense long bands come to lie is a matter of luck at the start: some of the searches that
// began go on from here.
constexpr double kChosenAt = 0.12;

// The narrowest box any part can have.
double narrowest(const BoardPlan& plan) {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t part = 0; part < plan.parts.size(); ++part) {
        for (const TurnedPart& turned : plan.turned[part]) {
            least = std::min(least, static_cast<double>(turned.high_x - turned.low_x));
        }
        if (plan.parts[part].turns_freely()) {
            least = std::min(least, plan.parts[part].width);
        }
    }
    return least;
}

// Presses pay where bands lie side by side, and where the board is not too large for them.
bool is_for_presses(const BoardPlan& plan) {
    constexpr std::size_t kMostPressed = 400;
    return plan.part_of.size() <= kMostPressed && is_banded(plan);
}

using Searches = std::vector<std::unique_ptr<Search>>;

Searches make_searches(const BoardPlan& plan,
                       const Packing& start,
                       bool presses,
                       const CompactionOptions& options) {
    const std::size_t count = options.searches * (presses ? options.starts : 1);
    Searches searches;
    for (std::size_t i = 0; i < count; ++i) {
        const std::uint64_t seed = options.seed * 7919 + i;
        if (presses) {
            searches.push_back(std::make_unique<ShakeAndPress>(plan, start, seed));
        } else {
            searches.push_back(std::make_unique<Explorer>(plan, start, seed));
        }
    }
    return searches;
}

// Evaluations of each search between two exchanges. Presses take many at once, and threads wait for
// each other after each epoch; but a short search must end in time.
std::int64_t epoch_of(const Searches& searches, bool presses, std::int64_t spent) {
    const auto count = static_cast<std::int64_t>(searches.size());
    return presses ? std::clamp(spent / (10 * count), kEpoch, kPressedEpoch) : kEpoch;
}

// Runs all searches for an epoch, on as many threads as allowed.
void run_epoch(Searches& searches,
               std::int64_t evaluations,
               double progress,
               const geometry::Context& context) {
    std::vector<std::exception_ptr> failures(searches.size());
    const std::size_t threads =
        std::clamp<std::size_t>(context.threads, 1, std::max<std::size_t>(searches.size(), 1));
    const auto run = [&](std::size_t thread) {
        for (std::size_t i = thread; i < searches.size(); i += threads) {
            try {
                searches[i]->advance(evaluations, progress, context.stop);
            } catch (...) {
                failures[i] = std::current_exception();
            }
        }
    };
    {
        std::vector<std::jthread> others;
        for (std::size_t thread = 1; thread < threads; ++thread) {
            others.emplace_back(run, thread);
        }
        run(0);
    }
    for (const std::exception_ptr& failure : failures) {
        if (failure) {
            std::rethrow_exception(failure);
        }
    }
}

std::int64_t evaluations_of(const Searches& searches) {
    std::int64_t sum = 0;
    for (const auto& search : searches) {
        sum += search->evaluations();
    }
    return sum;
}

// Only the best `count` go on. Returns the work of the others.
std::int64_t choose(Searches& searches, std::size_t count) {
    const std::int64_t before = evaluations_of(searches);
    std::stable_sort(searches.begin(), searches.end(),
                     [](const auto& a, const auto& b) { return a->best_area() < b->best_area(); });
    searches.resize(count);
    return before - evaluations_of(searches);
}

// The one that found the smallest packing below `area`, if any.
Search* ahead_of(const Searches& searches, double area) {
    Search* ahead = nullptr;
    for (const auto& search : searches) {
        if (search->best_area() < area) {
            ahead = search.get();
            area = search->best_area();
        }
    }
    return ahead;
}

// Those behind by more than a share of the area go on from the best.
void catch_up(const Searches& searches, const Packing& best, double area, double behind) {
    for (const auto& search : searches) {
        if (!search->wanders() && search->best_area() > area * (1.0 + behind)) {
            search->adopt(best);
        }
    }
}

// A strip without end starts at what its parts need if they fill it by half.
double first_width(const BoardPlan& plan) {
    const BoardPlan::Room& room = plan.rooms.front();
    if (plan.rooms.size() > 1) {
        return room.width;
    }
    double area = 0.0;
    for (const std::size_t part : plan.part_of) {
        area += plan.parts[part].area;
    }
    return std::min(room.width, 2.0 * area / room.height);
}

// More room: a wider last sheet, or one more. False if there is none.
bool widen(const BoardPlan& plan, Extent& extent) {
    const double whole = plan.rooms[static_cast<std::size_t>(extent.bins) - 1].width;
    if (extent.last_width < whole) {
        extent.last_width = std::min(whole, 1.2 * extent.last_width);
        return true;
    }
    if (extent.bins == static_cast<int>(plan.rooms.size())) {
        return false;
    }
    ++extent.bins;
    extent.last_width = plan.rooms[static_cast<std::size_t>(extent.bins) - 1].width;
    return true;
}

}  // namespace

double area_taken(const BoardPlan& plan, const Extent& extent) {
    double area = 0.0;
    for (int bin = 0; bin + 1 < extent.bins; ++bin) {
        const BoardPlan::Room& room = plan.rooms[static_cast<std::size_t>(bin)];
        area += room.width * room.height;
    }
    return area + extent.last_width * plan.rooms[static_cast<std::size_t>(extent.bins) - 1].height;
}

Extent extent_of_area(const BoardPlan& plan, double area) {
    const double least = narrowest(plan);
    Extent extent{0, 0.0};
    double left = area;
    for (const BoardPlan::Room& room : plan.rooms) {
        const double width = std::min(room.width, left / room.height);
        if (extent.bins > 0 && width < least) {
            break;
        }
        ++extent.bins;
        extent.last_width = width;
        left -= width * room.height;
    }
    return extent;
}

Packing first_packing(const BoardPlan& plan,
                      const FirstOptions& options,
                      const geometry::Context& context) {
    std::vector<std::size_t> order(plan.part_of.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    const auto size = [&](std::size_t item) {
        return plan.part(item).hull_area * plan.part(item).diameter;
    };
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return size(a) > size(b); });
    Random random(options.seed);
    Board board(plan);
    PoseSearch search(board, random);
    // Items not yet laid wait far outside, in nobody's way.
    std::vector<Position> positions(order.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
        const NestPart& part = plan.part(i);
        positions[i].angle_deg =
            part.turns_freely() ? part.allowed_deg.nearest(0.0) : part.allowed_deg.front();
        positions[i].x = -1e6 * (1.0 + static_cast<double>(i));
    }
    Extent extent{1, first_width(plan)};
    board.restore(positions, extent);
    for (const std::size_t item : order) {
        context.check();
        Candidate found = search.leftmost(item, options.samples);
        while (found.loss > 0.0F && widen(plan, extent)) {
            positions = board.positions();
            board.restore(positions, extent);
            found = search.leftmost(item, options.samples);
        }
        if (found.loss <= 0.0F) {
            board.move(item, found.position);
        }
    }
    Packing packing{board.positions(), extent};
    double right = 0.0;
    for (std::size_t item = 0; item < board.items(); ++item) {
        Position& at = packing.positions[item];
        if (at.x < -1e5) {
            at.bin = -1;
        } else if (at.bin + 1 == extent.bins) {
            right = std::max(right, at.x + static_cast<double>(board.shape(item).high_x));
        }
    }
    packing.extent.last_width = std::min(extent.last_width, right * (1.0 + 1e-6));
    return packing;
}

Packing compact(const BoardPlan& plan,
                Packing start,
                const CompactionOptions& options,
                const geometry::Context& context,
                const std::function<bool(const Packing&)>& accept) {
    const bool presses = is_for_presses(plan);
    Searches searches = make_searches(plan, start, presses, options);
    Packing best = std::move(start);
    double best_area = area_taken(plan, best.extent);
    const double begun_s = context.now_s();
    std::int64_t given_up = 0;
    std::int64_t spent = 0;
    std::int64_t idle_epochs = 0;
    for (;;) {
        const double by_work =
            static_cast<double>(spent) / static_cast<double>(options.max_evaluations);
        const double by_time =
            options.time_s > 0.0 ? (context.now_s() - begun_s) / options.time_s : 0.0;
        const double progress = std::max(by_work, by_time);
        if (progress >= 1.0 || idle_epochs > 3) {
            return best;
        }
        try {
            context.report("nest", progress);
            const std::int64_t left =
                (options.max_evaluations - spent) / static_cast<std::int64_t>(searches.size()) + 1;
            const std::int64_t epoch = epoch_of(searches, presses, spent);
            run_epoch(searches, std::min(epoch, left), progress, context);
        } catch (const geometry::Cancelled&) {
            return best;
        }
        const std::int64_t done = given_up + evaluations_of(searches);
        Search* const ahead = ahead_of(searches, best_area);
        idle_epochs = done == spent ? idle_epochs + 1 : 0;
        spent = done;
        best.evaluations = spent;
        if (ahead != nullptr && accept(ahead->best())) {
            best = ahead->best();
            best.evaluations = spent;
            best_area = ahead->best_area();
        } else if (ahead != nullptr) {
            ahead->adopt(best);
        }
        if (progress >= kSharedFrom) {
            catch_up(searches, best, best_area, presses ? kBehind : 0.0);
        }
        if (progress >= kChosenAt && searches.size() > options.searches) {
            given_up += choose(searches, options.searches);
        }
    }
}

}  // namespace leafcutter::fab
