// Sizes of type, and text broken into lines.

#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "fab/guide/paging.h"

namespace leafcutter::fab::guide {

constexpr double kMmPerPoint = 25.4 / 72.0;
constexpr Colour kInk = {34, 34, 34};

struct Type {
    double points = 10.0;
    bool bold = false;
    Colour colour = kInk;
    double leading = 1.38;

    double size_mm() const { return points * kMmPerPoint; }
    double line_mm() const { return size_mm() * leading; }
};

// Breaks text into lines; words wider than a line are broken anywhere between letters.
std::vector<std::string> wrapped(std::string_view text,
                                 const Type& type,
                                 double width_mm,
                                 const Canvas& canvas);

}  // namespace leafcutter::fab::guide
