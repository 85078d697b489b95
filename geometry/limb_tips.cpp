#include "geometry/limb_tips.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <numbers>
#include <numeric>
#include <unordered_map>

#include <Eigen/Geometry>

#include "geometry/half_edges.h"
#include "geometry/surface_distance.h"
#include "geometry/surface_measures.h"

namespace leafcutter::geometry {
namespace {

constexpr std::size_t kSamples = 40;
constexpr double kFar = std::numeric_limits<double>::infinity();
// Where a disk has less than this part of a flat one's area, it reaches round a limb. For a tube
// with a round cap that happens at kReach radii.
constexpr double kRoundsLimb = 0.6;
constexpr double kReach = 2.6;
constexpr int kRadiusSteps = 48;

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

std::vector<int> boundary_vertices(const TriangleMesh& mesh) {
    const HalfEdges edges =
        build_half_edges(mesh.triangles, static_cast<int>(mesh.positions.size()));
    std::vector<int> vertices;
    for (int h = 0; h < edges.size(); ++h) {
        if (edges.twin_of(h) < 0) {
            vertices.push_back(edges.from_of(h));
        }
    }
    return vertices;
}

int farthest(const std::vector<double>& distance) {
    return static_cast<int>(std::max_element(distance.begin(), distance.end()) - distance.begin());
}

// Lowers `nearest` to the distances from `sources`; returns those.
std::vector<double> take_in(SurfaceDistance& distances,
                            std::span<const int> sources,
                            std::vector<double>& nearest) {
    std::vector<double> distance(nearest.size(), 0.0);
    for (const auto& [v, d] : distances.from(sources)) {
        distance[at(v)] = d;
        nearest[at(v)] = std::min(nearest[at(v)], d);
    }
    return distance;
}

// Per vertex the mean distance from points spread over the surface.
std::vector<double> average_distance(const TriangleMesh& mesh, const Context& context) {
    SurfaceDistance distances(mesh);
    std::vector<double> nearest(mesh.positions.size(), kFar);
    std::vector<double> sum(mesh.positions.size(), 0.0);
    // The first point is an end of the surface, whatever vertex is number 0.
    const int start = 0;
    int sample = farthest(take_in(distances, std::span(&start, 1), nearest));
    std::fill(nearest.begin(), nearest.end(), kFar);
    for (std::size_t k = 0; k < kSamples; ++k) {
        context.check();
        const std::vector<double> distance = take_in(distances, std::span(&sample, 1), nearest);
        for (std::size_t v = 0; v < sum.size(); ++v) {
            sum[v] += distance[v] / static_cast<double>(kSamples);
        }
        sample = farthest(nearest);
    }
    return sum;
}

// Parts of the surface above a falling level, joined as they meet.
class Peaks {
public:
    explicit Peaks(std::size_t vertices) : parent_(vertices, -1), summit_(vertices, kFar) {}

    bool is_above(int vertex) const { return parent_[at(vertex)] >= 0; }
    void start(int vertex, double height) {
        parent_[at(vertex)] = vertex;
        summit_[at(vertex)] = height;
    }
    int find(int vertex) {
        while (parent_[at(vertex)] != vertex) {
            parent_[at(vertex)] = parent_[at(parent_[at(vertex)])];
            vertex = parent_[at(vertex)];
        }
        return vertex;
    }
    double summit(int peak) const { return summit_[at(peak)]; }
    void join(int lower, int higher) { parent_[at(lower)] = higher; }

private:
    std::vector<int> parent_;  // -1 below the level. A root is its part's summit.
    std::vector<double> summit_;
};

// All maxima with their persistence. The boundary is higher than everything.
std::vector<LimbTip> persistent_maxima(const TriangleMesh& mesh,
                                       const std::vector<double>& height,
                                       std::span<const int> boundary) {
    SurfaceDistance rings(mesh);
    Peaks peaks(height.size());
    for (const int v : boundary) {
        peaks.start(v, kFar);
        peaks.join(v, boundary.front());
    }
    std::vector<int> order(height.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(),
                     [&](int a, int b) { return height[at(a)] > height[at(b)]; });
    std::vector<LimbTip> tips;
    for (const int v : order) {
        if (!peaks.is_above(v)) {
            peaks.start(v, height[at(v)]);
        }
        for (const int t : rings.triangles_of(v)) {
            for (const int w : mesh.triangles[at(t)]) {
                if (!peaks.is_above(w) || peaks.find(w) == peaks.find(v)) {
                    continue;
                }
                std::array<int, 2> pair{peaks.find(v), peaks.find(w)};
                if (peaks.summit(pair[0]) > peaks.summit(pair[1])) {
                    std::swap(pair[0], pair[1]);
                }
                if (pair[0] != v) {
                    tips.push_back({pair[0], peaks.summit(pair[0]) - height[at(v)]});
                }
                peaks.join(pair[0], pair[1]);
            }
        }
    }
    if (boundary.empty()) {
        tips.push_back({order.front(), height[at(order.front())] - height[at(order.back())]});
    }
    std::stable_sort(tips.begin(), tips.end(), [](const LimbTip& a, const LimbTip& b) {
        return a.persistence > b.persistence;
    });
    return tips;
}

// A triangle that lies between two distances from somewhere.
struct Band {
    double low = 0.0;
    double high = 0.0;
    double area = 0.0;

    double area_within(double radius) const {
        return radius >= high ? area : radius <= low ? 0.0 : area * (radius - low) / (high - low);
    }
};

// Of all triangles whose corners' distances are known.
std::vector<Band> bands_of(const TriangleMesh& mesh,
                           const SurfaceDistance& rings,
                           const std::vector<SurfaceDistance::Reached>& ball) {
    std::unordered_map<int, double> distance;
    for (const SurfaceDistance::Reached& reached : ball) {
        distance.emplace(reached.vertex, reached.distance);
    }
    std::vector<Band> bands;
    for (const auto& [vertex, unused] : ball) {
        for (const int t : rings.triangles_of(vertex)) {
            const auto& corners = mesh.triangles[at(t)];
            std::array<double, 3> d{};
            bool is_known = true;
            for (std::size_t k = 0; k < 3; ++k) {
                const auto found = distance.find(corners[k]);
                is_known = is_known && found != distance.end();
                d[k] = is_known ? found->second : 0.0;
            }
            if (is_known && corners[0] == vertex) {  // Once for each triangle.
                const Eigen::Vector3d& a = mesh.positions[at(corners[0])];
                const Eigen::Vector3d ab = mesh.positions[at(corners[1])] - a;
                const Eigen::Vector3d ac = mesh.positions[at(corners[2])] - a;
                bands.push_back({*std::min_element(d.begin(), d.end()),
                                 *std::max_element(d.begin(), d.end()), 0.5 * ab.cross(ac).norm()});
            }
        }
    }
    return bands;
}

}  // namespace

std::vector<LimbTip> find_limb_tips(const TriangleMesh& mesh,
                                    const LimbTipOptions& options,
                                    const Context& context) {
    const double size = diagonal(mesh);
    const std::vector<int> boundary = boundary_vertices(mesh);
    SurfaceDistance distances(mesh);
    std::vector<double> nearest(mesh.positions.size(), kFar);
    take_in(distances, boundary, nearest);
    std::vector<LimbTip> tips;
    for (LimbTip tip : persistent_maxima(mesh, average_distance(mesh, context), boundary)) {
        tip.persistence /= size;
        if (tip.persistence >= options.least_persistence &&
            nearest[at(tip.vertex)] >= options.least_distance * size) {
            context.check();
            take_in(distances, std::span(&tip.vertex, 1), nearest);
            tips.push_back(tip);
        }
    }
    return tips;
}

std::vector<int> farthest_vertices(const TriangleMesh& mesh,
                                   std::span<const int> taken,
                                   std::size_t count,
                                   const Context& context) {
    std::vector<int> sources = boundary_vertices(mesh);
    sources.insert(sources.end(), taken.begin(), taken.end());
    SurfaceDistance distances(mesh);
    std::vector<double> nearest(mesh.positions.size(), kFar);
    if (sources.empty()) {
        const int start = 0;
        const int end = farthest(take_in(distances, std::span(&start, 1), nearest));
        std::fill(nearest.begin(), nearest.end(), 0.0);
        nearest[at(end)] = 1.0;  // The first to be chosen.
    } else {
        take_in(distances, sources, nearest);
    }
    std::vector<int> chosen;
    while (chosen.size() < count) {
        context.check();
        chosen.push_back(farthest(nearest));
        if (chosen.size() == 1 && sources.empty()) {
            std::fill(nearest.begin(), nearest.end(), kFar);
        }
        take_in(distances, std::span(&chosen.back(), 1), nearest);
    }
    return chosen;
}

double limb_radius(const TriangleMesh& mesh, int vertex, double most) {
    const double reach = kReach * most;
    SurfaceDistance distances(mesh);
    const std::vector<SurfaceDistance::Reached> ball = distances.from(
        std::span(&vertex, 1),
        [&](const SurfaceDistance::Reached& reached) { return reached.distance < reach; });
    const std::vector<Band> bands = bands_of(mesh, distances, ball);
    for (int k = kRadiusSteps / 8; k <= kRadiusSteps; ++k) {
        const double radius = reach * k / kRadiusSteps;
        double area = 0.0;
        for (const Band& band : bands) {
            area += band.area_within(radius);
        }
        if (area < kRoundsLimb * std::numbers::pi * radius * radius) {
            return radius / kReach;
        }
    }
    return most;
}

}  // namespace leafcutter::geometry
