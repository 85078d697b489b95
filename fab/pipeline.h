// The whole road: mesh bytes in, package out. The command line and the daemon call this and nothing
// deeper.

#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "fab/cut/cut_program.h"
#include "fab/job_params.h"
#include "fab/material/material.h"
#include "fab/package/package.h"
#include "geometry/context.h"
#include "geometry/repair.h"
#include "geometry/topology.h"

namespace leafcutter::fab {

struct PipelineInput {
    std::string file_name;  // Its ending tells the format. Any bytes; invalid UTF-8 is replaced.
    std::span<const std::byte> bytes;
};

struct PipelineOptions {
    std::span<const Material> materials;  // Where material names are looked up.
    MachineProfile machine;
    std::string params_json = {};  // The parameters as JSON, for the report; may be empty.
};

struct PackageSummary {
    Package package;
    int sheets = 0;
    int strips = 0;
    int pieces = 0;
    int quads = 0;
    double estimated_s = 0.0;
    std::vector<std::string> warnings;
};

// Stages reported: "read", "repair", "foliation", "quads", "strips", "nest", "toolpath", "package".
//
// Throws geometry::Error for bad input or parameters, Cancelled after a stop request.
PackageSummary weave(const PipelineInput& input,
                     const JobParams& params,
                     const PipelineOptions& options,
                     const geometry::Context& context = {});

}  // namespace leafcutter::fab
