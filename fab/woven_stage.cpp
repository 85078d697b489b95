#include "fab/woven_stage.h"

#include <algorithm>

#include "geometry/quads/mean_widths.h"

namespace leafcutter::fab {

namespace {

std::array<SheetFeel, 2> feel_of(const JobResult& job) {
    return {SheetFeel{job.weft.thickness_mm, job.weft.min_radius_mm},
            SheetFeel{job.warp.thickness_mm, job.warp.min_radius_mm}};
}

bool has_joints(const JobResult& job, Family family) {
    return std::any_of(job.pieces.begin(), job.pieces.end(), [&](const Piece& piece) {
        return piece.family == family &&
               (piece.start_tab.length_mm > 0.0 || piece.end_tab.length_mm > 0.0);
    });
}

}  // namespace

double clearance_of(const JobResult& job) {
    if (!job.params.fit.clearance_auto) {
        return job.params.fit.clearance_mm;
    }
    const auto [weft, warp] = feel_of(job);
    const geometry::MeanWidths widths = geometry::mean_widths(job.quads);
    return automatic_clearance_mm(clearance_need(weft, warp),
                                  std::min(widths.weft_mm, widths.warp_mm));
}

void add_thickness(JobResult& job,
                   std::vector<std::string>& warnings,
                   const geometry::Context& context) {
    const double clearance = job.params.fit.clearance_mm;
    WovenRules rules;
    rules.thickness_mm = {job.weft.thickness_mm, job.warp.thickness_mm};
    rules.min_width_mm = {job.weft.min_strip_width_mm, job.warp.min_strip_width_mm};
    rules.clearance_mm = clearance;
    job.woven = build_woven_model(job.quads, job.strips, job.crossings, rules, context);
    job.thickness = judge_thickness(
        job.quads, job.strips, job.crossings,
        {feel_of(job), {has_joints(job, Family::Weft), has_joints(job, Family::Warp)}, clearance});
    for (std::string& warning : thickness_warnings(job.thickness, job.strips, job.woven)) {
        warnings.push_back(std::move(warning));
    }
    for (std::string& warning :
         threading_warnings(job.quads, job.strips, job.assembly, clearance)) {
        warnings.push_back(std::move(warning));
    }
}

}  // namespace leafcutter::fab
