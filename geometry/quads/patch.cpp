#include "geometry/quads/patch.h"

#include <cmath>

#include <fmt/format.h>

#include "geometry/error.h"

namespace leafcutter::geometry {
namespace {

using Eigen::Vector3d;

// A region whose triangles cancel to less than this share of its area has no clear direction.
constexpr double kClearDirection = 0.2;

}  // namespace

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

std::size_t count_inverted(const Patch& patch, const CellRegions& regions) {
    std::size_t inverted = 0;
    for (std::size_t i = 0; i < patch.quads.size(); ++i) {
        const Vector3d& region = regions.vector_area[i];
        if (region.norm() > kClearDirection * regions.area[i] &&
            is_inverted(patch.vertices, patch.quads[i], region)) {
            ++inverted;
        }
    }
    return inverted;
}

}  // namespace leafcutter::geometry
