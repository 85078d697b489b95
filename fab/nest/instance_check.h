// What is wrong with a nesting problem, found before any search.

#pragma once

#include "fab/nest/instance.h"

namespace leafcutter::fab {

// Throws Error(BadOption) naming the item or bin, and what to do: shapes that are no polygons, ids
// that are there twice, items that fit the strip at no rotation, nothing to nest or to nest on.
void check_instance(const NestInstance& instance);

// The largest extent of anything in it.
double largest_length(const NestInstance& instance);

}  // namespace leafcutter::fab
