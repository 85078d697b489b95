// The solver of the harmonic map against Algorithm 1 of the paper, with the same tree distances,
// from the same first map to the same energy. `on_…` is the solver alone, on one level; `levels_…`
// is all of it, with the hierarchy and the choice of weights left out. Times are processor seconds
// of one thread.
//
// Algorithm 1 runs until its energy is within 1e-8 of the solver's, or its time is over. Then
// `flow_s` is what it would still need at least: its excess over the minimum falls geometrically,
// at a rate measured over the last sweeps, which only gets worse (`measured` = 0).

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <numeric>
#include <span>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "geometry/io/read_mesh.h"
#include "geometry/pants/coarse_maps.h"
#include "geometry/pants/harmonic_map.h"
#include "geometry/pants/heat_flow.h"
#include "geometry/pants/hierarchy.h"
#include "geometry/repair.h"
#include "geometry/samples.h"
#include "tests/bench/child_process.h"
#include "tests/geometry/map_start.h"

namespace {

using namespace leafcutter;
using geometry::GraphMap;
using geometry::TriangleMesh;

constexpr double kWithin = 1e-8;
constexpr double kLongestFlow_s = 60.0;
constexpr int kSweepsAtOnce = 50;

double work_s(const std::function<void()>& work) {
    const double before = bench::processor_s();
    work();
    return bench::processor_s() - before;
}

struct Flowed {
    double seconds = 0.0;
    double sweeps = 0.0;
    bool measured = false;
    bool monotone = true;
};

// What is still needed, from the excess over the minimum half way and at the end.
void extrapolate(Flowed& flowed, std::span<const double> energies, double minimum) {
    const std::size_t half = energies.size() / 2;
    const double early = energies[half] / minimum - 1.0;
    const double late = energies.back() / minimum - 1.0;
    const double per_sweep =
        std::log(early / late) / static_cast<double>(energies.size() - 1 - half);
    const double more = std::log(late / kWithin) / per_sweep;
    flowed.seconds *= 1.0 + more / flowed.sweeps;
    flowed.sweeps += more;
}

Flowed flow_to(double minimum, const testing::MapStart& start) {
    GraphMap map = start.map;
    Flowed flowed;
    std::vector<double> energies;
    while (!flowed.measured && flowed.seconds < kLongestFlow_s) {
        geometry::HeatFlowReport report;
        flowed.seconds += work_s([&] {
            report = geometry::heat_flow(map, start.rings, start.weights,
                                         {.tolerance = 0.0, .most_sweeps = kSweepsAtOnce}, {});
        });
        const auto end = report.energies.end();
        const auto there = std::find_if(report.energies.begin(), end, [&](double energy) {
            return energy <= minimum * (1.0 + kWithin);
        });
        flowed.measured = there != end;
        flowed.sweeps += static_cast<double>(
            std::min<std::ptrdiff_t>(there - report.energies.begin(), report.sweeps()));
        energies.insert(energies.end(), report.energies.begin(), end);
        flowed.monotone =
            flowed.monotone && std::is_sorted(report.energies.rbegin(), report.energies.rend());
    }
    if (!flowed.measured) {
        extrapolate(flowed, energies, minimum);
    }
    return flowed;
}

TriangleMesh shared_model(const std::string& file) {
    const std::filesystem::path path =
        std::filesystem::path(LEAFCUTTER_SHARED_DIR) / "data" / "meshes" / file;
    std::ifstream in(path, std::ios::binary);
    if (!in) {
        return {};
    }
    const std::vector<char> bytes((std::istreambuf_iterator<char>(in)), {});
    return geometry::to_triangle_mesh(
        geometry::repair(geometry::read_mesh(std::as_bytes(std::span(bytes)), file)).mesh);
}

void report_on(benchmark::State& state,
               const geometry::HarmonicMapReport& report,
               const testing::MapStart& start,
               double seconds) {
    const Flowed flowed = flow_to(report.energy, start);
    state.counters["faces"] = static_cast<double>(start.mesh.triangles.size());
    state.counters["first_energy"] = geometry::map_energy(start.map, start.rings, start.weights);
    state.counters["energy"] = report.energy;
    state.counters["converged"] = report.converged ? 1 : 0;
    state.counters["newton"] = report.iterations;
    state.counters["flow_s"] = flowed.seconds;
    state.counters["flow_sweeps"] = flowed.sweeps;
    state.counters["flow_monotone"] = flowed.monotone ? 1 : 0;
    state.counters["measured"] = flowed.measured ? 1 : 0;
    state.counters["x_faster"] = flowed.seconds / seconds;
}

// A closed surface on levels, all weights 1. Algorithm 1 starts in the same homotopy class with
// every vertex in the middle of its edge of the graph.
void compare_levels(benchmark::State& state, const TriangleMesh& mesh) {
    if (mesh.triangles.empty()) {
        state.SkipWithError("no shared data");
        return;
    }
    testing::MapStart start = testing::start_map(mesh, 0);
    geometry::CoarseOptions options;
    options.function = geometry::SweepFunction::X;
    options.weights.emplace(start.map.graph.edges.size(), 1.0);
    geometry::HarmonicMapReport report;
    double seconds = 0.0;
    for ([[maybe_unused]] auto unused : state) {
        const double once = work_s([&] {
            const geometry::Hierarchy hierarchy = geometry::build_hierarchy(
                {mesh, std::vector<int>(mesh.positions.size(), -1)}, 0, 1500, {});
            const auto coarse = geometry::solve_coarsest(hierarchy, options, {});
            start.map = geometry::refine_map(hierarchy, coarse.front().map, {}).map;
            // The hierarchy solves on flipped edges; compared is the energy of the edges as given.
            report = geometry::solve_harmonic_map(start.map, start.rings, start.weights,
                                                  geometry::MapStart::Warm, {});
        });
        state.SetIterationTime(once);
        seconds += once / static_cast<double>(state.max_iterations);
    }
    for (std::size_t v = 0; v < start.map.t.size(); ++v) {
        start.map.t[v] = 0.5 * start.map.weight(start.map.graph_edge[v]);
    }
    report_on(state, report, start, seconds);
}

void compare(benchmark::State& state, const TriangleMesh& mesh) {
    if (mesh.triangles.empty()) {
        state.SkipWithError("no shared data");
        return;
    }
    const testing::MapStart start = testing::start_map(mesh, 0);
    geometry::HarmonicMapReport report;
    GraphMap map;
    double seconds = 0.0;
    for ([[maybe_unused]] auto unused : state) {
        map = start.map;
        const double once = work_s([&] {
            report = geometry::solve_harmonic_map(map, start.rings, start.weights,
                                                  geometry::MapStart::Cold, {});
        });
        state.SetIterationTime(once);
        seconds += once / static_cast<double>(state.max_iterations);
    }
    report_on(state, report, start, seconds);
}

void on_eight(benchmark::State& state) {
    compare(state, geometry::make_sample("eight", static_cast<int>(state.range(0))));
}

void on_model(benchmark::State& state, const char* file) {
    compare(state, shared_model(file));
}

void levels_eight(benchmark::State& state) {
    compare_levels(state, geometry::make_sample("eight", static_cast<int>(state.range(0))));
}

void levels_model(benchmark::State& state, const char* file) {
    compare_levels(state, shared_model(file));
}

BENCHMARK(levels_eight)
    ->Arg(8'000)
    ->Arg(50'000)
    ->Iterations(1)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(levels_model, eight_7k, "eight-7k.off")
    ->Iterations(1)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(levels_model, fertility, "fertility.off")
    ->Iterations(1)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK(on_eight)
    ->Arg(2'000)
    ->Arg(8'000)
    ->Arg(20'000)
    ->Arg(50'000)
    ->Iterations(3)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(on_model, eight_7k, "eight-7k.off")
    ->Iterations(3)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(on_model, fertility, "fertility.off")
    ->Iterations(3)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(on_model, stanford_bunny, "stanford-bunny.obj")
    ->Iterations(3)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
