// Shrinks what a layout takes, step by step: exploration by a sequence of feasibility problems,
// then compression (sections 5 and 6 of the paper named in part.h).

#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "fab/nest/board.h"
#include "geometry/context.h"

namespace leafcutter::fab {

// A layout without overlap and the sheets it takes.
struct Packing {
    std::vector<Position> positions;
    Extent extent;
    std::int64_t evaluations = 0;  // Spent on it so far.
};

// Area of the sheets taken, the last one by its used part.
double area_taken(const BoardPlan& plan, const Extent& extent);

// The extent of area `area`, or the nearest one that can hold anything: a last sheet too narrow for
// every part is left out, the one before it is then the last.
Extent extent_of_area(const BoardPlan& plan, double area);

struct CompactionOptions {
    std::uint64_t seed = 1;
    std::int64_t max_evaluations = 2'000'000;  // Of all searches together.
    double time_s = 0.0;                       // By the context's clock; 0: no limit.
    std::size_t searches = 2;                  // From the same start, at least 1.
    std::size_t starts = 2;  // Of bands, for each of these: the best go on. More need more time.
};

struct FirstOptions {
    std::uint64_t seed = 1;
    int samples = 1000;  // Places tried for each item.
};

// Lays every item somewhere without overlap, largest first; opens sheets as needed. Items for which
// no room was found have bin -1.
Packing first_packing(const BoardPlan& plan,
                      const FirstOptions& options,
                      const geometry::Context& context);

// The smallest packing found from `start` on. `accept` decides on each improvement before it
// counts (from the calling thread): the caller's proof. A stop request ends the search early.
//
// The searches, of different random numbers, exchange what they find after equal numbers of
// evaluations: the result depends on plan, start, seed and max_evaluations (if that is what ends
// it), not on threads.
Packing compact(const BoardPlan& plan,
                Packing start,
                const CompactionOptions& options,
                const geometry::Context& context,
                const std::function<bool(const Packing&)>& accept);

}  // namespace leafcutter::fab
