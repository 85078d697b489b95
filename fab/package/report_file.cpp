// report.json: what was computed and how good it is.

#include <algorithm>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "fab/material/totals.h"
#include "fab/package/model_files.h"
#include "fab/package/package_files.h"
#include "fab/package/records.h"
#include "geometry/foliation_names.h"
#include "geometry/quads/mean_widths.h"

namespace leafcutter::fab {

namespace {

using json = nlohmann::ordered_json;

const char* name_of(geometry::ChartShape shape) {
    switch (shape) {
        case geometry::ChartShape::Rectangle:
            return "rectangle";
        case geometry::ChartShape::Annulus:
            return "annulus";
        case geometry::ChartShape::Torus:
            return "torus";
        case geometry::ChartShape::Pillowcase:
            break;
    }
    return "pillowcase";
}

json surface_json(const JobResult& job) {
    const geometry::RepairReport& repair = job.repair;
    // Holes, poles and whole parts. What cells at the tips of limbs cut off comes on top.
    const double left_out = 100.0 * std::max(0.0, 1.0 - job.woven_area_mm2 / job.surface_area_mm2);
    return {{"repairs",
             {{"triangulated_polygons", repair.triangulated_polygons},
              {"welded_vertices", repair.welded_vertices},
              {"degenerate_faces_dropped", repair.degenerate_faces_dropped},
              {"duplicate_faces_dropped", repair.duplicate_faces_dropped},
              {"unused_vertices_dropped", repair.unused_vertices_dropped},
              {"faces_reoriented", repair.faces_reoriented},
              {"split_vertices", repair.split_vertices}}},
            {"refinement", {{"vertices", job.topology.vertices}, {"faces", job.topology.faces}}},
            {"area_mm2", job.surface_area_mm2},
            {"removed_area_percent", job.quality.removed_area_percent + left_out},
            {"left_out_area_percent", left_out}};
}

json topology_json(const JobResult& job) {
    const geometry::Topology& topology = job.topology;
    json parts = json::array();
    for (const Part& part : job.parts) {
        parts.push_back({{"faces", part.faces},
                         {"genus", part.genus},
                         {"boundary_loops", part.boundary_loops.size()},
                         {"euler", part.euler},
                         {"area_mm2", part.area},
                         {"cylinders", part.cylinders}});
    }
    return {{"components", topology.components},
            {"genus", topology.genus},
            {"boundary_loops", topology.boundary_loops.size()},
            {"euler", topology.euler},
            {"parts", std::move(parts)}};
}

json cylinder_json(const geometry::Cylinder& cylinder, const geometry::CylinderGrid& grid) {
    return {{"shape", name_of(cylinder.shape)},
            {"graph_edge", cylinder.graph_edge},
            {"height", cylinder.height},
            {"circumference", cylinder.width},
            {"modulus", cylinder.height / cylinder.width},
            {"shear", cylinder.shear},
            {"rows", grid.rows},
            {"cols", grid.cols},
            {"column_shift", grid.column_shift},
            {"shear_deg", grid.shear_deg},
            {"stretch", grid.stretch},
            {"energy", cylinder.energy},
            {"conformal_gap", cylinder.conformal_gap},
            {"flux_mismatch", cylinder.flux_mismatch}};
}

json point_json(const Eigen::Vector3d& point) {
    return {point.x(), point.y(), point.z()};
}

json graph_json(const geometry::MetricGraph& graph) {
    json edges = json::array();
    for (const auto& edge : graph.edges) {
        edges.push_back({{"from", edge.from}, {"to", edge.to}, {"weight", edge.weight}});
    }
    return {{"nodes", graph.nodes}, {"edges", std::move(edges)}};
}

json holes_json(const std::vector<OpenedHole>& holes) {
    json result = json::array();
    for (const OpenedHole& hole : holes) {
        json entry = {{"vertex", nullptr},
                      {"position", point_json(hole.position)},
                      {"radius_mm", hole.radius_mm}};
        if (hole.input_vertex >= 0) {
            entry["vertex"] = hole.input_vertex;
        }
        result.push_back(std::move(entry));
    }
    return result;
}

json spread_json(const geometry::CellSpread& spread) {
    return {{"variation", spread.variation}, {"largest_edge", spread.largest}};
}

json alternatives_json(const JobResult& job) {
    json result = json::array();
    for (const geometry::Alternative& alternative : job.foliation.alternatives) {
        result.push_back(
            {{"name", alternative.name},
             {"cell_spread", spread_json(alternative.spread)},
             {"removed_area_percent", 100.0 * alternative.removed_area / job.surface_area_mm2},
             {"chosen", alternative.chosen}});
    }
    return result;
}

json reached_json(const JobResult& job) {
    json all = json::array();
    for (const ReachedPlace& reached : job.reached) {
        all.push_back(
            {{"vertex", reached.input_vertex},
             {"singularity", reached.singularity < 0 ? json() : json(reached.singularity)},
             {"distance_mm", reached.distance_mm}});
    }
    return all;
}

json foliation_json(const JobResult& job) {
    const geometry::Foliation& foliation = job.foliation;
    json weights = json::array();
    for (const auto& edge : foliation.graph.edges) {
        weights.push_back(edge.weight);
    }
    json cylinders = json::array();
    for (std::size_t i = 0; i < foliation.cylinders.size(); ++i) {
        cylinders.push_back(cylinder_json(foliation.cylinders[i], job.quads.grids[i]));
    }
    json singularities = json::array();
    for (const auto& [position, prongs] : foliation.singularities) {
        singularities.push_back({{"position", point_json(position)}, {"prongs", prongs}});
    }
    json result = {{"mode", geometry::name_of(foliation.mode)},
                   {"graph", graph_json(foliation.graph)},
                   {"weights", std::move(weights)},
                   {"energy", foliation.energy},
                   {"iterations", foliation.iterations},
                   {"singularities", std::move(singularities)},
                   {"reached", reached_json(job)},
                   {"punctures", holes_json(job.holes)},
                   {"cell_spread", spread_json(foliation.spread)},
                   {"alternatives", alternatives_json(job)},
                   {"cylinders", std::move(cylinders)}};
    if (job.params.foliation.weights) {
        result["weights_asked"] = *job.params.foliation.weights;
    }
    if (foliation.evened) {
        result["even_cells"] = {{"before", foliation.evened->before},
                                {"after", foliation.evened->after}};
    }
    return result;
}

json max_avg(const geometry::MaxAvg& value) {
    return {{"max", value.max}, {"avg", value.avg}};
}

json quality_json(const geometry::Quality& quality) {
    return {{"quads", quality.quads},
            {"angle_deviation_deg", max_avg(quality.angle_deviation_deg)},
            {"angle_deviation_interior_deg", max_avg(quality.angle_deviation_interior_deg)},
            {"angle_deviation_singular_deg", max_avg(quality.angle_deviation_singular_deg)},
            {"angle_deviation_boundary_deg", max_avg(quality.angle_deviation_boundary_deg)},
            {"angle_deviation_corner_deg", max_avg(quality.angle_deviation_corner_deg)},
            {"angle_deviation_bound_deg", {{"avg", quality.angle_deviation_bound_deg}}},
            {"crossing_angle_deviation_deg", max_avg(quality.crossing_angle_deviation_deg)},
            {"surface_distance_percent", max_avg(quality.surface_distance_percent)},
            {"distance_diagonal_percent", max_avg(quality.distance_diagonal_percent)},
            {"area_distortion_percent", {{"avg", quality.area_distortion_percent}}},
            {"region_distortion_percent", max_avg(quality.region_distortion_percent)},
            {"planarity_percent", max_avg(quality.planarity_percent)},
            {"cell_area_variation", quality.cell_area_variation},
            {"largest_cell_edge", quality.largest_cell_edge}};
}

json two_sided_json(const geometry::TwoSidedDistance& distance) {
    return {{"quads_to_surface", max_avg(distance.quads_to_surface)},
            {"surface_to_quads", max_avg(distance.surface_to_quads)},
            {"both", max_avg(distance.both)}};
}

json qualities_json(const JobResult& job) {
    const geometry::QualityReport& report = job.quality;
    json cylinders = json::array();
    for (std::size_t i = 0; i < report.per_cylinder.size(); ++i) {
        json cylinder = quality_json(report.per_cylinder[i]);
        cylinder["cylinder"] = i;
        cylinders.push_back(std::move(cylinder));
    }
    json overall = quality_json(report.overall);
    overall["two_sided_diagonal_percent"] = two_sided_json(job.two_sided);
    return {{"overall", std::move(overall)}, {"cylinders", std::move(cylinders)}};
}

json planar_figures_json(const geometry::PlanarisationPrice::Figures& figures) {
    return {{"planarity_percent",
             {{"max", figures.planarity_max_percent}, {"avg", figures.planarity_avg_percent}}},
            {"angle_deviation_deg", {{"avg", figures.angle_deviation_avg_deg}}},
            {"surface_distance_percent",
             {{"max", figures.surface_distance_max_percent},
              {"avg", figures.surface_distance_avg_percent}}},
            {"area_distortion_percent", {{"avg", figures.area_distortion_avg_percent}}}};
}

json planarisation_json(const geometry::PlanarisationPrice& price) {
    return {{"wanted", price.wanted == geometry::Planarity::Full ? "full" : "gentle"},
            {"reached", price.reached},
            {"before", planar_figures_json(price.before)},
            {"after", planar_figures_json(price.after)},
            {"cell_area_change_percent", {{"avg", price.cell_area_change_avg_percent}}},
            {"displacement_mm",
             {{"max", price.largest_displacement_mm}, {"avg", price.mean_displacement_mm}}},
            {"iterations", price.iterations}};
}

json family_json(const JobResult& job, Family family) {
    const FamilyTotals totals = total_of(job, family);
    const geometry::MeanWidths widths = geometry::mean_widths(job.quads);
    return {{"material", job.material_of(family).id},
            {"strips", totals.strips},
            {"closed", totals.closed},
            {"pieces", totals.pieces},
            {"mean_width_mm", family == Family::Weft ? widths.weft_mm : widths.warp_mm},
            {"length_mm", totals.length_mm},
            {"area_mm2", totals.area_mm2},
            {"weight_g", totals.weight_g}};
}

json strips_summary_json(const JobResult& job) {
    const json weft = family_json(job, Family::Weft);
    const json warp = family_json(job, Family::Warp);
    const double weight = weft["weight_g"].get<double>() + warp["weight_g"].get<double>();
    return {{"count", job.strips.size()},
            {"pieces", job.pieces.size()},
            {"weft", weft},
            {"warp", warp},
            {"weight_g", weight},
            {"weave_seams", job.weave.seams.size()}};
}

json weave_summary_json(const JobResult& job) {
    return {{"seams", job.weave.seams.size()},
            {"seam_mm", job.weave.seam_mm},
            {"floats", floats_record(job.weave.floats)},
            {"assembly", assembly_record(job.assembly)}};
}

json certificate_json(const Certificate& certificate) {
    return {{"holds", certificate.holds},
            {"largest_deviation_relative", certificate.largest_deviation_relative},
            {"largest_deviation_mm", certificate.largest_deviation_mm},
            {"diagonal_mm", certificate.diagonal_mm},
            {"edges_compared", certificate.edges_compared},
            {"largest_length_error_mm", certificate.largest_length_error_mm},
            {"largest_disagreement_mm", certificate.largest_disagreement_mm},
            {"largest_outline_error_mm", certificate.largest_outline_error_mm},
            {"largest_tick_error_mm", certificate.largest_tick_error_mm},
            {"ticks", certificate.ticks},
            {"ticks_missing", certificate.ticks_missing},
            {"filled_notches", certificate.filled_notches},
            {"matched_by", certificate.matched_by},
            {"pieces", certificate.pieces},
            {"matched_by_id", certificate.matched_by_id},
            {"matched_by_shape", certificate.matched_by_shape},
            {"unread", certificate.unread},
            {"missing", certificate.missing},
            {"duplicates", certificate.duplicates},
            {"extra_contours", certificate.extra_contours},
            {"mirrored", certificate.mirrored},
            {"faults", certificate.faults}};
}

}  // namespace

std::string report_json(const JobResult& job) {
    json timings = json::object();
    for (const auto& [stage, seconds] : job.timings_s) {
        timings[stage] = seconds;
    }
    json warnings = json::array();
    for (const std::string& warning : job.warnings) {
        warnings.push_back(warning);
    }
    json file = {
        {"format", "leafcutter-report/1"},       {"input", input_record(job.input)},
        {"surface", surface_json(job)},          {"topology", topology_json(job)},
        {"foliation", foliation_json(job)},      {"quality", qualities_json(job)},
        {"strips", strips_summary_json(job)},    {"weave", weave_summary_json(job)},
        {"nesting", nesting_record(job.layout)}, {"cut", cut_record(job)},
        {"thickness", thickness_record(job)},    {"woven", woven_record(job)},
        {"timings_s", std::move(timings)},       {"certificate", certificate_json(job.certificate)},
        {"warnings", std::move(warnings)}};
    add_makings(job, file);
    if (job.quads.planarisation) {
        file["quality"]["planarisation"] = planarisation_json(*job.quads.planarisation);
    }
    return report_text(file);
}

}  // namespace leafcutter::fab
