// What crosses each strip, cell by cell.

#pragma once

#include <span>
#include <vector>

#include "fab/strips/strip.h"
#include "fab/weave/weave.h"

namespace leafcutter::fab {

struct Crossing {
    int strip = 0;        // The strip that crosses, into the list of all strips.
    int cell = 0;         // Its cell there, into its quads.
    bool on_top = false;  // The strip that is crossed lies on top (outside).
};

// Per strip, per cell in walking order.
using Crossings = std::vector<std::vector<Crossing>>;

Crossings crossings_of(std::span<const Strip> strips, const Weave& weave);

}  // namespace leafcutter::fab
