// A test card as a package: a job without a surface.

#pragma once

#include "fab/cut/test_card.h"
#include "fab/job_params.h"
#include "fab/package/package.h"

namespace leafcutter::fab {

// report.json, layout.json and the sheet's files.
Package test_card_package(const TestCard& card,
                          const CutProgram& program,
                          const MachineProfile& machine,
                          Dialect dialect);

}  // namespace leafcutter::fab
