// Seconds and peak memory of whole foliations from 10k to 1M faces, as ratios to one sparse
// factorisation plus solve of the same surface's Laplacian in the same run.
//
// No holes are opened: choosing them takes further foliations, of coarse versions and of the whole.
//
// Each measurement runs in a process of its own. `x_factor` compares seconds of the clock, `x_work`
// processor seconds, which other work on the machine disturbs less.

#include <cstddef>
#include <functional>
#include <thread>
#include <vector>

#include <benchmark/benchmark.h>

#include "geometry/foliation.h"
#include "geometry/half_edges.h"
#include "geometry/intrinsic_delaunay.h"
#include "geometry/laplacian.h"
#include "geometry/samples.h"
#include "tests/bench/child_process.h"
#include "tests/geometry/surfaces.h"
#include "tests/support/jug.h"
#include "tests/support/loop_subdivision.h"

namespace {

using namespace leafcutter;
using geometry::TriangleMesh;

using Maker = TriangleMesh (*)(int faces);

TriangleMesh make_eight(int faces) {
    return geometry::make_sample("eight", faces);
}

// About `faces` triangles, subdivided from a few thousand.
TriangleMesh subdivided(Maker make, int faces) {
    constexpr int kCoarse = 6000;
    int rounds = 0;
    while (faces >> (2 * rounds) > kCoarse) {
        ++rounds;
    }
    TriangleMesh mesh = make(faces >> (2 * rounds));
    for (; rounds > 0; --rounds) {
        mesh = testing::subdivide_loop(mesh);
    }
    return mesh;
}

struct Spent {
    double clock_s = 0.0;
    double work_s = 0.0;
};

Spent spent_on(const std::function<void()>& work) {
    const double before = bench::processor_s();
    Spent spent;
    spent.clock_s = bench::seconds_of(work);
    spent.work_s = bench::processor_s() - before;
    return spent;
}

// One factorisation and one solve of the intrinsic Delaunay Laplacian.
std::vector<double> yardstick(Maker make, int faces) {
    const TriangleMesh mesh = subdivided(make, faces);
    const int count = static_cast<int>(mesh.positions.size());
    const geometry::IntrinsicTriangulation delaunay =
        geometry::intrinsic_delaunay(mesh, geometry::build_half_edges(mesh.triangles, count));
    const std::vector<geometry::WeightedEdge> edges = geometry::cotangent_edges(delaunay);
    std::vector<char> held(static_cast<std::size_t>(count), 0);
    held.front() = 1;
    const Spent spent = spent_on([&] {
        const geometry::HarmonicSolver solver(edges, held);
        benchmark::DoNotOptimize(solver.solve(Eigen::VectorXd::Ones(count)));
    });
    return {spent.clock_s, spent.work_s};
}

std::vector<double> foliation(Maker make, int faces) {
    geometry::Mesh mesh;
    double triangles = 0.0;
    {
        const TriangleMesh plain = subdivided(make, faces);
        triangles = static_cast<double>(plain.triangles.size());
        mesh = testing::to_mesh(plain);
    }
    geometry::Context context;
    context.threads = std::max(1U, std::thread::hardware_concurrency());
    geometry::FoliationOptions options;
    options.puncture = geometry::PunctureChoice::None;
    geometry::Foliation result;
    const Spent spent =
        spent_on([&] { result = geometry::compute_foliation(mesh, options, context); });
    return {spent.clock_s,
            spent.work_s,
            triangles,
            result.energy,
            static_cast<double>(result.iterations),
            static_cast<double>(result.cylinders.size()),
            static_cast<double>(result.singularities.size())};
}

void whole(benchmark::State& state, Maker make) {
    const int faces = static_cast<int>(state.range(0));
    for ([[maybe_unused]] auto unused : state) {
        const bench::ChildRun base = bench::run_in_child([&] { return yardstick(make, faces); });
        const bench::ChildRun run = bench::run_in_child([&] { return foliation(make, faces); });
        if (!base.failure.empty() || !run.failure.empty()) {
            state.SkipWithError((base.failure + run.failure).c_str());
            return;
        }
        state.SetIterationTime(run.figures[0]);
        state.counters["x_factor"] = run.figures[0] / base.figures[0];
        state.counters["x_work"] = run.figures[1] / base.figures[1];
        state.counters["peak_MiB"] = run.peak_mib;
        state.counters["factor_s"] = base.figures[0];
        state.counters["factor_MiB"] = base.peak_mib;
        state.counters["faces"] = run.figures[2];
        state.counters["energy"] = run.figures[3];
        state.counters["newton"] = run.figures[4];
        state.counters["cylinders"] = run.figures[5];
        state.counters["singular"] = run.figures[6];
    }
}

void sizes(benchmark::internal::Benchmark* benchmark) {
    for (const int faces : {10'000, 100'000, 1'000'000}) {
        benchmark->Arg(faces);
    }
    benchmark->Iterations(1)->UseManualTime()->Unit(benchmark::kMillisecond);
}

BENCHMARK_CAPTURE(whole, eight, make_eight)->Apply(sizes);
BENCHMARK_CAPTURE(whole, jug, testing::make_jug)->Apply(sizes);

}  // namespace
