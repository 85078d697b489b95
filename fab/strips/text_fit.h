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

// A text, its box with a margin, which lies inside the outline, and that box longer at both ends:
// a line there would be read as a letter.
struct PlacedText {
    Mark mark;
    MarkShape box;
    MarkShape quiet;
};

enum class TextWay { Along, AlongOrAcross };  // Across runs from right to left.

// Text inside one cell, as high as it can be, as near to the cell's middle as it can be.
std::optional<PlacedText> fit_in_cell(const MarkRoom& room,
                                      const MarkCell& cell,
                                      std::string_view text,
                                      const TextHeights& heights,
                                      TextWay way = TextWay::AlongOrAcross);

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
