// Handle and tunnel loops of a surface in space (section 3.2): loops that are contractible inside
// it and outside it.
//
// Told apart by linking numbers: a handle loop has linking number 0 with every loop pushed out of
// the solid, a tunnel loop with every loop pushed into it. The classes of either kind are a
// subgroup of rank g of the first homology, each its own annihilator under intersection; which
// loops stand for them is a choice, and short ones are chosen. After T. Dey, K. Li, J. Sun, "On
// computing handle and tunnel loops", 2007, with linking numbers instead of a volume mesh.

#pragma once

#include <vector>

#include "geometry/context.h"
#include "geometry/pants/decomposition.h"

namespace leafcutter::geometry {

// Simple closed vertex cycles, those of one kind disjoint from each other; as many of a kind as the
// surface has handles. Cutting along one kind leaves a sphere with holes.
struct LoopSystem {
    std::vector<std::vector<int>> handle;
    std::vector<std::vector<int>> tunnel;
    // False: inside and outside could not be told apart, as where the surface passes through
    // itself. Then the kinds are only dual to each other.
    bool embedded = true;
};

// Boundary loops are thought closed by caps. Throws Error(SelfCheck, "handle-loops") if some of the
// loops can't be found on this triangulation.
LoopSystem find_loops(const DecompositionSurface& surface, const Context& context);

}  // namespace leafcutter::geometry
