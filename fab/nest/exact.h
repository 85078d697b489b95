// Proofs in whole numbers that outlines lie apart and within bounds. Shares no code with the
// searches whose layouts it judges.

#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "fab/strips/strip.h"

namespace leafcutter::fab {

// Corners in multiples of a unit, at most 2^29 from the origin: products of two products of
// differences fit 128 bits.
struct WholePoint {
    std::int64_t x = 0;
    std::int64_t y = 0;
};
using WholeRing = std::vector<WholePoint>;

// A power of two times 1e-6, fine enough for coordinates up to `extent` to keep 29 bits.
double exact_unit(double extent);

WholeRing to_whole(const Ring& ring, double unit);

struct PlacedRing {
    std::string name;  // For messages.
    WholeRing ring;
};

// The smallest distance between any two, in units; infinite if there are less than two.
//
// Throws Error(SelfCheck) if two overlap, touch or are nearer than `gap` units.
double prove_apart(std::span<const PlacedRing> rings, std::int64_t gap);

// Throws Error(SelfCheck) if a corner lies outside of [low, high].
void prove_within(std::span<const PlacedRing> rings, WholePoint low, WholePoint high);

// Throws Error(SelfCheck) if a ring is not inside of `outline`, touches it or comes nearer to it
// than `gap` units.
void prove_inside(std::span<const PlacedRing> rings,
                  const WholeRing& outline,
                  std::int64_t gap = 0);

// Throws Error(SelfCheck) if a ring overlaps or touches the obstacle, one lies in the other, or it
// is nearer than `gap` units.
void prove_clear(std::span<const PlacedRing> rings,
                 const PlacedRing& obstacle,
                 std::int64_t gap = 0);

}  // namespace leafcutter::fab
