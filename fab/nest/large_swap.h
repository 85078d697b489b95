// Leaves a valley: two large parts change places.

#pragma once

#include <cstddef>
#include <vector>

#include "fab/nest/board.h"
#include "fab/nest/random.h"

namespace leafcutter::fab {

class LargeSwap {
public:
    explicit LargeSwap(const BoardPlan& plan);

    // Swaps two large parts of unlike size; small ones that lie within where one goes are carried
    // to where it was.
    void apply(std::vector<Position>& positions, Random& random) const;

private:
    void carry(std::vector<Position>& positions, std::size_t first, std::size_t second) const;

    const BoardPlan& plan_;
    std::vector<std::size_t> large_;  // Items that make up three quarters of all hulls.
};

}  // namespace leafcutter::fab
