// What a step says.

#pragma once

#include <string>
#include <vector>

#include "fab/guide/job_index.h"
#include "fab/guide/steps.h"

namespace leafcutter::fab::guide {

struct StepText {
    std::string title;
    std::vector<std::string> texts;
};

StepText step_text(const JobIndex& index, const PlannedStep& step);

// "W3.1 to W3.2": a joint in a list.
std::string joint_name(const AssemblyMove& move);

}  // namespace leafcutter::fab::guide
