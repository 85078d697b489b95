// What a user should know about a chart.

#pragma once

#include <string>
#include <vector>

#include "geometry/foliation.h"
#include "geometry/harmonic/bijectivity.h"

namespace leafcutter::geometry {

// Sentences about an inaccurate conformal modulus and about repairs that cost accuracy.
std::vector<std::string> chart_warnings(const Cylinder& cylinder, const FlipReport& repair);

}  // namespace leafcutter::geometry
