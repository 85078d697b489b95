// Drawings as SVG elements inside of HTML.

#pragma once

#include <string>

#include "fab/guide/document.h"

namespace leafcutter::fab::guide {

// Appends an <svg> element as wide as the drawing, or narrower where there is no room.
void append_svg(std::string& out, const Drawing& drawing);

// Appends a <g> that `append_svg` refers to wherever shared drawing `number` is used.
void append_shared(std::string& out, const Drawing& drawing, std::size_t number);

// "#rrggbb"
std::string hex(const Colour& colour);

}  // namespace leafcutter::fab::guide
