// A first packing of many parts: the best of several heaps (construct.h).

#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "fab/nest/compaction.h"

namespace leafcutter::fab {

struct HeapStart {
    Packing packing;
    std::int64_t rows = 0;  // Of positions tried.
};

// Heaps in different orders, gravity towards the left edge of the sheets, which are all alike; what
// is fixed is so on each of them. The one that takes least. Parts that find no room on an empty
// sheet have bin -1. At least one heap is built, more while `rows` last. Throws Cancelled if
// stopped before there is one. The first heaps are built in this `order`; empty: longest first.
HeapStart heap_start(const BoardPlan& plan,
                     std::int64_t rows,
                     std::uint64_t seed,
                     const geometry::Context& context,
                     const std::vector<std::size_t>& order = {});

}  // namespace leafcutter::fab
