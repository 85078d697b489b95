// The quads of one cylinder on their way into a quad mesh.

#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "geometry/context.h"
#include "geometry/quads/cell_regions.h"
#include "geometry/quads/chart_sampler.h"
#include "geometry/quads/grid.h"
#include "geometry/quads/half_sag.h"

namespace leafcutter::geometry {

struct Patch {
    std::vector<Eigen::Vector3d> vertices;
    std::vector<std::array<int, 4>>
        quads;  // Of vertices numbered from 0, sorted by row and column.
};

// The chart's grid, on the surface.
Patch sample_patch(const ChartGrid& grid, const ChartSampler& sampler, const Context& context);

// What the half-sag offset needs to know of the patch's quads.
std::vector<SagCell> sag_cells(const Patch& patch,
                               const CellRegions& regions,
                               const ChartGrid& grid,
                               const ChartSampler& sampler);

// Throws Error(SelfCheck, "quads-regions") unless the cells stand for all of the cylinder's area.
void check_regions(std::size_t cylinder, const CellRegions& regions, double area);

// How many quads face inwards.
std::size_t count_inverted(const Patch& patch, const CellRegions& regions);

}  // namespace leafcutter::geometry
