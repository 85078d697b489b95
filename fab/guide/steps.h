// The moves of an assembly gathered into steps: as many as a person likes to tick off, each with
// one picture.

#pragma once

#include <vector>

#include "fab/guide/job_index.h"

namespace leafcutter::fab::guide {

enum class StepKind {
    TableJoints,  // Pieces joined before they are laid.
    Base,         // Strips laid side by side that cross nothing yet.
    Weave,        // Strips laid or threaded into what is there, and joined in place if need be.
    Joints,       // Joints in place, of the same two regions.
};

struct PlannedStep {
    StepKind kind = StepKind::Weave;
    int region = 0;           // Where it is done; of joints between regions the first,
    int other_region = 0;     // and the second; else the same.
    std::vector<int> moves;   // Into Assembly::moves, in order.
    std::vector<int> strips;  // Base, Weave: those laid, in order.
};

// At most about `most` steps, if runs of like moves can be put together so far. Every move is in
// exactly one step. Joints on the table come first in their region, all other moves stay in order.
std::vector<PlannedStep> plan_steps(const JobIndex& index, std::size_t most);

}  // namespace leafcutter::fab::guide
