// Proves a layout from its outlines alone, independent of how it was made.

#pragma once

#include <span>

#include "fab/layout.h"
#include "fab/nest/nest.h"

namespace leafcutter::fab {

// The smallest distance between two outlines of a sheet, over all sheets; 0 if no sheet holds two.
//
// Throws Error(SelfCheck) if a piece is missing or placed twice, leaves its sheet's margin, comes
// too near to a hole, defect or zone to keep out of, lies at a rotation that is not allowed, or two
// are closer than spacing + kerf.
double prove_layout(const Layout& layout,
                    std::span<const Piece* const> pieces,
                    const NestOptions& options);

// What pieces keep from a sheet's edge, and from a zone of it.
double edge_gap_mm(const NestOptions& options);
double zone_gap_mm(ZoneKind kind, const NestOptions& options);

Rotations allowed_rotations(Rotation rotation);
Rotations allowed_rotations(const NestOptions& options, const Piece& piece);

}  // namespace leafcutter::fab
