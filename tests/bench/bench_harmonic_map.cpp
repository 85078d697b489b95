// The solver of the harmonic map against Algorithm 1 of the paper, with the same tree distances,
// from the same first map to the same energy.
//
// Algorithm 1 runs until its energy is within 1e-8 of the solver's, or its time is over. Then
// `flow_s` is what it would still need at least: its excess over the minimum falls geometrically,
// at a rate measured over the last sweeps, which only gets worse (`measured` = 0).

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <numeric>
#include <span>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "geometry/io/read_mesh.h"
#include "geometry/pants/harmonic_map.h"
#include "geometry/pants/heat_flow.h"
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
        flowed.seconds += bench::seconds_of([&] {
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

void compare(benchmark::State& state, const TriangleMesh& mesh) {
    if (mesh.triangles.empty()) {
        state.SkipWithError("no shared data");
        return;
    }
    const testing::MapStart start = testing::start_map(mesh, 0);
    const double first = geometry::map_energy(start.map, start.rings, start.weights);
    geometry::HarmonicMapReport report;
    GraphMap map;
    double seconds = 0.0;
    for ([[maybe_unused]] auto unused : state) {
        map = start.map;
        const double once = bench::seconds_of([&] {
            report = geometry::solve_harmonic_map(map, start.rings, start.weights,
                                                  geometry::MapStart::Cold, {});
        });
        state.SetIterationTime(once);
        seconds += once / static_cast<double>(state.max_iterations);
    }
    const Flowed flowed = flow_to(report.energy, start);
    state.counters["faces"] = static_cast<double>(mesh.triangles.size());
    state.counters["first_energy"] = first;
    state.counters["energy"] = report.energy;
    state.counters["converged"] = report.converged ? 1 : 0;
    state.counters["newton"] = report.iterations;
    state.counters["flow_s"] = flowed.seconds;
    state.counters["flow_sweeps"] = flowed.sweeps;
    state.counters["flow_monotone"] = flowed.monotone ? 1 : 0;
    state.counters["measured"] = flowed.measured ? 1 : 0;
    state.counters["x_faster"] = flowed.seconds / seconds;
}

void on_eight(benchmark::State& state) {
    compare(state, geometry::make_sample("eight", static_cast<int>(state.range(0))));
}

void on_model(benchmark::State& state, const char* file) {
    compare(state, shared_model(file));
}

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
