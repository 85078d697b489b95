// Where columns cross the critical arcs.
//
// Whole numbers of columns between singular points leave a twist in most cylinders. With columns
// evenly spaced along arcs a cylinder would have to slant all of its cells to take it up. Left free
// to slide along the arcs, but for those next to singular points, the columns of all cylinders
// together slant and stretch as little as they can: the twist is taken up close to the singular
// points, and long cylinders help out short ones.

#pragma once

#include "geometry/context.h"
#include "geometry/foliation.h"
#include "geometry/quads/critical_arcs.h"
#include "geometry/quads/junction_counts.h"

namespace leafcutter::geometry {

// The network with other parameters along its arcs: those for which the corrections of g that
// conform_chart makes have the least Dirichlet energy in all. Arcs on which columns would change
// their order keep theirs.
ArcNetwork relax_arcs(const Foliation& foliation,
                      const ArcNetwork& network,
                      const JunctionCounts& counts,
                      const Context& context);

}  // namespace leafcutter::geometry
