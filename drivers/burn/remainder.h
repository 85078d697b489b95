// The rest of a program, from the place on where the beam stopped.

#pragma once

#include <string>
#include <string_view>

#include "drivers/burn/beam_path.h"

namespace leafcutter::drivers {

struct RemainderOptions {
    // Burnt again at the seam, so that nothing holds there; never across a gap between two burns.
    double overlap_mm = 0.1;
    Point start_mm{};  // As of BeamPath.
};

// Goes to the place with the beam off, puts every mode back in force and does the rest as it stands
// in the program. Empty if nothing is left to burn. Throws ProgramRefused, NotTraceable.
std::string remainder_program(std::string_view program,
                              double burnt_mm,
                              const RemainderOptions& options = {});

}  // namespace leafcutter::drivers
