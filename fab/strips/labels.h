// Single-line stroke font for engraved labels.

#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "fab/strips/strip.h"

namespace leafcutter::fab {

// The font's grid: capitals and digits run from y = 0 (base line) to kCapital, glyphs start at
// x = 0 and are `width` wide, the next one starts kGap behind.
constexpr int kCapital = 6;
constexpr int kGap = 2;

// A stroke is a run of grid points written "xy", strokes are parted by blanks. No stroke lies on
// another: a laser burns each line once.
//
// What ids are made of (digits W P . + >) is one stroke each but for '+', and can't be taken for
// one another: turned by half a turn, mirrored, moved by up to a grid step each way, any two of
// them differ by more than a grid step (Hausdorff distance).
struct Glyph {
    char letter = '\0';
    int width = 0;
    std::string_view strokes;
};

// Every glyph that the font knows: digits, capital letters, . - + / : ( ) # and blank. '>' and '<'
// are arrows with a flag, '>' pointing along the text with its flag above (on the left of the way).
std::span<const Glyph> font();

// In grid units.
std::vector<Polyline> glyph_strokes(const Glyph& glyph);

// Strokes of `text` with its base line starting at the origin, running along +x, capitals 1 high.
// Lower case is drawn as upper, what the font doesn't know as a box.
std::vector<Polyline> text_strokes(std::string_view text);

// Width of `text` at height 1.
double text_width(std::string_view text);

// The strokes of a text mark in piece coordinates.
std::vector<Polyline> mark_strokes(const Mark& mark);

}  // namespace leafcutter::fab
