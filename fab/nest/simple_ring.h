// Whether an outline can be nested at all.

#pragma once

#include <string>

#include "fab/strips/strip.h"

namespace leafcutter::fab {

// What is wrong with a ring, for a message; empty for a simple polygon with an area. A closing
// point that repeats the first is wrong, too.
std::string ring_fault(const Ring& ring);

}  // namespace leafcutter::fab
