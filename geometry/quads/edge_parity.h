// Parities of counts that must be even round every cycle of a graph: those of the edges are sums of
// labels of the nodes.

#pragma once

#include <array>
#include <span>
#include <vector>

namespace leafcutter::geometry {

struct ParityEdge {
    int from = 0;
    int to = 0;
    std::array<double, 2> cost{};  // Of an even and an odd count.
};

// The parities of the edges that cost least together. Exact up to 18 nodes in one connected part;
// beyond, no change of one or two labels would be cheaper.
std::vector<int> cheapest_parities(int nodes, std::span<const ParityEdge> edges);

}  // namespace leafcutter::geometry
