// The weave laid flat: one strip from left to right with what lies beside it, the strips that it
// crosses from below to above, seen from outside.

#pragma once

#include <vector>

#include "fab/guide/job_index.h"
#include "fab/guide/pictures.h"

namespace leafcutter::fab::guide {

struct DiagramStrips {
    std::vector<int> fresh;  // Strips that are new: the first is the one whose way is shown.
    std::vector<int> held;   // Its cells that have to be threaded.
};

// At most `size`; lower if fewer rows are to be seen. Long ways are cut in the middle.
Drawing weave_diagram(const JobIndex& index,
                      const Progress& progress,
                      const DiagramStrips& strips,
                      PictureSize size);

// Strips side by side that cross nothing yet, in order.
Drawing base_diagram(const JobIndex& index, const std::vector<int>& strips, PictureSize size);

}  // namespace leafcutter::fab::guide
