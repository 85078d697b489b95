// Tells closed lines on a surface apart up to free homotopy, by the traces of random matrices.
//
// Every mesh edge gets a matrix of SL(2) over a finite field such that the product round each
// triangle is the identity: then the product along a closed line depends on its homotopy class
// alone, and its trace on neither the start nor the direction. Lines that can be drawn over into
// each other always have the same trace; others don't, but for one chance in about 10^18: different
// simple closed curves have different trace functions on the representations of a surface group
// (C. Leininger, "Equivalent curves in surfaces", 2003), and those are polynomials.

#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/half_edges.h"
#include "geometry/pants/vertex_rings.h"

namespace leafcutter::geometry {

// Of determinant 1, entries modulo 2^31 - 1, by rows.
struct ModularMatrix {
    std::array<std::uint64_t, 4> entries{1, 0, 0, 1};

    ModularMatrix inverse() const;
    std::uint64_t trace() const;
    bool operator==(const ModularMatrix&) const = default;
};
ModularMatrix operator*(const ModularMatrix& a, const ModularMatrix& b);

// Two independent representations at once.
struct Holonomy {
    std::array<ModularMatrix, 2> matrices;

    Holonomy inverse() const { return {{matrices[0].inverse(), matrices[1].inverse()}}; }
    bool operator==(const Holonomy&) const = default;
};
Holonomy operator*(const Holonomy& a, const Holonomy& b);

// Equal for homotopic closed lines, either way round.
using LoopTrace = std::array<std::uint64_t, 2>;
LoopTrace trace_of(const Holonomy& holonomy);

// Per edge of `rings`, from its `from` to its `to`. The surface is connected, manifold and of
// negative Euler characteristic.
std::vector<Holonomy> random_holonomies(const HalfEdges& edges, const VertexRings& rings);

}  // namespace leafcutter::geometry
