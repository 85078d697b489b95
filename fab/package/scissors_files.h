// strips.svg and scissors/page-001.svg…: the model for a printer and scissors (export/scissors.h).

#pragma once

#include <vector>

#include "fab/job_result.h"
#include "fab/package/package.h"

namespace leafcutter::fab {

std::vector<PackageFile> scissors_files(const JobResult& job);

}  // namespace leafcutter::fab
