#include "geometry/quads/two_sided.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include <Eigen/Geometry>

#include "geometry/parallel.h"
#include "geometry/quads/bilinear_patch.h"
#include "geometry/surface_measures.h"

namespace leafcutter::geometry {

namespace {

using Eigen::Vector3d;

constexpr std::size_t kSide = 2;          // Squares per side of a patch that lead to it.
constexpr int kRefinements = 6;           // A patch's middle lines are about square: enough.
constexpr double kSampleShare = 0.5;      // Triangles are measured in parts at most so large, in
                                          // edges of a mean cell.
constexpr std::size_t kMostParts = 4096;  // Of one triangle.

// The closest point of [from, to], as its place in [0, 1].
double place_on_segment(const Vector3d& point, const Vector3d& from, const Vector3d& to) {
    const Vector3d along = to - from;
    const double length2 = along.squaredNorm();
    return length2 > 0.0 ? std::clamp((point - from).dot(along) / length2, 0.0, 1.0) : 0.0;
}

// Distance to the patch, from the parameters of a point close by: along straight lines of the
// patch, in one direction and the other by turns.
double distance_to_patch(const BilinearPatch& patch, const Vector3d& point, double u, double v) {
    for (int i = 0; i < kRefinements; ++i) {
        u = place_on_segment(point, patch.at(0.0, v), patch.at(1.0, v));
        v = place_on_segment(point, patch.at(u, 0.0), patch.at(u, 1.0));
    }
    return (patch.at(u, v) - point).norm();
}

// Finds distances to the patches of a quad mesh.
class QuadDistance {
public:
    explicit QuadDistance(const QuadMesh& mesh) : mesh_(mesh), tree_(leading_triangles(mesh)) {}

    double from(const Vector3d& point) const {
        const auto square = static_cast<std::size_t>(tree_.query(point).triangle) / 2;
        constexpr std::size_t kSquares = kSide * kSide;
        const std::size_t row = square % kSquares / kSide;
        const std::size_t col = square % kSide;
        return distance_to_patch(patch_of(mesh_, square / kSquares), point,
                                 (static_cast<double>(col) + 0.5) / kSide,
                                 (static_cast<double>(row) + 0.5) / kSide);
    }

private:
    static TriangleMesh leading_triangles(const QuadMesh& mesh) {
        TriangleMesh triangles;
        for (std::size_t q = 0; q < mesh.quads.size(); ++q) {
            const BilinearPatch patch = patch_of(mesh, q);
            const auto base = static_cast<int>(triangles.positions.size());
            for (std::size_t i = 0; i <= kSide; ++i) {
                for (std::size_t j = 0; j <= kSide; ++j) {
                    triangles.positions.push_back(
                        patch.at(static_cast<double>(j) / kSide, static_cast<double>(i) / kSide));
                }
            }
            constexpr auto kLine = static_cast<int>(kSide) + 1;
            for (int at = base; at + kLine < base + kLine * kLine; ++at) {
                if ((at - base) % kLine != kLine - 1) {
                    triangles.triangles.push_back({at, at + 1, at + kLine + 1});
                    triangles.triangles.push_back({at, at + kLine + 1, at + kLine});
                }
            }
        }
        return triangles;
    }

    const QuadMesh& mesh_;
    ClosestPoint tree_;
};

// Largest distance, and the integral over an area.
struct Gap {
    double max = 0.0;
    double integral = 0.0;
};

// At the middles of parts of a triangle no longer than `step`, halved across their longest side.
Gap gap_of_triangle(const std::array<Vector3d, 3>& triangle,
                    double step,
                    const QuadDistance& quads) {
    Gap gap;
    std::vector<std::array<Vector3d, 3>> open = {triangle};
    std::size_t parts = 1;
    while (!open.empty()) {
        const std::array<Vector3d, 3> part = open.back();
        open.pop_back();
        std::size_t longest = 0;
        std::array<double, 3> length{};
        for (std::size_t i = 0; i < 3; ++i) {
            length[i] = (part[(i + 1) % 3] - part[i]).norm();
            longest = length[i] > length[longest] ? i : longest;
        }
        if (length[longest] > step && parts < kMostParts) {
            const Vector3d& from = part[longest];
            const Vector3d& to = part[(longest + 1) % 3];
            const Vector3d& apex = part[(longest + 2) % 3];
            const Vector3d middle = 0.5 * (from + to);
            open.push_back({from, middle, apex});
            open.push_back({middle, to, apex});
            ++parts;
            continue;
        }
        const double distance = quads.from((part[0] + part[1] + part[2]) / 3.0);
        gap.max = std::max(gap.max, distance);
        gap.integral += 0.5 * (part[1] - part[0]).cross(part[2] - part[0]).norm() * distance;
    }
    return gap;
}

double mean_cell_edge(const std::vector<CellQuality>& cells) {
    double sum = 0.0;
    for (const CellQuality& cell : cells) {
        sum += std::sqrt(cell.area);
    }
    return sum / static_cast<double>(cells.size());
}

MaxAvg from_surface(const QuadMesh& mesh,
                    const TriangleMesh& surface,
                    double step,
                    const Context& context) {
    const QuadDistance quads(mesh);
    std::vector<Gap> gaps(surface.triangles.size());
    for_each_index(gaps.size(), context, [&](std::size_t t) {
        std::array<Vector3d, 3> corners;
        for (std::size_t i = 0; i < 3; ++i) {
            corners[i] = surface.positions[static_cast<std::size_t>(surface.triangles[t][i])];
        }
        gaps[t] = gap_of_triangle(corners, step, quads);
    });
    std::vector<double> at_vertices(surface.positions.size());
    for_each_index(at_vertices.size(), context,
                   [&](std::size_t v) { at_vertices[v] = quads.from(surface.positions[v]); });
    MaxAvg result{.max = *std::max_element(at_vertices.begin(), at_vertices.end()), .avg = 0.0};
    for (const Gap& gap : gaps) {
        result.max = std::max(result.max, gap.max);
        result.avg += gap.integral;
    }
    result.avg /= std::max(surface_area(surface), 1e-300);
    return result;
}

MaxAvg from_quads(const std::vector<CellQuality>& cells) {
    MaxAvg result;
    double area = 0.0;
    for (const CellQuality& cell : cells) {
        result.max = std::max(result.max, cell.distance);
        result.avg += cell.area * cell.mean_distance;
        area += cell.area;
    }
    result.avg /= std::max(area, 1e-300);
    return result;
}

MaxAvg in_percent(const MaxAvg& value, double whole) {
    return {.max = 100.0 * value.max / whole, .avg = 100.0 * value.avg / whole};
}

}  // namespace

TwoSidedDistance measure_two_sided(const QuadMesh& mesh,
                                   const std::vector<CellQuality>& cells,
                                   const TriangleMesh& surface,
                                   const Context& context) {
    const double whole = diagonal(surface);
    TwoSidedDistance result;
    result.quads_to_surface = in_percent(from_quads(cells), whole);
    result.surface_to_quads = in_percent(
        from_surface(mesh, surface, kSampleShare * mean_cell_edge(cells), context), whole);
    result.both = {.max = std::max(result.quads_to_surface.max, result.surface_to_quads.max),
                   .avg = 0.5 * (result.quads_to_surface.avg + result.surface_to_quads.avg)};
    return result;
}

}  // namespace leafcutter::geometry
