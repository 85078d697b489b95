// Weights changed a little so that cylinders meet in whole columns: numbers of cells that fit
// together are chosen for the foliation as it is, then the map is solved again with weights that
// make the cylinders' circumferences, and through them the critical arcs, as long as that.

#pragma once

#include <functional>

#include "geometry/context.h"
#include "geometry/foliation.h"
#include "geometry/pants/hierarchy.h"
#include "geometry/pants/tree_word.h"

namespace leafcutter::geometry {

// The foliation that a map of the coarsest level leads to.
using Refoliate = std::function<Foliation(const GraphMap& coarse)>;

// Where a foliation came from: the solved map of the coarsest level, and the way up from there.
struct Origin {
    const Hierarchy::Level& level;
    const GraphMap& coarse;
    const Refoliate& refoliate;
};

// A foliation by pants whose junctions suit the aim better, or `foliation` itself. Weights that the
// user gave move by up to 5 % against each other, automatic ones by 15 %. Throws what `refoliate`
// throws but SelfCheck errors.
Foliation with_whole_columns(Foliation foliation,
                             const Origin& origin,
                             const FoliationOptions& options,
                             const Context& context);

}  // namespace leafcutter::geometry
