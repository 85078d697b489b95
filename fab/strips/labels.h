// Single-line stroke font for engraved labels.

#pragma once

#include <string_view>
#include <vector>

#include "fab/strips/strip.h"

namespace leafcutter::fab {

// Strokes of `text` with its base line starting at the origin, running along +x, capitals 1 high.
// Knows digits, capital letters and . - + / : ( ) # and arrows '<' '>'; lower case is drawn as
// upper.
std::vector<Polyline> text_strokes(std::string_view text);

// Width of `text` at height 1.
double text_width(std::string_view text);

// The strokes of a text mark in piece coordinates.
std::vector<Polyline> mark_strokes(const Mark& mark);

}  // namespace leafcutter::fab
