#include "fab/package/model_files.h"

#include <algorithm>
#include <utility>

#include <nlohmann/json.hpp>

#include "fab/export/solids.h"
#include "fab/weave/slab.h"

namespace leafcutter::fab {

namespace {

using json = nlohmann::ordered_json;

// More of them nobody reads.
constexpr std::size_t kMostBends = 12;

json family_record(const FamilyThickness& family) {
    const double each = family.changes > 0 ? family.crimp_mm / family.changes : 0.0;
    return {{"thickness_mm", family.thickness_mm},
            {"crossed_mm", family.crossed_mm},
            {"changes_of_side", family.changes},
            {"crimp_mm", family.crimp_mm},
            {"crimp_per_change_mm", each},
            {"gap_mm", family.gap_mm},
            {"needed_gap_mm", family.needed_gap_mm},
            {"flat_gap_mm", family.flat_gap_mm},
            {"lift_mm", family.lift_mm},
            {"joint_mm", family.joint_mm},
            {"min_radius_mm", family.min_radius_mm},
            {"least_radius_mm", family.least_radius_mm},
            {"tightest", family.tightest}};
}

json bend_record(const Strip& strip, const StripBend& bend) {
    return {{"strip", strip.id},
            {"radius_mm", bend.radius_mm},
            {"cell", bend.cell},
            {"surface_radius_mm", bend.surface_radius_mm},
            {"surface_cell", bend.surface_cell},
            {"changes_of_side", bend.changes},
            {"crimp_mm", bend.crimp_mm},
            {"too_tight", bend.too_tight},
            {"too_short", bend.too_short}};
}

// Those that can't be made, then those that the surface bends most: the way over and under bends
// all alike.
std::vector<std::size_t> worst_bends(const std::vector<StripBend>& bends) {
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < bends.size(); ++i) {
        if (bends[i].radius_mm > 0.0) {
            order.push_back(i);
        }
    }
    const auto rank = [&](std::size_t i) {
        const StripBend& bend = bends[i];
        const double surface = bend.surface_radius_mm;
        return bend.too_tight || bend.too_short ? std::pair(0, bend.radius_mm)
                                                : std::pair(surface > 0.0 ? 1 : 2, surface);
    };
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t i, std::size_t j) { return rank(i) < rank(j); });
    order.resize(std::min(order.size(), kMostBends));
    return order;
}

}  // namespace

std::vector<PackageFile> model_files(const JobResult& job) {
    if (!job.params.output.models) {
        return {};
    }
    const std::vector<Solid> solids = solids_of(job.strips, job.woven);
    const FamilyColours colours{job.weft.colour, job.warp.colour};
    return {{"woven.stl", write_stl(solids)},
            {"woven.obj", write_obj(solids, "woven.mtl")},
            {"woven.mtl", write_mtl(colours)},
            {"woven.glb", write_glb(solids, colours)}};
}

json thickness_record(const JobResult& job) {
    const ThicknessReport& report = job.thickness;
    json bends = json::array();
    for (const std::size_t i : worst_bends(report.strips)) {
        bends.push_back(bend_record(job.strips[i], report.strips[i]));
    }
    const auto count = [&](bool StripBend::*fault) {
        return std::count_if(report.strips.begin(), report.strips.end(),
                             [&](const StripBend& bend) { return bend.*fault; });
    };
    return {{"clearance_mm", report.clearance_mm},
            {"clearance_to_pass_mm", report.need.pass_mm},
            {"clearance_for_joints_mm", report.need.joint_mm},
            {"clearance_to_lie_flat_mm", report.need.flat_mm},
            {"weft", family_record(report.families[0])},
            {"warp", family_record(report.families[1])},
            {"strips_too_tight", count(&StripBend::too_tight)},
            {"strips_too_short", count(&StripBend::too_short)},
            {"most_bent", std::move(bends)}};
}

json woven_record(const JobResult& job) {
    const WovenModel& model = job.woven;
    json record = {{"overlaps", model.overlaps},
                   {"side_overlaps", model.side_overlaps},
                   {"tight_crossings", model.tight_crossings},
                   {"tight_sides", model.tight_sides},
                   {"lacking_mm", model.lacking_mm},
                   {"narrowed_cells", model.narrowed_cells},
                   {"narrowed_mm", model.narrowed_mm}};
    record["tight"] = json::array();
    for (std::size_t i = 0; i < std::min(kMostBends, model.tight.size()); ++i) {
        const Clash& clash = model.tight[i];
        record["tight"].push_back({{"strip", job.strips[static_cast<std::size_t>(clash.strip)].id},
                                   {"cell", clash.cell},
                                   {"lacking_mm", clash.depth_mm}});
    }
    if (model.smallest_gap_mm) {
        record["smallest_gap_mm"] = *model.smallest_gap_mm;
    }
    if (model.smallest_side_gap_mm) {
        record["smallest_side_gap_mm"] = *model.smallest_side_gap_mm;
    }
    return record;
}

}  // namespace leafcutter::fab
