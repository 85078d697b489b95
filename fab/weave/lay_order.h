// In which order the strips of one family are woven into those of the other, so that as few
// crossings as can be found have to be threaded.
//
// The strips of the base family lie there first. Each of the others then needs every base strip
// that lies over it folded back: possible while all that holds that base strip, from the crossing
// to one of its ends, is still to come (assembly.h). So what is woven in grows from where it began:
// a greedy search at the front, from several beginnings, takes next what needs no threading, leaves
// no gaps and lies beside the last one.

#pragma once

#include <span>
#include <vector>

#include "fab/strips/crossings.h"
#include "fab/strips/strip.h"

namespace leafcutter::fab {

struct LayProblem {
    std::span<const Strip> strips;
    const Crossings& crossings;
    // Per strip the cells before which one piece ends and the next begins, ascending; of a closed
    // strip at least one.
    std::span<const std::vector<int>> joints;
};

struct WovenIn {
    int strip = 0;
    std::vector<int> cells;  // In the order of laying; of a closed strip from its first joint on.
    std::vector<int> held;   // Those that have to be threaded.
};

struct LayOrder {
    Family base = Family::Warp;
    std::vector<WovenIn> woven;
    // Per strip of the problem: the joints that stay open until all are woven in. For those of the
    // base family only; the fewest that keep threading least.
    std::vector<std::vector<int>> open_joints;
    int threaded_crossings = 0;
    int longest_thread = 0;
    int folds = 0;  // Crossings where the base strip has to be folded back.
};

// `members`: strips of both families that cross only each other, ascending.
LayOrder find_lay_order(const LayProblem& problem, std::span<const int> members, Family base);

}  // namespace leafcutter::fab
