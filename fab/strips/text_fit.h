// Finds where a text fits on a piece.

#pragma once

#include <optional>
#include <string_view>

#include "fab/strips/mark_frame.h"
#include "fab/strips/mark_room.h"
#include "fab/strips/strip.h"

namespace leafcutter::fab {

constexpr double kSmallestTextMm = 1.0;

struct TextHeights {
    double least_mm = kSmallestTextMm;
    double most_mm = 4.0;
};

// A text with its surroundings that must stay free.
struct PlacedText {
    Mark mark;
    MarkShape box;
};

// Text inside one cell, running along the strip or across it from right to left, as high as it can
// be, as near to the cell's middle as it can be.
std::optional<PlacedText> fit_in_cell(const MarkRoom& room,
                                      const MarkCell& cell,
                                      std::string_view text,
                                      const TextHeights& heights);

// A part of a piece's middle line, walked from `from_mm` to `to_mm`, either way.
struct Stretch {
    double from_mm = 0.0;
    double to_mm = 0.0;
};

// Text along the middle line with its own middle on the stretch, as near to its beginning as can
// be; the highest that fits anywhere on it.
std::optional<PlacedText> fit_along(const MarkRoom& room,
                                    const MarkFrame& frame,
                                    const Stretch& stretch,
                                    std::string_view text,
                                    const TextHeights& heights);

}  // namespace leafcutter::fab
