// Cuts lines and areas off at the sides of a box.

#pragma once

#include <vector>

#include "fab/guide/document.h"

namespace leafcutter::fab::guide {

struct Box {
    Point low = Point::Constant(1e30);
    Point high = Point::Constant(-1e30);

    void add(const Point& point) {
        low = low.cwiseMin(point);
        high = high.cwiseMax(point);
    }
    bool contains(const Point& p) const {
        return p.x() >= low.x() && p.x() <= high.x() && p.y() >= low.y() && p.y() <= high.y();
    }
};

// Appends the parts of a line inside of the box.
void append_clipped(std::vector<Points>& lines, const Points& line, bool closed, const Box& box);

// The parts of a ring's area inside of the box.
std::vector<Points> area_inside(const Points& ring, const Box& box);

}  // namespace leafcutter::fab::guide
