// The files of a package (docs: package format), each as its bytes.

#pragma once

#include <string>

#include "fab/job_result.h"

namespace leafcutter::fab {

std::string quads_obj(const JobResult& job);
std::string surface_ply(const JobResult& job);
std::string leaves_json(const JobResult& job);
std::string quality_json(const JobResult& job);
std::string strips_json(const JobResult& job);
std::string weave_json(const JobResult& job);
std::string layout_json(const JobResult& job);
std::string report_json(const JobResult& job);

// The bill of materials as a table (RFC 4180): a line for each material.
std::string bill_csv(const JobResult& job);

// A page that needs nothing else and prints well.
std::string guide_html(const JobResult& job);

}  // namespace leafcutter::fab
