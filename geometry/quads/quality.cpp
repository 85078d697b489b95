// The paper's measures, section 5: angle deviation (equation of 5.1), surface distance and area
// distortion (5.2).
//
// Removed area. A conformal map makes the tip of a limb tiny in (g, f), so that one cell can stand
// for a whole finger: the quad closes the limb's foot like a lid. The surface behind the lid is not
// covered, and no other measure says so, as each sees only the lid. A cell caps a limb where the
// region it stands for is more than kCapFactor times the area the quad projects to. Where a chord
// bends through a right angle that begins: over a quarter of a round cylinder the factor is 1.11,
// over a spherical cap of 90 degrees 1.17. Beyond, the quad doesn't follow the surface any more and
// the difference counts as removed, unless neighbours cover the place.

#include "geometry/quads/quality.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

namespace leafcutter::geometry {

namespace {

constexpr double kCapFactor = 1.1;

class Average {
public:
    void add(double value) {
        max_ = std::max(max_, value);
        sum_ += value;
        squares_ += value * value;
        ++count_;
    }
    double mean() const { return count_ == 0 ? 0.0 : sum_ / static_cast<double>(count_); }
    double max() const { return max_; }
    MaxAvg both() const { return {.max = max_, .avg = mean()}; }
    // Standard deviation over mean.
    double variation() const {
        const double mean_value = mean();
        if (!(mean_value > 0.0)) {
            return 0.0;
        }
        const double variance = squares_ / static_cast<double>(count_) - mean_value * mean_value;
        return std::sqrt(std::max(variance, 0.0)) / mean_value;
    }

private:
    double max_ = 0.0;
    double sum_ = 0.0;
    double squares_ = 0.0;
    std::size_t count_ = 0;
};

void summarise_vertices(std::span<const VertexQuality> vertices, Quality& quality) {
    Average all;
    Average interior;
    Average singular;
    Average boundary;
    Average corner;
    Average bound;
    Average crossing;
    for (const VertexQuality& vertex : vertices) {
        if (vertex.place == VertexPlace::None) {
            continue;
        }
        const double deviation = vertex.angle_deviation_deg;
        all.add(deviation);
        if (vertex.bound_deg) {
            interior.add(deviation);
            bound.add(*vertex.bound_deg);
        }
        if (vertex.place == VertexPlace::Singular) {
            singular.add(deviation);
        } else if (vertex.place == VertexPlace::Boundary) {
            boundary.add(deviation);
        } else if (vertex.place == VertexPlace::Corner) {
            corner.add(deviation);
        }
        if (vertex.crossing_deviation_deg) {
            crossing.add(*vertex.crossing_deviation_deg);
        }
    }
    quality.angle_deviation_deg = all.both();
    quality.angle_deviation_interior_deg = interior.both();
    quality.angle_deviation_singular_deg = singular.both();
    quality.angle_deviation_boundary_deg = boundary.both();
    quality.angle_deviation_corner_deg = corner.both();
    quality.angle_deviation_bound_deg = bound.mean();
    quality.crossing_angle_deviation_deg = crossing.both();
}

Quality summarise(std::span<const CellQuality> cells,
                  std::span<const std::size_t> quads,
                  std::span<const VertexQuality> vertices,
                  double diagonal) {
    Average distance;
    Average on_diagonal;
    Average area;
    Average region_distortion;
    Average planarity;
    Average region;
    Average edge;
    for (const std::size_t i : quads) {
        const CellQuality& cell = cells[i];
        distance.add(cell.distance_percent);
        on_diagonal.add(100.0 * cell.distance / diagonal);
        area.add(cell.area_percent);
        region_distortion.add(cell.region_percent);
        planarity.add(cell.planarity_percent);
        region.add(cell.region_area);
        edge.add(std::sqrt(cell.region_area));
    }
    Quality quality;
    quality.quads = static_cast<int>(quads.size());
    summarise_vertices(vertices, quality);
    quality.surface_distance_percent = distance.both();
    quality.distance_diagonal_percent = on_diagonal.both();
    quality.area_distortion_percent = area.mean();
    quality.region_distortion_percent = region_distortion.both();
    quality.planarity_percent = planarity.both();
    quality.cell_area_variation = region.variation();
    quality.largest_cell_edge = edge.mean() > 0.0 ? edge.max() / edge.mean() : 0.0;
    return quality;
}

double removed_area(std::span<const CellQuality> cells) {
    double removed = 0.0;
    double lacking = 0.0;
    for (const CellQuality& cell : cells) {
        if (cell.region_area > kCapFactor * cell.projected_area) {
            removed += cell.region_area - cell.projected_area;
        }
        lacking += cell.region_area - cell.projected_area;
    }
    return std::clamp(lacking, 0.0, removed);
}

}  // namespace

QualityReport measure_quality(const QuadMesh& mesh,
                              const ClosestPoint& surface,
                              const Context& context,
                              std::span<const Thread> leaves) {
    std::vector<std::vector<std::size_t>> of_cylinder(mesh.grids.size());
    std::vector<std::size_t> all;
    for (std::size_t i = 0; i < mesh.quads.size(); ++i) {
        of_cylinder[static_cast<std::size_t>(mesh.addresses[i].cylinder)].push_back(i);
        all.push_back(i);
    }
    QualityReport report;
    report.cells = measure_cells(mesh, surface, leaves, context);
    report.vertices = measure_vertices(mesh, all);
    const double diagonal = surface.diagonal();
    report.overall = summarise(report.cells, all, report.vertices, diagonal);
    for (const std::vector<std::size_t>& quads : of_cylinder) {
        context.check();
        report.per_cylinder.push_back(
            summarise(report.cells, quads, measure_vertices(mesh, quads), diagonal));
    }
    report.removed_area_percent = 100.0 * removed_area(report.cells) / surface.total_area();
    return report;
}

}  // namespace leafcutter::geometry
