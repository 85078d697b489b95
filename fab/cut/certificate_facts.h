// What certify (certificate.h) found.

#pragma once

#include <string>
#include <vector>

namespace leafcutter::fab {

struct Certificate {
    bool holds = false;                       // Nothing in `faults`.
    double largest_deviation_relative = 0.0;  // Of the diagonal of the quad mesh; 1 where pieces
                                              // are missing, for nothing was rebuilt there.
    double largest_deviation_mm = 0.0;        // Of a vertex rebuilt from where it is planned.
    double diagonal_mm = 0.0;                 // Of the box round the quad mesh.
    int edges_compared = 0;                   // Lengths measured on pieces, diagonals too.
    double largest_length_error_mm = 0.0;     // Of those, against the quad mesh.
    double largest_disagreement_mm = 0.0;     // Between weft and warp on one length.
    double largest_outline_error_mm = 0.0;    // Of a burnt contour from its planned outline.
    double largest_tick_error_mm = 0.0;       // Of where a tick points from its rung's end.
    int ticks = 0;                            // Rung ends that a tick points at.

    std::string matched_by;  // "ids", "ids and shapes", "shapes", "nothing".
    int pieces = 0;          // Planned.
    int matched_by_id = 0;
    int matched_by_shape = 0;  // Their ids were not there or could not be read.
    int unread = 0;            // Contours without an id that could be read.
    int missing = 0;           // Pieces without a contour.
    int duplicates = 0;        // Contours with the id of another one, or burnt too often.
    int extra_contours = 0;    // Contours that are no piece.
    int mirrored = 0;
    int ticks_missing = 0;
    int filled_notches = 0;  // Rung ends in notches narrower than the kerf: not cut, and no fault.
    std::vector<std::string> faults;  // In words; at most kMostFaults, then how many more.
};

constexpr std::size_t kMostFaults = 20;

// What a certificate allows.
constexpr double kLargestDeviation = 1e-4;  // Of the diagonal.
constexpr double kLargestOutlineMm = 0.02;  // Programs round to a thousandth.
constexpr double kLargestTickMm = 0.05;

}  // namespace leafcutter::fab
