// The woven model's files and what the report says of thickness.

#pragma once

#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "fab/job_result.h"
#include "fab/package/package.h"

namespace leafcutter::fab {

// woven.stl, woven.obj with woven.mtl, woven.glb; none if the job wants no models.
std::vector<PackageFile> model_files(const JobResult& job);

// The report's sections "thickness" and "woven".
nlohmann::ordered_json thickness_record(const JobResult& job);
nlohmann::ordered_json woven_record(const JobResult& job);

}  // namespace leafcutter::fab
