// The paper's measures, section 5: angle deviation (equation of 5.1), surface distance and area
// distortion (5.2).
//
// Removed area. A conformal map makes the tip of a limb tiny in (g, f), so that one cell can stand
// for a whole finger: the quad closes the limb's foot like a lid. The surface behind the lid is not
// covered, and no other measure says so, as each sees only the lid. A cell caps a limb where the
// region it stands for is more than kCapFactor times the area the quad projects to. Where a chord
// bends through a right angle that begins: over a quarter of a round cylinder the factor is 1.11,
// over a spherical cap of 90 degrees 1.17. Beyond, the quad doesn't follow the surface any more and
// the difference counts as removed.

#include "geometry/quads/quality.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <span>

#include <Eigen/Geometry>

#include "geometry/parallel.h"
#include "geometry/quads/threads.h"

namespace leafcutter::geometry {

namespace {

using Eigen::Vector3d;

constexpr int kSamples = 7;  // Per side of a quad.
constexpr double kCapFactor = 1.1;

struct Quad {
    Vector3d a;
    Vector3d b;
    Vector3d c;
    Vector3d d;

    Vector3d at(double u, double v) const {
        return (1 - u) * (1 - v) * a + u * (1 - v) * b + u * v * c + (1 - u) * v * d;
    }
    double weft_length() const { return 0.5 * ((b - a).norm() + (c - d).norm()); }
    double warp_length() const { return 0.5 * ((d - a).norm() + (c - b).norm()); }
};

Quad quad_at(const QuadMesh& mesh, std::size_t quad) {
    const auto& corners = mesh.quads[quad];
    return {.a = mesh.vertices[static_cast<std::size_t>(corners[0])],
            .b = mesh.vertices[static_cast<std::size_t>(corners[1])],
            .c = mesh.vertices[static_cast<std::size_t>(corners[2])],
            .d = mesh.vertices[static_cast<std::size_t>(corners[3])]};
}

double doubled_area(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
    return (b - a).cross(c - a).norm();
}

// Split along a–c, as everywhere a grid of points stands for an area.
double quad_area(const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& d) {
    return 0.5 * (doubled_area(a, b, c) + doubled_area(a, c, d));
}

double degrees(double radians) {
    return radians * 180.0 / std::numbers::pi;
}

double angle_between_deg(const Vector3d& u, const Vector3d& v) {
    const double lengths = std::max(u.norm() * v.norm(), 1e-300);
    return degrees(std::acos(std::clamp(u.dot(v) / lengths, -1.0, 1.0)));
}

// What is measured quad by quad.
struct QuadFigures {
    double area = 0.0;
    double projected_area = 0.0;
    double distance = 0.0;
    double distance_percent = 0.0;
    double area_percent = 0.0;
    double planarity_percent = 0.0;
};

// Distance between the diagonals over their mean length.
double planarity_percent(const Quad& quad) {
    const Vector3d ac = quad.c - quad.a;
    const Vector3d bd = quad.d - quad.b;
    const Vector3d normal = ac.cross(bd);
    const double gap = std::abs((quad.b - quad.a).dot(normal)) / std::max(normal.norm(), 1e-300);
    return 100.0 * gap / std::max(0.5 * (ac.norm() + bd.norm()), 1e-300);
}

QuadFigures project(const Quad& quad, const ClosestPoint& surface) {
    constexpr std::size_t kSide = kSamples;
    std::array<Vector3d, kSide * kSide> hits;
    QuadFigures figures;
    int near = -1;
    for (std::size_t i = 0; i < kSide; ++i) {
        for (std::size_t k = 0; k < kSide; ++k) {
            // To and fro, so that each sample starts from the hit of a neighbour.
            const std::size_t j = i % 2 == 0 ? k : kSide - 1 - k;
            const auto hit = surface.query(quad.at(static_cast<double>(j) / (kSamples - 1),
                                                   static_cast<double>(i) / (kSamples - 1)),
                                           near);
            near = hit.triangle;
            hits[i * kSide + j] = hit.point;
            figures.distance = std::max(figures.distance, hit.distance);
        }
    }
    for (std::size_t i = 0; i + 1 < kSide; ++i) {
        for (std::size_t j = 0; j + 1 < kSide; ++j) {
            const std::size_t at = i * kSide + j;
            figures.projected_area +=
                quad_area(hits[at], hits[at + 1], hits[at + kSide + 1], hits[at + kSide]);
        }
    }
    figures.area = quad_area(quad.a, quad.b, quad.c, quad.d);
    figures.area_percent = 100.0 * std::abs(figures.area - figures.projected_area) /
                           std::max(figures.projected_area, 1e-300);
    figures.planarity_percent = planarity_percent(quad);
    return figures;
}

// Adds to each quad half the length of the leaf of `family` through it, so that both families
// together give the mean.
void add_half_leaf_lengths(const QuadMesh& mesh, Family family, std::vector<double>& lengths) {
    for (const Thread& thread : trace_threads(mesh, family, ThreadEnds::AtCriticalLeaves)) {
        double length = 0.0;
        for (const int quad : thread.quads) {
            const Quad shape = quad_at(mesh, static_cast<std::size_t>(quad));
            length += family == Family::Weft ? shape.weft_length() : shape.warp_length();
        }
        for (const int quad : thread.quads) {
            lengths[static_cast<std::size_t>(quad)] += 0.5 * length;
        }
    }
}

std::vector<QuadFigures> measure_quads(const QuadMesh& mesh,
                                       const ClosestPoint& surface,
                                       const Context& context) {
    std::vector<QuadFigures> figures(mesh.quads.size());
    for_each_index(mesh.quads.size(), context,
                   [&](std::size_t i) { figures[i] = project(quad_at(mesh, i), surface); });
    std::vector<double> leaf_lengths(mesh.quads.size(), 0.0);
    add_half_leaf_lengths(mesh, Family::Weft, leaf_lengths);
    add_half_leaf_lengths(mesh, Family::Warp, leaf_lengths);
    for (std::size_t i = 0; i < figures.size(); ++i) {
        figures[i].distance_percent =
            100.0 * figures[i].distance / std::max(leaf_lengths[i], 1e-300);
    }
    return figures;
}

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

// What a set of quads shows at one vertex.
struct VertexStar {
    double corner_deviation_sum = 0.0;
    double angle_sum_deg = 0.0;
    int corners = 0;
    std::array<double, 4> angle_deg{};  // Of the corner a, b, c, d that a quad has here.

    // Neighbours along the leaves: weft before, weft after, warp before, warp after.
    std::array<int, 4> next{-1, -1, -1, -1};
    bool regular = true;  // At most one neighbour in each place.

    void meet(std::size_t place, int vertex) {
        regular = regular && (next[place] < 0 || next[place] == vertex);
        next[place] = vertex;
    }
    bool is_interior_crossing() const {
        return regular && corners == 4 &&
               std::all_of(next.begin(), next.end(), [](int v) { return v >= 0; });
    }

    // Three prongs or more: the corners share a full turn, whatever the leaves do.
    bool is_singular() const { return !regular && corners >= 6; }
    double mean_angle_deg() const { return angle_sum_deg / corners; }

    // How far the leaves turn within the surface: half of what the angles on their two sides differ
    // by. Corner a of a quad lies ahead of both leaves, b behind on the weft, d behind on the warp.
    double weft_turning_deg() const {
        return 0.5 * std::abs(angle_deg[0] + angle_deg[1] - angle_deg[2] - angle_deg[3]);
    }
    double warp_turning_deg() const {
        return 0.5 * std::abs(angle_deg[0] + angle_deg[3] - angle_deg[1] - angle_deg[2]);
    }
};

std::vector<VertexStar> collect_stars(const QuadMesh& mesh, std::span<const std::size_t> quads) {
    constexpr std::size_t kWeftBefore = 0;
    constexpr std::size_t kWeftAfter = 1;
    constexpr std::size_t kWarpBefore = 2;
    constexpr std::size_t kWarpAfter = 3;
    std::vector<VertexStar> stars(mesh.vertices.size());
    const auto star = [&stars](int vertex) -> VertexStar& {
        return stars[static_cast<std::size_t>(vertex)];
    };
    for (const std::size_t quad : quads) {
        const auto& corners = mesh.quads[quad];
        const auto position = [&](std::size_t corner) -> const Vector3d& {
            return mesh.vertices[static_cast<std::size_t>(corners[corner % 4])];
        };
        for (std::size_t i = 0; i < 4; ++i) {
            const double angle =
                angle_between_deg(position(i + 1) - position(i), position(i + 3) - position(i));
            VertexStar& here = star(corners[i]);
            here.corner_deviation_sum += std::abs(angle - 90.0);
            here.angle_deg[i] = angle;
            here.angle_sum_deg += angle;
            ++here.corners;
        }
        const auto [a, b, c, d] = corners;
        for (const auto& [from, to] : {std::pair{a, b}, std::pair{d, c}}) {
            star(from).meet(kWeftAfter, to);
            star(to).meet(kWeftBefore, from);
        }
        for (const auto& [from, to] : {std::pair{a, d}, std::pair{b, c}}) {
            star(from).meet(kWarpAfter, to);
            star(to).meet(kWarpBefore, from);
        }
    }
    return stars;
}

void measure_vertices(const QuadMesh& mesh, std::span<const std::size_t> quads, Quality& quality) {
    const std::vector<VertexStar> stars = collect_stars(mesh, quads);
    Average deviation;
    Average bound;
    Average crossing;
    for (std::size_t v = 0; v < stars.size(); ++v) {
        const VertexStar& star = stars[v];
        if (star.corners == 0) {
            continue;
        }
        deviation.add(star.corner_deviation_sum / star.corners);
        if (star.is_singular()) {
            bound.add(std::abs(star.mean_angle_deg() - 90.0));
        }
        if (!star.is_interior_crossing()) {
            continue;
        }
        const auto towards = [&](std::size_t place) -> Vector3d {
            return mesh.vertices[static_cast<std::size_t>(star.next[place])] - mesh.vertices[v];
        };
        bound.add(0.5 * std::max(star.weft_turning_deg(), star.warp_turning_deg()));
        crossing.add(
            std::abs(angle_between_deg(towards(1) - towards(0), towards(3) - towards(2)) - 90.0));
    }
    quality.angle_deviation_deg = deviation.both();
    quality.angle_deviation_bound_deg = bound.mean();
    quality.crossing_angle_deviation_deg = crossing.both();
}

Quality summarise(const QuadMesh& mesh,
                  const std::vector<QuadFigures>& figures,
                  std::span<const std::size_t> quads) {
    Average distance;
    Average area;
    Average planarity;
    Average region;
    Average edge;
    for (const std::size_t i : quads) {
        distance.add(figures[i].distance_percent);
        area.add(figures[i].area_percent);
        planarity.add(figures[i].planarity_percent);
        region.add(mesh.surface_area[i]);
        edge.add(std::sqrt(mesh.surface_area[i]));
    }
    Quality quality;
    quality.quads = static_cast<int>(quads.size());
    measure_vertices(mesh, quads, quality);
    quality.surface_distance_percent = distance.both();
    quality.area_distortion_percent = area.mean();
    quality.planarity_percent = planarity.both();
    quality.cell_area_variation = region.variation();
    quality.largest_cell_edge = edge.mean() > 0.0 ? edge.max() / edge.mean() : 0.0;
    return quality;
}

double removed_area(const QuadMesh& mesh, const std::vector<QuadFigures>& figures) {
    double removed = 0.0;
    for (std::size_t i = 0; i < figures.size(); ++i) {
        const double region = mesh.surface_area[i];
        if (region > kCapFactor * figures[i].projected_area) {
            removed += region - figures[i].projected_area;
        }
    }
    return removed;
}

}  // namespace

QualityReport measure_quality(const QuadMesh& mesh,
                              const ClosestPoint& surface,
                              const Context& context) {
    const std::vector<QuadFigures> figures = measure_quads(mesh, surface, context);
    std::vector<std::vector<std::size_t>> of_cylinder(mesh.grids.size());
    std::vector<std::size_t> all;
    for (std::size_t i = 0; i < mesh.quads.size(); ++i) {
        of_cylinder[static_cast<std::size_t>(mesh.addresses[i].cylinder)].push_back(i);
        all.push_back(i);
    }
    QualityReport report;
    report.overall = summarise(mesh, figures, all);
    for (const std::vector<std::size_t>& quads : of_cylinder) {
        report.per_cylinder.push_back(summarise(mesh, figures, quads));
    }
    report.removed_area_percent = 100.0 * removed_area(mesh, figures) / surface.total_area();
    return report;
}

}  // namespace leafcutter::geometry
