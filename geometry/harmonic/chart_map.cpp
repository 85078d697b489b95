#include "geometry/harmonic/chart_map.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "geometry/error.h"
#include "geometry/plane.h"

namespace leafcutter::geometry {
namespace {

// A triangle counts as flat below this ratio of doubled area to squared longest side. Far above
// rounding, far below any triangle that sampling could have trouble with.
constexpr double kFlat = 1e-12;
// The triangles' areas add up to the chart's within rounding, or the map covers it more than once.
constexpr double kAreaTolerance = 1e-6;

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

double doubled_area(const std::array<Eigen::Vector2d, 3>& corners) {
    return turn_of(corners[1] - corners[0], corners[2] - corners[0]);
}

bool is_bad(const std::array<Eigen::Vector2d, 3>& corners) {
    const double longest =
        std::max({(corners[1] - corners[0]).squaredNorm(), (corners[2] - corners[1]).squaredNorm(),
                  (corners[0] - corners[2]).squaredNorm()});
    return !(doubled_area(corners) > kFlat * longest);
}

}  // namespace

ChartMap start_chart(const ChartSurface& surface) {
    ChartMap map;
    map.mesh = surface.mesh;
    map.edges = surface.edges;
    map.source_vertex = surface.source_vertex;
    map.gf.assign(surface.mesh.positions.size(), Eigen::Vector2d::Zero());
    return map;
}

ChartMap reopen_chart(const Cylinder& cylinder) {
    ChartMap map;
    map.mesh = cylinder.mesh;
    map.edges = build_half_edges(map.mesh.triangles, static_cast<int>(map.mesh.positions.size()));
    map.source_vertex = cylinder.source_vertex;
    map.shape = cylinder.shape;
    map.width = cylinder.width;
    map.height = cylinder.height;
    map.shear = cylinder.shear;
    map.gf.assign(map.mesh.positions.size(), Eigen::Vector2d::Zero());
    for (std::size_t t = 0; t < map.mesh.triangles.size(); ++t) {
        for (std::size_t k = 0; k < 3; ++k) {
            map.gf[at(map.mesh.triangles[t][k])] = cylinder.corner_gf[t][k];
        }
    }
    if (map.shape == ChartShape::Rectangle) {
        return map;
    }
    // Whole periods, so that both half-edges of an edge say the same.
    for (std::size_t t = 0; t < map.mesh.triangles.size(); ++t) {
        for (std::size_t k = 0; k < 3; ++k) {
            const auto& corners = cylinder.corner_gf[t];
            const auto& triangle = map.mesh.triangles[t];
            const Eigen::Vector2d rest =
                corners[(k + 1) % 3] - corners[k] -
                (map.gf[at(triangle[(k + 1) % 3])] - map.gf[at(triangle[k])]);
            const double turns =
                map.shape == ChartShape::Torus ? std::round(rest.y() / map.height) : 0.0;
            const double rounds = std::round((rest.x() - turns * map.shear) / map.width);
            map.jump.emplace_back(rounds * map.width + turns * map.shear, turns * map.height);
        }
    }
    return map;
}

std::array<Eigen::Vector2d, 3> lifted_corners(const ChartMap& map, int triangle) {
    const int h = 3 * triangle;
    const Eigen::Vector2d first = map.gf[at(map.edges.from_of(h))];
    return {first, first + map.difference(h), first - map.difference(h + 2)};
}

std::vector<int> bad_triangles(const ChartMap& map) {
    std::vector<int> bad;
    const int count = static_cast<int>(map.mesh.triangles.size());
    for (int t = 0; t < count; ++t) {
        if (is_bad(lifted_corners(map, t))) {
            bad.push_back(t);
        }
    }
    return bad;
}

double chart_area(const ChartMap& map) {
    double doubled = 0.0;
    const int count = static_cast<int>(map.mesh.triangles.size());
    for (int t = 0; t < count; ++t) {
        doubled += doubled_area(lifted_corners(map, t));
    }
    return 0.5 * doubled;
}

void lift_into_domain(ChartMap& map) {
    if (map.shape == ChartShape::Rectangle) {
        return;
    }
    std::vector<Eigen::Vector2d> moved(map.gf.size());
    for (std::size_t v = 0; v < map.gf.size(); ++v) {
        const Eigen::Vector2d& gf = map.gf[v];
        const double rows = map.shape == ChartShape::Torus ? std::floor(gf.y() / map.height) : 0.0;
        const double columns = std::floor((gf.x() - rows * map.shear) / map.width);
        moved[v] = {-rows * map.shear - columns * map.width, -rows * map.height};
    }
    for (int h = 0; h < map.edges.size(); ++h) {
        map.jump[at(h)] += moved[at(map.edges.from_of(h))] - moved[at(map.edges.to_of(h))];
    }
    for (std::size_t v = 0; v < map.gf.size(); ++v) {
        map.gf[v] += moved[v];
    }
}

Cylinder finish_cylinder(ChartMap map) {
    const std::vector<int> bad = bad_triangles(map);
    const double covered = chart_area(map);
    const double whole = map.width * map.height;
    if (!bad.empty() || !(std::abs(covered - whole) <= kAreaTolerance * whole)) {
        throw Error(
            ErrorKind::SelfCheck, "chart-not-bijective",
            "the parameterisation could not be made one-to-one: " + std::to_string(bad.size()) +
                " triangles are flipped or flat" +
                (bad.empty() ? "" : ", the first is number " + std::to_string(bad.front())) +
                "; remesh the model there, or cut holes into the tips of its long limbs");
    }
    Cylinder cylinder;
    cylinder.shape = map.shape;
    cylinder.width = map.width;
    cylinder.height = map.height;
    cylinder.shear = map.shear;
    cylinder.corner_gf.reserve(map.mesh.triangles.size());
    for (int t = 0; t < static_cast<int>(map.mesh.triangles.size()); ++t) {
        cylinder.corner_gf.push_back(lifted_corners(map, t));
    }
    cylinder.mesh = std::move(map.mesh);
    cylinder.source_vertex = std::move(map.source_vertex);
    return cylinder;
}

}  // namespace leafcutter::geometry
