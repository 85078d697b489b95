#include "fab/assembly_stage.h"

#include <algorithm>
#include <functional>
#include <optional>

#include <fmt/format.h>

#include "geometry/error.h"

namespace leafcutter::fab {

void add_assembly(JobResult& job, std::vector<std::string>& warnings) {
    job.assembly = plan_assembly(job.quads, job.strips, job.pieces, job.crossings, job.parts);
    const std::optional<AssemblyFault> fault =
        check_assembly(job.strips, job.pieces, job.crossings, job.assembly);
    if (fault) {
        throw geometry::Error(
            geometry::ErrorKind::SelfCheck, "assembly-impossible",
            fmt::format("order of assembly: move {}: {}", fault->move + 1, fault->what));
    }
    if (job.assembly.threaded > 0) {
        warnings.push_back(fmt::format(
            "{} strips have to be threaded lengthwise, the hardest under {} crossing strips",
            job.assembly.threaded, job.assembly.longest_thread));
    }
    const auto& top = job.weave.warp_on_top;
    if (std::adjacent_find(top.begin(), top.end(), std::not_equal_to<>()) == top.end()) {
        warnings.emplace_back(
            "warp and weft are two layers that don't interlace: only joints and rims hold them "
            "together");
    }
}

}  // namespace leafcutter::fab
