#include "geometry/check_foliation.h"

#include <cmath>
#include <cstddef>
#include <string>

#include <fmt/format.h>

#include "geometry/plane.h"
#include "geometry/surface_measures.h"

namespace leafcutter::geometry {
namespace {

constexpr double kAreaTolerance = 1e-6;

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

[[noreturn]] void fail(const Foliation& foliation, const std::string& what) {
    throw Error(ErrorKind::SelfCheck, "foliation-check",
                fmt::format("foliation ({}): {}", name_of(foliation.mode), what));
}

void check_graph(const Foliation& foliation) {
    for (const MetricGraph::Edge& edge : foliation.graph.edges) {
        if (edge.from < 0 || edge.to < 0 || edge.from >= foliation.graph.nodes ||
            edge.to >= foliation.graph.nodes || !(edge.weight > 0.0) ||
            !std::isfinite(edge.weight)) {
            fail(foliation, "an edge of the graph is broken");
        }
    }
}

// Returns the chart's area in (g, f).
double flat_area(const Foliation& foliation, const Cylinder& cylinder) {
    double area = 0.0;
    for (const auto& corners : cylinder.corner_gf) {
        const Eigen::Vector2d p = corners[1] - corners[0];
        const Eigen::Vector2d q = corners[2] - corners[0];
        const double twice = turn_of(p, q);
        if (!(twice > 0.0) || !std::isfinite(twice)) {
            fail(foliation,
                 fmt::format("a triangle of cylinder {} is flipped or flat", cylinder.graph_edge));
        }
        area += 0.5 * twice;
    }
    return area;
}

void check_chart(const Foliation& foliation, const Cylinder& cylinder, int sources) {
    const int edges = static_cast<int>(foliation.graph.edges.size());
    if (cylinder.graph_edge < 0 || cylinder.graph_edge >= edges) {
        fail(foliation, "a cylinder belongs to no edge of the graph");
    }
    if (!(cylinder.width > 0.0) || !(cylinder.height > 0.0) || !std::isfinite(cylinder.width) ||
        !std::isfinite(cylinder.height) || !std::isfinite(cylinder.shear)) {
        fail(foliation, fmt::format("cylinder {} has no size", cylinder.graph_edge));
    }
    if (cylinder.corner_gf.size() != cylinder.mesh.triangles.size() ||
        cylinder.source_vertex.size() != cylinder.mesh.positions.size()) {
        fail(foliation, fmt::format("cylinder {} is incomplete", cylinder.graph_edge));
    }
    const double rectangle = cylinder.width * cylinder.height;
    const double charted = flat_area(foliation, cylinder);
    if (std::abs(charted - rectangle) > kAreaTolerance * rectangle) {
        fail(foliation, fmt::format("cylinder {} covers {:.8g} times its chart",
                                    cylinder.graph_edge, charted / rectangle));
    }
    for (const int source : cylinder.source_vertex) {
        if (source < -1 || source >= sources) {
            fail(foliation,
                 fmt::format("cylinder {} has a vertex of no surface", cylinder.graph_edge));
        }
    }
}

void check_count(const Foliation& foliation, const SurfacePart& part) {
    std::size_t expected = 1;
    if (foliation.mode == FoliationMode::Pants) {
        expected = at(3 * part.genus() - 3 + 2 * static_cast<int>(part.loops.size()));
    } else if (foliation.mode == FoliationMode::OneForm) {
        return;  // As many as zeros and the loops they reach ask for; its own stage checks that.
    }
    if (foliation.cylinders.size() != expected) {
        fail(foliation,
             fmt::format("{} cylinders instead of {}", foliation.cylinders.size(), expected));
    }
}

// Euler, Poincaré and Hopf: the sum of 2 - prongs is 2 chi where the boundary consists of leaves.
void check_prongs(const Foliation& foliation, const SurfacePart& part) {
    int sum = 0;
    for (const Singularity& singularity : foliation.singularities) {
        if (!singularity.position.allFinite()) {
            fail(foliation, "a singular point is nowhere");
        }
        sum += 2 - singularity.prongs;
    }
    int expected = 2 * part.euler;
    if (foliation.mode == FoliationMode::Disk || foliation.mode == FoliationMode::SpherePolar) {
        expected = 0;  // The corners make up for it; polar: what is left is an annulus.
    }
    // Three-prong points closer together than the mesh resolves are one, which is said in a
    // warning.
    const bool merged =
        foliation.mode == FoliationMode::Pants && sum > expected && !foliation.warnings.empty();
    if (sum != expected && !merged) {
        fail(foliation,
             fmt::format("the prongs of its {} singular points add up to index {}, not {}",
                         foliation.singularities.size(), 0.5 * sum, 0.5 * expected));
    }
}

}  // namespace

void check_foliation(const Foliation& foliation, const SurfacePart& part) {
    check_graph(foliation);
    check_count(foliation, part);
    check_prongs(foliation, part);
    double area = 0.0;
    for (const Cylinder& cylinder : foliation.cylinders) {
        check_chart(foliation, cylinder, static_cast<int>(part.mesh.positions.size()));
        area += surface_area(cylinder.mesh);
    }
    const double whole = surface_area(part.mesh);
    // A polar foliation cuts out its poles itself.
    const double least = foliation.mode == FoliationMode::SpherePolar ? 0.5 : 1.0 - kAreaTolerance;
    if (!(area >= least * whole) || area > (1.0 + kAreaTolerance) * whole) {
        fail(foliation,
             fmt::format("its cylinders have {:.8g} times the area of the surface", area / whole));
    }
}

}  // namespace leafcutter::geometry
