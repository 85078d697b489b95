#include "geometry/quads/cell_quality.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include <Eigen/Geometry>

#include "geometry/parallel.h"
#include "geometry/quads/bilinear_patch.h"
#include "geometry/quads/threads.h"

namespace leafcutter::geometry {

namespace {

using Eigen::Vector3d;

constexpr std::size_t kSamples = 7;  // Per side of a quad.

double relative_percent(double value, double reference) {
    return 100.0 * std::abs(value - reference) / std::max(reference, 1e-300);
}

// Distance between the diagonals over their mean length.
double planarity_percent(const BilinearPatch& quad) {
    const Vector3d ac = quad.c - quad.a;
    const Vector3d bd = quad.d - quad.b;
    const Vector3d normal = ac.cross(bd);
    const double gap = std::abs((quad.b - quad.a).dot(normal)) / std::max(normal.norm(), 1e-300);
    return 100.0 * gap / std::max(0.5 * (ac.norm() + bd.norm()), 1e-300);
}

double corner_deviation_deg(const BilinearPatch& quad) {
    const std::array corners = {quad.a, quad.b, quad.c, quad.d};
    double sum = 0.0;
    for (std::size_t i = 0; i < 4; ++i) {
        sum += std::abs(angle_between_deg(corners[(i + 1) % 4] - corners[i],
                                          corners[(i + 3) % 4] - corners[i]) -
                        90.0);
    }
    return 0.25 * sum;
}

// What the samples of a patch are closest to, and how far off they are.
struct Projection {
    std::array<Vector3d, kSamples * kSamples> points;
    double largest = 0.0;
    double mean = 0.0;  // By the trapezoid rule.
};

Projection project(const BilinearPatch& quad, const ClosestPoint& surface) {
    constexpr auto kLast = kSamples - 1;
    Projection projection;
    int near = -1;
    for (std::size_t i = 0; i < kSamples; ++i) {
        for (std::size_t k = 0; k < kSamples; ++k) {
            // To and fro, so that each sample starts from the hit of a neighbour.
            const std::size_t j = i % 2 == 0 ? k : kLast - k;
            const auto hit = surface.query(
                quad.at(static_cast<double>(j) / kLast, static_cast<double>(i) / kLast), near);
            near = hit.triangle;
            projection.points[i * kSamples + j] = hit.point;
            projection.largest = std::max(projection.largest, hit.distance);
            const double share = (i % kLast == 0 ? 0.5 : 1.0) * (j % kLast == 0 ? 0.5 : 1.0);
            projection.mean += share * hit.distance / static_cast<double>(kLast * kLast);
        }
    }
    return projection;
}

double area_of(const Projection& projection) {
    double area = 0.0;
    for (std::size_t i = 0; i + 1 < kSamples; ++i) {
        for (std::size_t j = 0; j + 1 < kSamples; ++j) {
            const auto corner =
                projection.points.begin() + static_cast<std::ptrdiff_t>(i * kSamples + j);
            area += split_area({corner[0], corner[1], corner[kSamples + 1], corner[kSamples]});
        }
    }
    return area;
}

CellQuality measure_cell(const BilinearPatch& quad, double region, const ClosestPoint& surface) {
    const Projection projection = project(quad, surface);
    CellQuality cell;
    cell.distance = projection.largest;
    cell.mean_distance = projection.mean;
    cell.area = split_area(quad);
    cell.projected_area = area_of(projection);
    cell.area_percent = relative_percent(cell.area, cell.projected_area);
    cell.region_area = region;
    cell.region_percent = region > 0.0 ? relative_percent(cell.area, region) : 0.0;
    cell.planarity_percent = planarity_percent(quad);
    cell.corner_deviation_deg = corner_deviation_deg(quad);
    cell.stretch = quad.warp_length() / std::max(quad.weft_length(), 1e-300);
    cell.shear_deg = angle_between_deg(quad.weft_middle(), quad.warp_middle()) - 90.0;
    return cell;
}

// Adds to each quad half the length of the leaf through it, so that both families
// together give the mean.
void add_half_leaf_lengths(const QuadMesh& mesh,
                           std::span<const Thread> leaves,
                           std::vector<double>& lengths) {
    for (const Thread& thread : leaves) {
        double length = 0.0;
        for (const int quad : thread.quads) {
            const BilinearPatch shape = patch_of(mesh, static_cast<std::size_t>(quad));
            length += thread.family == Family::Weft ? shape.weft_length() : shape.warp_length();
        }
        for (const int quad : thread.quads) {
            lengths[static_cast<std::size_t>(quad)] += 0.5 * length;
        }
    }
}

}  // namespace

std::vector<CellQuality> measure_cells(const QuadMesh& mesh,
                                       const ClosestPoint& surface,
                                       std::span<const Thread> leaves,
                                       const Context& context) {
    std::vector<CellQuality> cells(mesh.quads.size());
    for_each_index(mesh.quads.size(), context, [&](std::size_t i) {
        cells[i] = measure_cell(patch_of(mesh, i), mesh.surface_area[i], surface);
    });
    std::vector<double> leaf_lengths(mesh.quads.size(), 0.0);
    if (leaves.empty()) {
        for (const Family family : {Family::Weft, Family::Warp}) {
            add_half_leaf_lengths(mesh, trace_threads(mesh, family, ThreadEnds::AtCriticalLeaves),
                                  leaf_lengths);
        }
    } else {
        add_half_leaf_lengths(mesh, leaves, leaf_lengths);
    }
    for (std::size_t i = 0; i < cells.size(); ++i) {
        cells[i].distance_percent = 100.0 * cells[i].distance / std::max(leaf_lengths[i], 1e-300);
    }
    return cells;
}

}  // namespace leafcutter::geometry
