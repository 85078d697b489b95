#include "geometry/quads/graded_rows.h"

#include <cstddef>

#include "geometry/closest_point.h"
#include "geometry/parallel.h"
#include "geometry/quads/chart_sampler.h"
#include "geometry/quads/graded_grid.h"
#include "geometry/quads/quality.h"

namespace leafcutter::geometry {
namespace {

constexpr double kWorseMean = 1.01;

QuadMesh quads_of(const JoinedMesh& joined) {
    QuadMesh mesh;
    mesh.vertices = joined.vertices;
    for (std::size_t c = 0; c < joined.parts.size(); ++c) {
        const JoinedCylinder& part = joined.parts[c];
        for (std::size_t i = 0; i < part.quads.size(); ++i) {
            mesh.quads.push_back(part.quads[i]);
            mesh.addresses.push_back({.cylinder = static_cast<int>(c),
                                      .row = static_cast<int>(i) / part.grid.cols,
                                      .col = static_cast<int>(i) % part.grid.cols});
        }
        mesh.surface_area.insert(mesh.surface_area.end(), part.surface_area.begin(),
                                 part.surface_area.end());
        mesh.grids.push_back(part.grid);
    }
    return mesh;
}

TriangleMesh surface_of(const JoinedMesh& joined) {
    TriangleMesh surface;
    for (const JoinedCylinder& part : joined.parts) {
        const int first = static_cast<int>(surface.positions.size());
        surface.positions.insert(surface.positions.end(), part.chart.mesh.positions.begin(),
                                 part.chart.mesh.positions.end());
        for (const auto& [a, b, c] : part.chart.mesh.triangles) {
            surface.triangles.push_back({a + first, b + first, c + first});
        }
    }
    return surface;
}

}  // namespace

std::vector<std::vector<double>> graded_rows(const JoinedMesh& even,
                                             const GridOptions& options,
                                             const Context& context) {
    std::vector<std::vector<double>> rows(even.parts.size());
    for_each_task(even.parts.size(), context, [&](std::size_t i, const Context& own) {
        const JoinedCylinder& part = even.parts[i];
        if (part.grid.rows < 2) {
            return;
        }
        const ChartSampler sampler(part.chart);
        const CylinderGrid graded = graded_grid({.chart = part.chart,
                                                 .sampler = sampler,
                                                 .even = part.grid,
                                                 .spacing = options.spacing,
                                                 .half_sag_offset = options.half_sag_offset,
                                                 .movable = {.rows = true, .cols = false}},
                                                own);
        if (graded.f_levels != part.grid.f_levels) {
            rows[i] = graded.f_levels;
        }
    });
    return rows;
}

CameCloser compare_distances(const JoinedMesh& even,
                             const JoinedMesh& graded,
                             const Context& context) {
    const ClosestPoint surface(surface_of(even));
    const QualityReport before = measure_quality(quads_of(even), surface, context);
    const QualityReport after = measure_quality(quads_of(graded), surface, context);
    CameCloser closer;
    for (std::size_t i = 0; i < even.parts.size(); ++i) {
        const MaxAvg was = before.per_cylinder[i].surface_distance_percent;
        const MaxAvg is = after.per_cylinder[i].surface_distance_percent;
        closer.parts.push_back(is.max < was.max && is.avg <= kWorseMean * was.avg ? 1 : 0);
    }
    const MaxAvg was = before.overall.surface_distance_percent;
    const MaxAvg is = after.overall.surface_distance_percent;
    closer.whole = is.max <= was.max && is.avg <= was.avg;
    return closer;
}

}  // namespace leafcutter::geometry
