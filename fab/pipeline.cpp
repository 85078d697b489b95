#include "fab/pipeline.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <utility>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "fab/assembly_stage.h"
#include "fab/cut/certificate.h"
#include "fab/cut/toolpath.h"
#include "fab/even_cells.h"
#include "fab/export/formats.h"
#include "fab/foliation_options.h"
#include "fab/job_result.h"
#include "fab/nest/family_nest.h"
#include "fab/package/model_files.h"
#include "fab/package/package_files.h"
#include "fab/package/scissors_files.h"
#include "fab/strips/junctions.h"
#include "fab/strips/link.h"
#include "fab/strips/marks.h"
#include "fab/strips/strips.h"
#include "fab/utf8.h"
#include "fab/warnings.h"
#include "fab/weave/openings.h"
#include "fab/weave/weave.h"
#include "fab/woven_stage.h"
#include "geometry/closest_point.h"
#include "geometry/error.h"
#include "geometry/foliation.h"
#include "geometry/io/read_mesh.h"
#include "geometry/leaves.h"
#include "geometry/quads/quality.h"
#include "geometry/quads/two_sided.h"
#include "geometry/surface_measures.h"

namespace leafcutter::fab {

namespace {

using geometry::Context;
using geometry::Error;
using geometry::ErrorKind;

// Distant parts of a piece stay this much more than the kerf apart, so that the beam parts them.
constexpr double kSelfGapMm = 0.3;

// Columns that close in multiples of longer ones would hardly ever fit.
constexpr int kLongestPeriod = 8;

// Leaves are for looking at: more than about this many points and every second one is left out.
constexpr std::size_t kMostLeafCells = 60'000;

// The stages and how much of the whole work each is, about.
struct Stage {
    const char* name;
    double begin;
    double end;
};
constexpr Stage kRead{"read", 0.0, 0.03};
constexpr Stage kRepair{"repair", 0.03, 0.08};
constexpr Stage kFoliation{"foliation", 0.08, 0.4};
constexpr Stage kQuads{"quads", 0.4, 0.55};
constexpr Stage kStrips{"strips", 0.55, 0.65};
constexpr Stage kNest{"nest", 0.65, 0.85};
constexpr Stage kToolpath{"toolpath", 0.85, 0.93};
constexpr Stage kPackage{"package", 0.93, 1.0};

[[noreturn]] void refuse(const char* code, const std::string& message) {
    throw Error(ErrorKind::BadOption, code, message);
}

const Material& material_named(std::span<const Material> materials,
                               const std::string& id,
                               const char* path) {
    const Material* material = find_material(materials, id);
    if (material == nullptr) {
        refuse("no-such-material",
               fmt::format("{}: there is no material {}", path, valid_utf8(id)));
    }
    return *material;
}

// Of the surface that the cylinders cover: without holes, poles and parts left out.
double woven_area(const geometry::Foliation& foliation) {
    double area = 0.0;
    for (const geometry::Cylinder& cylinder : foliation.cylinders) {
        area += geometry::surface_area(cylinder.mesh);
    }
    return area;
}

// Runs the stages one after the other over one JobResult, timing each.
class Job {
public:
    Job(const JobParams& params, const PipelineOptions& options, const Context& context)
        : options_(options), context_(context) {
        result_.params = params;
        result_.params_json = options.params_json;
        result_.machine = options.machine;
        const auto material = [&](const std::string& id, const char* path) {
            return on_machine(material_named(options.materials, id, path), params.output.machine);
        };
        result_.weft = material(params.material.weft, "material.weft");
        result_.warp = material(params.material.warp, "material.warp");
        piece_room(result_.weft, params.nesting);
        piece_room(result_.warp, params.nesting);
    }

    PackageSummary run(const PipelineInput& input) {
        geometry::PolygonSoup soup;
        run_stage(kRead, [&](const Context&) { soup = read(input); });
        run_stage(kRepair, [&](const Context&) { mend(std::exchange(soup, {})); });
        run_stage(kFoliation, [&](const Context& context) { foliate(context); });
        run_stage(kQuads, [&](const Context& context) { make_quads(context); });
        run_stage(kStrips, [&](const Context& context) { make_strips_and_pieces(context); });
        run_stage(kNest, [&](const Context& context) { lay_out(context); });
        run_stage(kToolpath, [&](const Context& context) { plan(context); });
        PackageSummary summary;
        run_stage(kPackage, [&](const Context& context) { certify_and_write(context, summary); });
        // The report is written last: it holds the times of all the others.
        summary.package.files.insert(summary.package.files.begin(),
                                     {"report.json", report_json(result_)});
        context_.report(kPackage.name, 1.0);
        summarise(summary);
        return summary;
    }

private:
    template <typename Work>
    void run_stage(const Stage& stage, Work work) {
        context_.report(stage.name, stage.begin);
        Context context = context_;
        if (context_.progress) {
            context.progress = [&](std::string_view, double fraction) {
                const double part = std::clamp(fraction, 0.0, 1.0);
                furthest_ = std::max(furthest_, stage.begin + part * (stage.end - stage.begin));
                context_.progress(stage.name, furthest_);
            };
        }
        const double start = context_.now_s();
        work(context);
        result_.timings_s.emplace_back(stage.name, context_.now_s() - start);
        context_.check();
    }

    geometry::PolygonSoup read(const PipelineInput& input) {
        geometry::PolygonSoup soup = geometry::read_mesh(input.bytes, input.file_name);
        result_.input.file = valid_utf8(input.file_name);
        result_.input.vertices = soup.positions.size();
        result_.input.faces = soup.face_count();
        return soup;
    }

    void mend(const geometry::PolygonSoup& soup) {
        geometry::RepairedMesh repaired = geometry::repair(soup);
        result_.repair = repaired.report;
        warnings_.insert(warnings_.end(), repaired.report.warnings.begin(),
                         repaired.report.warnings.end());
        mesh_ = std::move(repaired.mesh);
        vertex_of_input_ = std::move(repaired.vertex_of_input);
        scale();
        result_.topology = geometry::analyse_topology(mesh_);
        result_.parts = parts_of(mesh_, result_.topology);
    }

    void scale() {
        const std::optional<double> side = result_.params.scale.longest_side_mm;
        if (!side) {
            return;
        }
        Eigen::Vector3d low = mesh_.point(*mesh_.vertices_begin());
        Eigen::Vector3d high = low;
        for (const auto vertex : mesh_.vertices()) {
            low = low.cwiseMin(mesh_.point(vertex));
            high = high.cwiseMax(mesh_.point(vertex));
        }
        result_.input.scale = *side / (high - low).maxCoeff();
        for (const auto vertex : mesh_.vertices()) {
            mesh_.point(vertex) *= result_.input.scale;
        }
    }

    // Weights may move a little so that columns come out whole, where that is left open.
    void suit_grid(geometry::FoliationOptions& options) const {
        const geometry::GridOptions& grid = result_.params.grid;
        const auto is_fixed = [](const geometry::RowsCols& counts) {
            return counts.rows || counts.cols;
        };
        options.even_cells = grid.even_cells;
        if (grid.junctions == geometry::Junctions::Independent || is_fixed(grid.all) ||
            std::any_of(grid.per_cylinder.begin(), grid.per_cylinder.end(), is_fixed)) {
            return;
        }
        double area = 0.0;
        for (const Part& part : result_.parts) {
            area += part.area;
        }
        options.junctions = {.cells = area / (grid.strip_width_mm * grid.strip_width_mm),
                             .even_columns = grid.parity == geometry::Parity::Even};
    }

    void foliate(const Context& context) {
        geometry::FoliationOptions options =
            foliation_options(result_.params.foliation,
                              {vertex_of_input_, result_.topology, &mesh_, result_.input.scale});
        suit_grid(options);
        if (options.even_cells) {
            EvenedOut even = even_out(mesh_, options, grid_options(), context);
            result_.foliation = std::move(even.foliation);
            is_evened_ = even.is_evened;
        } else {
            result_.foliation = geometry::compute_foliation(mesh_, options, context);
        }
        warnings_.insert(warnings_.end(), result_.foliation.warnings.begin(),
                         result_.foliation.warnings.end());
        assign_cylinders(mesh_, result_.topology, result_.foliation.cylinders, result_.parts);
        find_places(options.near);
    }

    // What users call the vertices that the foliation names.
    void find_places(const std::vector<int>& wanted) {
        const std::vector<int> input_of_vertex =
            input_of_vertices(vertex_of_input_, mesh_.n_vertices());
        for (const geometry::Puncture& puncture : result_.foliation.punctures) {
            result_.holes.push_back(
                {.input_vertex = input_of_vertex[static_cast<std::size_t>(puncture.vertex)],
                 .position = mesh_.point(geometry::Mesh::VertexHandle(puncture.vertex)),
                 .radius_mm = puncture.radius});
        }
        for (const geometry::ReachedPoint& reached : result_.foliation.reached) {
            const auto k = std::find(wanted.begin(), wanted.end(), reached.vertex) - wanted.begin();
            const PlaceParams& place = result_.params.foliation.near[static_cast<std::size_t>(k)];
            result_.reached.push_back(
                {.input_vertex = place.vertex.value_or(
                     input_of_vertex[static_cast<std::size_t>(reached.vertex)]),
                 .singularity = reached.singularity,
                 .distance_mm = reached.distance});
        }
    }

    geometry::GridOptions grid_options() const {
        geometry::GridOptions grid = result_.params.grid;
        const int period = pattern_period(result_.params.weave);
        grid.period = period == 1 || period > kLongestPeriod ? 2 : period;
        return grid;
    }

    void make_quads(const Context& context) {
        geometry::GridOptions grid = grid_options();
        grid.even_cells = is_evened_;
        result_.quads = geometry::build_quad_mesh(result_.foliation, grid, context);
        if (!result_.quads.charts.empty()) {
            result_.foliation.cylinders = std::move(result_.quads.charts);
        }
        warnings_.insert(warnings_.end(), result_.quads.warnings.begin(),
                         result_.quads.warnings.end());
        const geometry::TriangleMesh surface = geometry::to_triangle_mesh(mesh_);
        result_.surface_area_mm2 = geometry::surface_area(surface);
        result_.woven_area_mm2 = woven_area(result_.foliation);
        result_.quality =
            geometry::measure_quality(result_.quads, geometry::ClosestPoint(surface), context);
        result_.two_sided =
            geometry::measure_two_sided(result_.quads, result_.quality.cells, surface, context);
        int stride = 1;
        while (result_.quads.quads.size() / static_cast<std::size_t>(stride) > kMostLeafCells) {
            stride *= 2;
        }
        result_.leaves = geometry::sample_leaves(result_.foliation, result_.quads, stride);
    }

    FitParams fit_of() const {
        FitParams fit = result_.params.fit;
        const WeavePattern pattern = result_.params.weave.pattern;
        // Layers that lie on each other without crossing over need no way up and down.
        const bool layers =
            pattern == WeavePattern::DoubleWarp || pattern == WeavePattern::DoubleWeft;
        fit.crimp = fit.crimp && !layers;
        return fit;
    }

    PieceLimits limits_of(const Material& material) const {
        PieceLimits limits;
        const PieceRoom room = piece_room(material, result_.params.nesting);
        limits.usable_sheet = room.size;
        limits.thickness_mm = material.thickness_mm;
        limits.min_width_mm = material.min_strip_width_mm;
        limits.min_length_mm = material.min_length_mm;
        limits.rotation = room.rotation;
        limits.self_gap_mm = material.kerf_mm + kSelfGapMm;
        limits.kerf_mm = material.kerf_mm;
        limits.min_radius_mm = material.min_radius_mm;
        limits.crossed_mm = (&material == &result_.weft ? result_.warp : result_.weft).thickness_mm;
        return limits;
    }

    // Strips that run through critical leaves are longer than the leaves of a cylinder.
    void relate_quality_to_strips(const Context& context) {
        std::vector<geometry::Thread> threads;
        for (const Strip& strip : result_.strips) {
            threads.push_back({strip.family, strip.closed, strip.quads, -1, {}});
        }
        const geometry::TriangleMesh surface = geometry::to_triangle_mesh(mesh_);
        result_.quality = geometry::measure_quality(result_.quads, geometry::ClosestPoint(surface),
                                                    context, threads);
    }

    void make_strips_and_pieces(const Context& context) {
        result_.params.fit.clearance_mm = clearance_of(result_);
        const FitParams fit = fit_of();
        const std::array limits = {limits_of(result_.weft), limits_of(result_.warp)};
        result_.strips =
            make_strips(result_.quads, fit.columns, through_limits(fit, limits.back()));
        if (fit.columns == ColumnRuns::Through) {
            relate_quality_to_strips(context);
        }
        refuse_hopeless_strips(result_.strips, result_.quads, limits);
        if (result_.params.grid.junctions == geometry::Junctions::Independent) {
            glue_ends(result_.quads, result_.foliation, result_.strips);
        }
        result_.weave = weave_cells(result_.quads, result_.params.weave);
        result_.crossings = crossings_of(result_.strips, result_.weave);
        const auto threading = opening_costs(result_.quads, result_.strips, result_.crossings);
        JointMap joints(result_.quads);
        for (std::size_t i = 0; i < result_.strips.size(); ++i) {
            Strip& strip = result_.strips[i];
            const PieceLimits& limit = limits[strip.family == Family::Weft ? 0 : 1];
            const PieceRules rules{fit, limit, result_.crossings[i], &joints, threading[i]};
            for (Piece& piece : make_pieces(strip, result_.quads, rules, warnings_)) {
                result_.pieces.push_back(std::move(piece));
            }
            context.report(kStrips.name,
                           static_cast<double>(i + 1) / static_cast<double>(result_.strips.size()));
        }
        link_pieces(result_.strips, limits, result_.pieces, warnings_);
        mark_pieces(result_.pieces, result_.strips, result_.crossings, fit, warnings_);
        if (!result_.weave.seams.empty()) {
            warnings_.push_back(
                fmt::format("the pattern breaks between {} pairs of neighbouring cells",
                            result_.weave.seams.size()));
        }
        add_assembly(result_, warnings_);
        add_thickness(result_, warnings_, context);
    }

    void lay_out(const Context& context) {
        result_.layout = nest_families(result_.pieces, {result_.weft, result_.warp},
                                       result_.params.nesting, context);
        for (const std::string& piece : result_.layout.unplaced) {
            warnings_.push_back(fmt::format("{}: fits on no sheet", piece));
        }
    }

    void plan(const Context& context) {
        for (const Sheet& sheet : result_.layout.sheets) {
            const Material& material = sheet.family == "warp" ? result_.warp : result_.weft;
            CutProgram program = plan_sheet(
                sheet, result_.pieces, {material, options_.machine, result_.params.cut}, context);
            program.job = result_.input.file;
            result_.programs.push_back(std::move(program));
            context.report(kToolpath.name, static_cast<double>(result_.programs.size()) /
                                               static_cast<double>(result_.layout.sheets.size()));
        }
        result_.bill = make_bill(result_);
    }

    void certify_and_write(const Context& context, PackageSummary& summary) {
        std::vector<PackageFile>& files = summary.package.files;
        std::vector<std::string> gcode;
        for (const CutProgram& program : result_.programs) {
            context.check();
            gcode.push_back(write_gcode(program, options_.machine, result_.params.output.dialect));
        }
        result_.certificate = certify(result_, gcode, context);
        if (!result_.certificate.holds) {
            warnings_.push_back(fmt::format("the certificate does not hold: {}",
                                            fmt::join(result_.certificate.faults, "; ")));
        }
        result_.warnings = joined_warnings(warnings_);
        files.push_back({"surface.ply", surface_ply(result_)});
        files.push_back({"quads.obj", quads_obj(result_)});
        files.push_back({"quality.json", quality_json(result_)});
        files.push_back({"leaves.json", leaves_json(result_)});
        files.push_back({"strips.json", strips_json(result_)});
        files.push_back({"weave.json", weave_json(result_)});
        files.push_back({"layout.json", layout_json(result_)});
        files.push_back({"bill.csv", bill_csv(result_)});
        files.push_back({"stock.json", stock_json(result_)});
        std::vector<PackageFile> models = model_files(result_);
        std::move(models.begin(), models.end(), std::back_inserter(files));
        for (std::size_t i = 0; i < result_.programs.size(); ++i) {
            const CutProgram& program = result_.programs[i];
            const std::string name = fmt::format("sheets/sheet-{:03}", program.sheet);
            files.push_back({name + ".svg", write_svg(program)});
            files.push_back({name + ".dxf", write_dxf(program)});
            files.push_back({name + ".gcode", std::move(gcode[i])});
        }
        std::vector<PackageFile> scissors = scissors_files(result_);
        std::move(scissors.begin(), scissors.end(), std::back_inserter(files));
        GuideFiles guide = guide_files(result_);
        files.push_back({"guide.html", std::move(guide.html)});
        files.push_back({"guide.pdf", std::move(guide.pdf)});
    }

    void summarise(PackageSummary& summary) const {
        summary.sheets = static_cast<int>(result_.layout.sheets.size());
        summary.strips = static_cast<int>(result_.strips.size());
        summary.pieces = static_cast<int>(result_.pieces.size());
        summary.quads = static_cast<int>(result_.quads.quads.size());
        for (const CutProgram& program : result_.programs) {
            summary.estimated_s += program.estimated_s;
        }
        summary.warnings = result_.warnings;
    }

    const PipelineOptions& options_;
    const Context& context_;
    JobResult result_;
    geometry::Mesh mesh_;
    std::vector<int> vertex_of_input_;
    std::vector<std::string> warnings_;
    bool is_evened_ = false;  // Cells of even area were asked for and found.
    double furthest_ = 0.0;   // Progress told so far; never falls.
};

}  // namespace

PackageSummary weave(const PipelineInput& input,
                     const JobParams& params,
                     const PipelineOptions& options,
                     const Context& context) {
    return Job(params, options, context).run(input);
}

}  // namespace leafcutter::fab
