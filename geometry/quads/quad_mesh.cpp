#include "geometry/quads/quad_mesh.h"

#include <cmath>
#include <cstddef>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "geometry/closest_point.h"
#include "geometry/quads/cell_regions.h"
#include "geometry/quads/chart_sampler.h"
#include "geometry/quads/curvature_spacing.h"
#include "geometry/quads/grid.h"
#include "geometry/quads/half_sag.h"
#include "geometry/quads/quad_edges.h"
#include "geometry/quads/quality.h"
#include "geometry/surface_measures.h"

namespace leafcutter::geometry {

namespace {

using Eigen::Vector3d;

// A region whose triangles cancel to less than this share of its area has no clear direction.
constexpr double kClearDirection = 0.2;

// Graded grids may come this much less close on average, if the largest distance falls.
constexpr double kWorseMean = 1.2;

// Of the number of cells, where wide ones would fold over.
constexpr int kMostDoublings = 5;

void refuse(const std::string& path, const std::string& what) {
    throw Error(ErrorKind::NotSupported, "not-supported-yet", path + ": " + what);
}

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
    if (options.planar != Planarity::Off) {
        refuse("grid.planar", "planarisation is not built yet; use \"off\"");
    }
    if (options.even_cells) {
        refuse("grid.even_cells", "evening out cells is not built yet; use false");
    }
    if (options.junctions == Junctions::Conforming && foliation.cylinders.size() > 1) {
        refuse("grid.junctions",
               "cylinders are not joined vertex by vertex yet; use \"independent\"");
    }
}

GridWish wish_for(std::size_t cylinder, double area, const GridOptions& options) {
    GridWish wish{.cells = area / (options.strip_width_mm * options.strip_width_mm),
                  .counts = options.all,
                  .parity = options.parity,
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

// The quads of one cylinder, with vertices numbered from 0.
struct Patch {
    std::vector<Vector3d> vertices;
    std::vector<std::array<int, 4>> quads;
};

Patch sample_patch(const ChartGrid& grid, const ChartSampler& sampler, const Context& context) {
    Patch patch;
    for (int row = 0; row < grid.vertex_rows(); ++row) {
        context.check();
        const int end = grid.first_col(row) + grid.vertices_in(row);
        for (int col = grid.first_col(row); col < end; ++col) {
            patch.vertices.push_back(
                sampler.point(grid.unstraight({grid.s_level(col), grid.f_level(row)})));
        }
    }
    for (int row = 0; row < grid.grid().rows; ++row) {
        for (int col = 0; col < grid.grid().cols; ++col) {
            patch.quads.push_back({grid.vertex(row, col), grid.vertex(row, col + 1),
                                   grid.vertex(row + 1, col + 1), grid.vertex(row + 1, col)});
        }
    }
    return patch;
}

std::vector<SagCell> sag_cells(const Patch& patch,
                               const CellRegions& regions,
                               const ChartGrid& grid,
                               const ChartSampler& sampler) {
    std::vector<SagCell> cells;
    cells.reserve(patch.quads.size());
    for (int row = 0; row < grid.grid().rows; ++row) {
        for (int col = 0; col < grid.grid().cols; ++col) {
            const std::size_t at = cells.size();
            const double s = 0.5 * (grid.s_level(col) + grid.s_level(col + 1));
            const double f = 0.5 * (grid.f_level(row) + grid.f_level(row + 1));
            cells.push_back({.corners = patch.quads[at],
                             .surface_centre = sampler.point(grid.unstraight({s, f})),
                             .surface_vector_area = regions.vector_area[at]});
        }
    }
    return cells;
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

void check_regions(std::size_t cylinder, const CellRegions& regions, double area) {
    double sum = 0.0;
    for (const double region : regions.area) {
        sum += region;
    }
    if (std::abs(sum - area) > 1e-9 * area) {
        throw Error(ErrorKind::SelfCheck, "quads-regions",
                    fmt::format("quads: the cells of cylinder {} stand for {} mm2 of {} mm2",
                                cylinder, sum, area));
    }
}

void check_facing(std::size_t cylinder, const Patch& patch, const CellRegions& regions) {
    std::size_t inverted = 0;
    for (std::size_t i = 0; i < patch.quads.size(); ++i) {
        const Vector3d& region = regions.vector_area[i];
        if (region.norm() > kClearDirection * regions.area[i] &&
            is_inverted(patch.vertices, patch.quads[i], region)) {
            ++inverted;
        }
    }
    if (inverted > 0) {
        throw Error(ErrorKind::SelfCheck, "quads-inverted",
                    fmt::format("quads: {} of {} quads of cylinder {} face inwards; use narrower "
                                "strips (grid.strip_width_mm)",
                                inverted, patch.quads.size(), cylinder));
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
    append(mesh, patch, grid, regions);
}

// The grid among `even` and its regraded copies that comes closest to the surface: the smallest
// largest distance of those whose mean is not worse, else of those where it is little worse.
CylinderGrid closest_grid(const Work& work,
                          const CylinderGrid& even,
                          const GridOptions& options,
                          const Context& context) {
    const ClosestPoint surface(work.chart.mesh);
    const auto distance = [&](const CylinderGrid& grid) {
        QuadMesh mesh;
        add_cylinder(mesh, work, grid, options, context);
        mesh.addresses.assign(mesh.quads.size(), {});
        return measure_quality(mesh, surface, context).overall.surface_distance_percent;
    };
    struct Scored {
        CylinderGrid grid;
        MaxAvg distance;
    };
    std::vector<Scored> scored{{even, distance(even)}};
    for (CylinderGrid& grid : curvature_grids(work.chart, even, work.sampler, options.spacing)) {
        const MaxAvg found = distance(grid);
        scored.push_back({std::move(grid), found});
    }
    for (const double allowed : {1.0, kWorseMean}) {
        const double limit = allowed * scored.front().distance.avg;
        const Scored* best = &scored.front();
        for (const Scored& candidate : scored) {
            if (candidate.distance.avg <= limit && candidate.distance.max < best->distance.max) {
                best = &candidate;
            }
        }
        if (best != &scored.front()) {
            return best->grid;
        }
    }
    return even;
}

// The cylinder's quads at the wished size, or smaller ones where those would face inwards: a few
// cells can't follow a small cylinder that bends sharply.
void add_fine_enough(QuadMesh& mesh,
                     const Work& work,
                     GridWish wish,
                     const GridOptions& options,
                     const Context& context) {
    const bool may_refine = !wish.counts.rows || !wish.counts.cols;
    for (int doublings = 0;; ++doublings) {
        CylinderGrid grid = choose_grid(work.chart, wish);
        if (options.spacing != Spacing::Uniform) {
            grid = closest_grid(work, grid, options, context);
        }
        try {
            add_cylinder(mesh, work, grid, options, context);
        } catch (const Error& error) {
            if (error.code() != "quads-inverted" || !may_refine || doublings == kMostDoublings) {
                throw;
            }
            wish.cells *= 2.0;
            continue;
        }
        if (doublings > 0) {
            mesh.warnings.push_back(
                fmt::format("cylinder {}: has narrower strips than asked for, as wider ones would "
                            "fold over",
                            work.cylinder));
        }
        return;
    }
}

}  // namespace

QuadMesh build_quad_mesh(const Foliation& foliation,
                         const GridOptions& options,
                         const Context& context) {
    check_options(foliation, options);
    QuadMesh mesh;
    for (std::size_t i = 0; i < foliation.cylinders.size(); ++i) {
        const Cylinder& chart = foliation.cylinders[i];
        context.check();
        const ChartSampler sampler(chart);
        const Work work{
            .cylinder = i, .chart = chart, .sampler = sampler, .area = surface_area(chart.mesh)};
        context.check();
        add_fine_enough(mesh, work, wish_for(i, work.area, options), options, context);
    }
    return mesh;
}

}  // namespace leafcutter::geometry
