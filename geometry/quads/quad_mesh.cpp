#include "geometry/quads/quad_mesh.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "geometry/closest_point.h"
#include "geometry/quads/cell_regions.h"
#include "geometry/quads/chart_sampler.h"
#include "geometry/quads/conforming_mesh.h"
#include "geometry/quads/conforming_rectangles.h"
#include "geometry/quads/even_columns.h"
#include "geometry/quads/graded_grid.h"
#include "geometry/quads/grid.h"
#include "geometry/quads/half_sag.h"
#include "geometry/quads/mean_widths.h"
#include "geometry/quads/patch.h"
#include "geometry/quads/planarise.h"
#include "geometry/quads/quad_edges.h"
#include "geometry/quads/quality.h"
#include "geometry/quads/strip_width.h"
#include "geometry/surface_measures.h"

namespace leafcutter::geometry {

namespace {

using Eigen::Vector3d;

// From a number of cells that would fold over to the next, and how often.
constexpr double kFiner = 1.5;
constexpr int kMostSizes = 10;
// What a cell's region may be of it before the cell caps a limb, and how much of a cylinder other
// cells may cut off.
constexpr double kCapped = 1.1;
constexpr double kMostLacking = 0.025;
const char* const kTooCoarse = "quads-too-coarse";
// Of the mean width of strips.
constexpr double kWidthTolerance = 0.02;
// More cells than asked for by this part is another strip width.
constexpr double kMostExcess = 1.1;
// Cells of a surface of one cylinder are not longer than twice their width, if their number is
// free: as a logarithm.
constexpr double kMostStretch = std::numbers::ln2;

void check_options(const Foliation& foliation, const GridOptions& options) {
    if (!std::isfinite(options.strip_width_mm) || options.strip_width_mm <= 0.0) {
        throw Error(
            ErrorKind::BadOption, "bad-strip-width",
            fmt::format("grid.strip_width_mm: must be > 0, not {}", options.strip_width_mm));
    }
    if (options.per_cylinder.size() > foliation.cylinders.size()) {
        throw Error(ErrorKind::BadOption, "too-many-cylinders",
                    fmt::format("grid.cylinders: has {} entries, but the surface has {} cylinders",
                                options.per_cylinder.size(), foliation.cylinders.size()));
    }
}

GridWish wish_for(std::size_t cylinder, double area, const GridOptions& options) {
    GridWish wish{.cells = area / (options.strip_width_mm * options.strip_width_mm),
                  .counts = options.all,
                  .parity = options.parity,
                  .period = options.period,
                  .path = "grid"};
    if (cylinder < options.per_cylinder.size()) {
        const RowsCols& own = options.per_cylinder[cylinder];
        if (own.rows || own.cols) {
            wish.counts = own;
            wish.path = fmt::format("grid.cylinders[{}]", cylinder);
        }
    }
    return wish;
}

void check_topology(std::size_t cylinder, const ChartGrid& grid, const Patch& patch) {
    const QuadNeighbours found = find_neighbours(patch.quads);
    const int euler = static_cast<int>(patch.vertices.size()) - found.edges +
                      static_cast<int>(patch.quads.size());
    int wanted_boundary = 0;
    wanted_boundary += grid.closed_along() || grid.has_folds() ? 0 : 2 * grid.grid().cols;
    wanted_boundary += grid.closed_across() ? 0 : 2 * grid.grid().rows;
    const int wanted_euler = grid.has_folds() ? 2 : grid.closed_across() ? 0 : 1;
    if (found.faults != 0 || euler != wanted_euler || found.boundary_edges != wanted_boundary) {
        throw Error(ErrorKind::SelfCheck, "quads-topology",
                    fmt::format("quads: cylinder {} has {} faulty edges, Euler characteristic {} "
                                "instead of {} and {} boundary edges instead of {}",
                                cylinder, found.faults, euler, wanted_euler, found.boundary_edges,
                                wanted_boundary));
    }
}

void check_facing(std::size_t cylinder, const Patch& patch, const CellRegions& regions) {
    const std::size_t inverted = count_inverted(patch, regions);
    if (inverted > 0) {
        throw Error(ErrorKind::SelfCheck, kTooCoarse,
                    fmt::format("quads: {} of {} quads of cylinder {} face inwards; use narrower "
                                "strips (grid.strip_width_mm)",
                                inverted, patch.quads.size(), cylinder));
    }
}

double area_of(const Patch& patch, const std::array<int, 4>& quad) {
    const auto corner = [&](std::size_t i) -> const Vector3d& {
        return patch.vertices[static_cast<std::size_t>(quad[i])];
    };
    const Vector3d diagonal = corner(2) - corner(0);
    return 0.5 * ((corner(1) - corner(0)).cross(diagonal).norm() +
                  diagonal.cross(corner(3) - corner(0)).norm());
}

// Cells that are chords of a strongly bent surface cut off much of it. Those that cap a limb are
// another matter: no near size of cells would cure them.
void check_chords(std::size_t cylinder,
                  const Patch& patch,
                  const CellRegions& regions,
                  double area) {
    double lacking = 0.0;
    for (std::size_t i = 0; i < patch.quads.size(); ++i) {
        const double quad = area_of(patch, patch.quads[i]);
        lacking += regions.area[i] > kCapped * quad ? 0.0 : regions.area[i] - quad;
    }
    if (lacking > kMostLacking * area) {
        throw Error(ErrorKind::SelfCheck, kTooCoarse,
                    fmt::format("quads: {:.1f} % of cylinder {} bulge out of their cells; use "
                                "narrower strips (grid.strip_width_mm)",
                                100.0 * lacking / area, cylinder));
    }
}

void append(QuadMesh& mesh, const Patch& patch, const ChartGrid& grid, const CellRegions& regions) {
    const int base = static_cast<int>(mesh.vertices.size());
    const int cylinder = static_cast<int>(mesh.grids.size());
    mesh.vertices.insert(mesh.vertices.end(), patch.vertices.begin(), patch.vertices.end());
    for (std::size_t i = 0; i < patch.quads.size(); ++i) {
        const auto& quad = patch.quads[i];
        mesh.quads.push_back({quad[0] + base, quad[1] + base, quad[2] + base, quad[3] + base});
        mesh.addresses.push_back({.cylinder = cylinder,
                                  .row = static_cast<int>(i) / grid.grid().cols,
                                  .col = static_cast<int>(i) % grid.grid().cols});
    }
    mesh.surface_area.insert(mesh.surface_area.end(), regions.area.begin(), regions.area.end());
    mesh.grids.push_back(grid.grid());
}

// One cylinder on its way to quads.
struct Work {
    std::size_t cylinder = 0;
    const Cylinder& chart;
    const ChartSampler& sampler;
    double area = 0.0;
    bool alone = false;        // No other cylinder belongs to the surface.
    bool must_follow = false;  // Narrower strips may cure cells that cut off too much.
};

void add_cylinder(QuadMesh& mesh,
                  const Work& work,
                  const CylinderGrid& counts,
                  const GridOptions& options,
                  const Context& context) {
    const ChartGrid grid(work.chart, counts);
    Patch patch = sample_patch(grid, work.sampler, context);
    check_topology(work.cylinder, grid, patch);
    const CellRegions regions = cut_regions(work.chart, grid);
    check_regions(work.cylinder, regions, work.area);
    if (options.half_sag_offset) {
        offset_by_half_sag(patch.vertices, sag_cells(patch, regions, grid, work.sampler));
    }
    check_facing(work.cylinder, patch, regions);
    if (work.must_follow) {
        check_chords(work.cylinder, patch, regions, work.area);
    }
    append(mesh, patch, grid, regions);
}

CylinderGrid graded(const Work& work,
                    const CylinderGrid& even,
                    const GridOptions& options,
                    const Context& context) {
    return graded_grid({.chart = work.chart,
                        .sampler = work.sampler,
                        .even = even,
                        .spacing = options.spacing,
                        .half_sag_offset = options.half_sag_offset,
                        .movable = {}},
                       context);
}

// Strips narrower than asked for: said, or refused if only the asked width will do.
void tell_narrow(QuadMesh& mesh, const Work& work, double cells, const GridOptions& options) {
    const double width = rounded_down(std::sqrt(work.area / cells));
    if (!options.may_narrow && work.alone) {
        throw Error(ErrorKind::BadOption, "strips-too-wide",
                    fmt::format("grid.strip_width_mm: strips of {:.4g} mm are too wide to close "
                                "round the surface; use at most {:.4g} mm (about {:.0f} quads)",
                                options.strip_width_mm, width, cells));
    }
    mesh.warnings.push_back(fmt::format(
        "cylinder {}: has narrower strips than asked for, {:.4g} mm, as wider ones would not close "
        "or fold over",
        work.cylinder, width));
}

// The cylinder's quads at the wished size, or smaller ones where so few can't close the surface or
// would face inwards: a few cells can't follow a small cylinder that bends sharply.
void add_fine_enough(
    QuadMesh& mesh, Work work, GridWish wish, const GridOptions& options, const Context& context) {
    const double wished = wish.cells;
    const double share = cells_per_square(work.chart);
    const bool free = !wish.counts.rows && !wish.counts.cols;
    if (work.alone) {
        wish.most_stretch = kMostStretch;
    }
    const bool may_refine = !wish.counts.rows || !wish.counts.cols;
    bool may_grade = options.spacing != Spacing::Uniform;
    for (int tries = 1;; ++tries) {
        work.must_follow = may_refine && options.half_sag_offset && tries < kMostSizes;
        CylinderGrid grid = choose_grid(work.chart, wish);
        const double cells = static_cast<double>(grid.rows) * grid.cols;
        if (free && cells > kMostExcess * share * wish.cells && tries < kMostSizes) {
            wish.cells = cells / share;
            continue;
        }
        const CylinderGrid even = grid;
        if (may_grade) {
            grid = graded(work, even, options, context);
        }
        const bool stays_even = grid.f_levels == even.f_levels && grid.g_levels == even.g_levels;
        try {
            add_cylinder(mesh, work, grid, options, context);
        } catch (const Error& error) {
            if (error.code() == kTooCoarse && !stays_even) {
                may_grade = false;
                continue;
            }
            if (error.code() != kTooCoarse || !may_refine || tries >= kMostSizes) {
                throw;
            }
            wish.cells *= kFiner;
            continue;
        }
        if (options.spacing != Spacing::Uniform && stays_even) {
            mesh.warnings.push_back(fmt::format(
                "cylinder {}: keeps uniform spacing, as none graded comes closer to the surface",
                work.cylinder));
        }
        if (wish.cells > wished) {
            tell_narrow(mesh, work, wish.cells, options);
        }
        return;
    }
}

void append_joined(QuadMesh& mesh, JoinedCylinder&& part) {
    const int cylinder = static_cast<int>(mesh.grids.size());
    for (std::size_t i = 0; i < part.quads.size(); ++i) {
        mesh.quads.push_back(part.quads[i]);
        mesh.addresses.push_back({.cylinder = cylinder,
                                  .row = static_cast<int>(i) / part.grid.cols,
                                  .col = static_cast<int>(i) % part.grid.cols});
    }
    mesh.surface_area.insert(mesh.surface_area.end(), part.surface_area.begin(),
                             part.surface_area.end());
    mesh.grids.push_back(std::move(part.grid));
    mesh.charts[static_cast<std::size_t>(cylinder)] = std::move(part.chart);
}

// Cylinders that meet along critical leaves, or nothing.
JoinedMesh join_rings(QuadMesh& mesh,
                      const Foliation& foliation,
                      const GridOptions& options,
                      const Context& context) {
    if (options.junctions == Junctions::Independent) {
        return {};
    }
    JoinedMesh joined = options.even_cells ? join_evenly(foliation, options, context)
                                           : join_cylinders(foliation, options, context);
    merge_joined(joined, join_rectangles(foliation, options, context));
    if (!joined.cylinders.empty()) {
        mesh.vertices = std::move(joined.vertices);
        mesh.charts = foliation.cylinders;
        mesh.warnings = joined.warnings;
        if (options.spacing != Spacing::Uniform && foliation.mode == FoliationMode::OneForm) {
            mesh.warnings.emplace_back(
                "grid.spacing: rectangles that are joined have uniform spacing, as they share "
                "rows");
        }
    }
    return joined;
}

void tell_width(QuadMesh& mesh, const GridOptions& options) {
    const auto is_fixed = [](const RowsCols& counts) { return counts.rows || counts.cols; };
    if (mesh.quads.empty() || is_fixed(options.all) ||
        std::any_of(options.per_cylinder.begin(), options.per_cylinder.end(), is_fixed)) {
        return;
    }
    const double width = mean_widths(mesh).all_mm();
    if (std::abs(width / options.strip_width_mm - 1.0) > kWidthTolerance) {
        mesh.warnings.push_back(
            fmt::format("strips are {:.4g} mm wide on average instead of {:.4g} mm: no whole "
                        "numbers of rows and columns come closer",
                        width, options.strip_width_mm));
    }
}

}  // namespace

QuadMesh build_quad_mesh(const Foliation& foliation,
                         const GridOptions& options,
                         const Context& context) {
    check_options(foliation, options);
    QuadMesh mesh;
    JoinedMesh joined = join_rings(mesh, foliation, options, context);
    std::size_t next_joined = 0;
    for (std::size_t i = 0; i < foliation.cylinders.size(); ++i) {
        if (next_joined < joined.cylinders.size() &&
            joined.cylinders[next_joined] == static_cast<int>(i)) {
            append_joined(mesh, std::move(joined.parts[next_joined]));
            ++next_joined;
            continue;
        }
        const Cylinder& chart = foliation.cylinders[i];
        context.check();
        const ChartSampler sampler(chart);
        const Work work{.cylinder = i,
                        .chart = chart,
                        .sampler = sampler,
                        .area = surface_area(chart.mesh),
                        .alone = foliation.cylinders.size() == 1};
        context.check();
        add_fine_enough(mesh, work, wish_for(i, work.area, options), options, context);
    }
    tell_width(mesh, options);
    planarise(mesh, foliation, options.planar, context);
    return mesh;
}

}  // namespace leafcutter::geometry
