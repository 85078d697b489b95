// A cut program as file bytes.

#pragma once

#include <string>

#include "fab/cut/cut_program.h"
#include "fab/job_params.h"

namespace leafcutter::fab {

// Absolute mm (G21 G90), laser on only in G1, M4 dynamic power, every G0 dark, ends M5 S0 and a
// park move to the origin. Lines of at most 80 characters, at most 3 decimals, no comment inside
// motion.
std::string write_gcode(const CutProgram& program, const MachineProfile& machine, Dialect dialect);

// The S word of full power: of the machine, or that with which such a firmware comes.
double full_power(const MachineProfile& machine, Dialect dialect);

// True size in mm, one group per operation (engrave, score, cut), lead-ins in one of their own.
std::string write_svg(const CutProgram& program);

// DXF R12, mm, one layer per operation, lead-ins on one of their own.
std::string write_dxf(const CutProgram& program);

}  // namespace leafcutter::fab
