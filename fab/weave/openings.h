// Where closed strips are best opened so that the weave can be put together without threading.
//
// The base strips of a region that closes both ways (a torus, a pillowcase, columns that go
// through) stay open until all is woven in. Only where their ends lie near the line where weaving
// begins and ends, nothing has to be threaded.

#pragma once

#include <span>
#include <vector>

#include "fab/strips/crossings.h"
#include "fab/strips/strip.h"
#include "geometry/quads/quad_mesh.h"

namespace leafcutter::fab {

// Per strip and cell how many crossings have to be threaded under it if it is opened before that
// cell. Empty for strips where it makes no difference.
std::vector<std::vector<double>> opening_costs(const geometry::QuadMesh& mesh,
                                               std::span<const Strip> strips,
                                               const Crossings& crossings);

}  // namespace leafcutter::fab
