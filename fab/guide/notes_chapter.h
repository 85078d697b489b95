// What else one should know: where the pattern breaks, warnings, what was checked.

#pragma once

#include "fab/guide/document.h"
#include "fab/guide/job_index.h"

namespace leafcutter::fab::guide {

void add_notes_chapter(const JobIndex& index, Document& document);

}  // namespace leafcutter::fab::guide
