// EGV files: LHYMICRO-GL with a few lines before it, as the maker's software, K40 Whisperer and
// MeerK40t read and write them.
//
//   Document type : LHYMICRO-GL file
//   File version: 1.0.01
//   Copyright: …
//   Creator-Software: …
//                                      (an empty line)
//   %0%0%0%0%ICV1752231…FNSE           start and end of the head, then the program
//
// In the program a line end ends a packet, and "-" says to wait for the board to finish.

#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "drivers/lihuiyu/encoder.h"

namespace leafcutter::drivers {

bool is_egv(std::string_view text);

std::string write_egv(const EncodedJob& job);

// A program (G-code or EGV) as an EGV file for a head that stands at home. Throws ProgramRefused.
std::string convert_to_egv(std::string_view program, const EncoderOptions& options);

// The moves of a program (G-code or EGV). Throws ProgramRefused.
std::vector<CutMove> read_program_moves(std::string_view program, const EncoderOptions& options);

// The moves of a file, in program coordinates of `bed`, from a head that stands at home. Throws
// ProgramRefused for what isn't a cutting program (raster, unknown bytes, a program cut short).
std::vector<CutMove> read_egv(std::string_view text,
                              const SpeedModel& model,
                              const LihuiyuBed& bed);

}  // namespace leafcutter::drivers
