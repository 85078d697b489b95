// The chapters that tell what to do with hands, step by step, region by region.

#pragma once

#include "fab/guide/document.h"
#include "fab/guide/job_index.h"
#include "fab/guide/view.h"

namespace leafcutter::fab::guide {

// Appends them to `document`.
void add_step_chapters(const JobIndex& index, Views& views, Document& document);

// "a tube, 24 rows and 42 columns": what a region is, in words.
std::string region_shape(const JobResult& job, std::size_t region);

}  // namespace leafcutter::fab::guide
