// Warnings as people read them: one line for each kind, not for each strip.

#pragma once

#include <string>
#include <vector>

namespace leafcutter::fab {

// Warnings of the form "W12: what" that say the same are joined: "W12, W13 and 7 more: what". The
// order of first appearance is kept.
std::vector<std::string> joined_warnings(const std::vector<std::string>& warnings);

}  // namespace leafcutter::fab
