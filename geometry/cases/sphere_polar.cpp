#include <algorithm>
#include <cstddef>
#include <vector>

#include <fmt/format.h>

#include "geometry/cases/annulus.h"
#include "geometry/cases/sphere.h"
#include "geometry/cell_spread.h"
#include "geometry/coarse_version.h"
#include "geometry/error.h"
#include "geometry/punctures.h"
#include "geometry/surface_distance.h"
#include "geometry/surface_measures.h"

namespace leafcutter::geometry {
namespace {

using Poles = std::array<int, 2>;

// Of the holes at the poles, by the diagonal of the bounding box.
constexpr double kHoleRadius = 0.02;
constexpr std::size_t kCoarseVertices = 5000;
// The farthest of the farthest: two or three steps reach the ends of a shape.
constexpr int kFarSteps = 6;

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

Poles farthest_pair(const TriangleMesh& mesh, const Context& context) {
    const CoarseVersion coarse = coarse_version(mesh, kCoarseVertices, context);
    SurfaceDistance distances(coarse.mesh);
    Poles ends{0, 0};
    double apart = -1.0;
    for (int step = 0, from = 0; step < kFarSteps; ++step) {
        context.check();
        const SurfaceDistance::Reached farthest = distances.from(std::array{from}).back();
        if (farthest.distance <= apart) {
            break;
        }
        apart = farthest.distance;
        ends = {from, farthest.vertex};
        from = farthest.vertex;
    }
    return {coarse.source_vertex[at(ends[0])], coarse.source_vertex[at(ends[1])]};
}

int farthest_from(int pole, const TriangleMesh& mesh, const Context& context) {
    context.check();
    return SurfaceDistance(mesh).from(std::array{pole}).back().vertex;
}

// Poles are where singular points are wanted; a second one is opposite the first.
Poles near_places(const TriangleMesh& mesh, const std::vector<int>& near, const Context& context) {
    if (near.size() > 2) {
        throw Error(ErrorKind::BadOption, "too-many-near",
                    fmt::format("foliation.singularities: {} wanted, but this foliation has two "
                                "poles",
                                near.size()));
    }
    return {near.front(), near.size() == 2 ? near[1] : farthest_from(near[0], mesh, context)};
}

Poles poles_of(const TriangleMesh& mesh, const FoliationOptions& options, const Context& context) {
    if (options.poles && !options.near.empty()) {
        throw Error(ErrorKind::BadOption, "bad-poles",
                    "foliation.singularities: foliation.poles says where they are; give one or "
                    "the other");
    }
    if (!options.poles && options.near.empty()) {
        return farthest_pair(mesh, context);
    }
    const Poles poles = options.poles ? *options.poles : near_places(mesh, options.near, context);
    const int count = static_cast<int>(mesh.positions.size());
    if (std::min(poles[0], poles[1]) < 0 || std::max(poles[0], poles[1]) >= count ||
        poles[0] == poles[1]) {
        throw Error(ErrorKind::BadOption, "bad-poles",
                    fmt::format("foliation.{}: must be two different vertices of the model",
                                options.poles ? "poles" : "singularities"));
    }
    return poles;
}

}  // namespace

Foliation foliate_sphere_polar(const TriangleMesh& mesh,
                               const FoliationOptions& options,
                               const Context& context) {
    const Poles poles = poles_of(mesh, options, context);
    const double radius = kHoleRadius * diagonal(mesh);
    const OpenedMesh opened =
        open_punctures(mesh, std::array{Puncture{poles[0], radius}, Puncture{poles[1], radius}},
                       context, PunctureFit::Shrink);
    if (opened.loops.size() != 2) {
        throw Error(ErrorKind::BadOption, "bad-poles",
                    "foliation.poles: there is no room for a hole at each of them; choose points "
                    "farther apart, or refine the model");
    }
    Foliation foliation =
        foliate_ring(opened.mesh, {opened.loops[0], opened.loops[1]}, options, context);
    for (int& source : foliation.cylinders[0].source_vertex) {
        source = source < 0 ? -1 : opened.source_vertex[at(source)];
    }
    foliation.mode = FoliationMode::SpherePolar;
    foliation.punctures = opened.punctures;
    foliation.spread = cell_spread(foliation.cylinders);
    return foliation;
}

}  // namespace leafcutter::geometry
