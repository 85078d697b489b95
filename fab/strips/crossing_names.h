// Which cells of a piece carry the id of the strip that crosses there.

#pragma once

#include <span>
#include <vector>

namespace leafcutter::fab {

// A wish is fulfilled by an id on any one of its cells; better ones come first.
using NameWish = std::vector<int>;

struct CrossedCells {
    std::span<const int> numbers;  // Of the strips that cross, per cell.
    std::span<const char> under;   // The cell lies under the crossing strip.
    int every = 4;                 // Cells between two ids at most.
};

// Numbers that go up or down by one from cell to cell make a run. Each run is named at its first
// cell and at every `every` cells behind it, the last one at the piece's last cell too: whoever
// stands at any cell finds its number by counting. Cells that lie under are preferred: there ids
// don't show in the end.
std::vector<NameWish> name_wishes(const CrossedCells& cells);

}  // namespace leafcutter::fab
