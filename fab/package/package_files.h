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

// What is at hand once the job is cut, for the next one (docs: nesting.stock).
std::string stock_json(const JobResult& job);

// The report and the page of some pieces of a job that are cut again (recut.h): nothing of the
// surface.
std::string recut_report_json(const JobResult& job);
std::string recut_html(const JobResult& job);

// The assembly guide, guide.html and guide.pdf: pages that need nothing else and print well.
struct GuideFiles {
    std::string html;
    std::string pdf;
};
GuideFiles guide_files(const JobResult& job);

}  // namespace leafcutter::fab
