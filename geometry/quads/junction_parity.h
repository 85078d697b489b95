// Whether cells alternate in two colours across critical leaves.
//
// Where all circumferences are even, colours alternate round every end of a cylinder, and round
// every singular point of the critical graph. So one connected part of it, a node, leaves a single
// choice, and a cylinder between two nodes only asks for the parity of its number of rows: the
// whole surface can always be coloured.

#pragma once

#include <array>
#include <optional>
#include <vector>

#include "geometry/quads/critical_arcs.h"

namespace leafcutter::geometry {

// Per cylinder and end the colour, 0 or 1, of the cell at its first vertex, with the end's node
// coloured one of its two ways; 0 where the end is open.
using EndColours = std::vector<std::array<int, 2>>;

// `arc_cells` gives even circumferences. Throws Error(SelfCheck, "junction-colours") else.
EndColours colour_ends(const ArcNetwork& network, const std::vector<int>& arc_cells);

// What an even (0) or odd (1) number of rows costs a cylinder.
using ParityCost = std::array<double, 2>;

// The parity of rows of each cylinder, none where it is free, so that colours alternate everywhere:
// the cheapest over all ways to colour the nodes. `costs` and `twists` are per cylinder.
std::vector<std::optional<int>> choose_row_parities(const ArcNetwork& network,
                                                    const EndColours& colours,
                                                    const std::vector<int>& twists,
                                                    const std::vector<ParityCost>& costs);

}  // namespace leafcutter::geometry
