// Times of the geometry core, as ratios to one factorisation plus solve of the same surface's
// Laplacian in the same run: the column `x_factor` holds however fast the machine is.

#include <chrono>
#include <functional>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "geometry/closest_point.h"
#include "geometry/foliation.h"
#include "geometry/half_edges.h"
#include "geometry/intrinsic_delaunay.h"
#include "geometry/laplacian.h"
#include "geometry/quads/quad_mesh.h"
#include "geometry/quads/quality.h"
#include "geometry/repair.h"
#include "geometry/samples.h"
#include "geometry/topology.h"

namespace {

using namespace leafcutter::geometry;

PolygonSoup soup_of(const TriangleMesh& mesh) {
    PolygonSoup soup;
    soup.positions = mesh.positions;
    soup.face_offsets.push_back(0);
    for (const auto& triangle : mesh.triangles) {
        for (const int v : triangle) {
            soup.corners.push_back(static_cast<std::uint32_t>(v));
        }
        soup.face_offsets.push_back(static_cast<std::uint32_t>(soup.corners.size()));
    }
    return soup;
}

double seconds_of(const std::function<void()>& work) {
    const auto begun = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
}

// The yardstick: one Cholesky factorisation and one solve.
double yardstick_s(const TriangleMesh& mesh) {
    const IntrinsicTriangulation delaunay = intrinsic_delaunay(
        mesh, build_half_edges(mesh.triangles, static_cast<int>(mesh.positions.size())));
    const std::vector<WeightedEdge> edges = cotangent_edges(delaunay);
    std::vector<char> held(mesh.positions.size(), 0);
    held.front() = 1;
    return seconds_of([&] {
        const HarmonicSolver solver(edges, held);
        benchmark::DoNotOptimize(
            solver.solve(Eigen::VectorXd::Ones(static_cast<Eigen::Index>(mesh.positions.size()))));
    });
}

void foliate(benchmark::State& state, const char* sample) {
    const TriangleMesh surface = make_sample(sample, static_cast<int>(state.range(0)));
    const RepairedMesh repaired = repair(soup_of(surface));
    const double yardstick = yardstick_s(surface);
    double total = 0.0;
    for ([[maybe_unused]] auto unused : state) {
        total += seconds_of([&] { benchmark::DoNotOptimize(compute_foliation(repaired.mesh)); });
    }
    state.counters["x_factor"] = total / static_cast<double>(state.iterations()) / yardstick;
    state.counters["faces"] = static_cast<double>(surface.triangles.size());
}

void quads_and_quality(benchmark::State& state, const char* sample) {
    const TriangleMesh surface = make_sample(sample, static_cast<int>(state.range(0)));
    const RepairedMesh repaired = repair(soup_of(surface));
    const Foliation foliation = compute_foliation(repaired.mesh);
    const ClosestPoint closest(surface);
    GridOptions options;
    options.all = {60, 60};
    const double yardstick = yardstick_s(surface);
    double total = 0.0;
    for ([[maybe_unused]] auto unused : state) {
        total += seconds_of([&] {
            const QuadMesh quads = build_quad_mesh(foliation, options);
            benchmark::DoNotOptimize(measure_quality(quads, closest));
        });
    }
    state.counters["x_factor"] = total / static_cast<double>(state.iterations()) / yardstick;
}

BENCHMARK_CAPTURE(foliate, disk, "face")->Arg(10'000)->Arg(100'000)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(foliate, annulus, "vase")
    ->Arg(10'000)
    ->Arg(100'000)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(foliate, torus, "torus")
    ->Arg(10'000)
    ->Arg(100'000)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(quads_and_quality, disk, "face")->Arg(100'000)->Unit(benchmark::kMillisecond);

}  // namespace
