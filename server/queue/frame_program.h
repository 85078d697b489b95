// The outline of a program, for showing where it will burn.

#pragma once

#include <string>
#include <string_view>

namespace leafcutter::server {

// A program that moves once around the bounding box of all burning moves of `gcode` (absolute
// millimetres) with the beam off. Empty if it burns nothing.
std::string frame_program(std::string_view gcode);

}  // namespace leafcutter::server
