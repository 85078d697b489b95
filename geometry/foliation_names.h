// What foliations are called, in files and messages.

#pragma once

#include "geometry/foliation.h"

namespace leafcutter::geometry {

// As job parameters have it: "sphere-pillowcase".
const char* name_of(FoliationMode mode);

}  // namespace leafcutter::geometry
