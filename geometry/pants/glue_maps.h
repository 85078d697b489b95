// Puts the maps of the pieces of a cut surface together to one of the whole.

#pragma once

#include <span>
#include <vector>

#include "geometry/loops/cut_along.h"
#include "geometry/pants/tree_word.h"
#include "geometry/pants/vertex_rings.h"

namespace leafcutter::geometry {

struct MappedPiece {
    CutPiece piece;
    VertexRings rings;  // Of the piece.
    GraphMap map;       // All weights 1; loops of the piece are fixed at end nodes.
};

// The two legs that end in the two sides of cut k become graph edge k, with the cut's vertices, not
// fixed, in its middle. `rings` are those of the whole surface.
GraphMap glue_maps(std::span<const MappedPiece> pieces, std::size_t cuts, const VertexRings& rings);

}  // namespace leafcutter::geometry
