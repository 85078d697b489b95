// The cut planner beside the nearest neighbour with fixed starts: time, and the ratio of their ways
// with the beam off.

#include <vector>

#include <benchmark/benchmark.h>

#include "fab/cut/cut_order.h"
#include "tests/support/cut_sheets.h"

namespace {

using namespace leafcutter::fab;

const Eigen::Vector2d kHome = Eigen::Vector2d::Zero();

void order_bands(benchmark::State& state) {
    const std::vector<CutPath> paths = test::shuffled_bands(
        static_cast<int>(state.range(0)), static_cast<std::uint32_t>(state.range(1)));
    const double yardstick = test::nearest_neighbour_with_fixed_starts(paths);
    double travel = 0.0;
    for (auto _ : state) {
        travel = travel_mm(order_paths(paths, kHome), kHome);
        benchmark::DoNotOptimize(travel);
    }
    state.counters["travel_mm"] = travel;
    state.counters["ratio"] = travel / yardstick;
}

void nearest_neighbour(benchmark::State& state) {
    const std::vector<CutPath> paths = test::shuffled_bands(
        static_cast<int>(state.range(0)), static_cast<std::uint32_t>(state.range(1)));
    double travel = 0.0;
    for (auto _ : state) {
        travel = test::nearest_neighbour_with_fixed_starts(paths);
        benchmark::DoNotOptimize(travel);
    }
    state.counters["travel_mm"] = travel;
}

BENCHMARK(nearest_neighbour)->Unit(benchmark::kMillisecond)->Args({600, 1})->Args({5000, 1});
BENCHMARK(order_bands)
    ->Unit(benchmark::kMillisecond)
    ->ArgNames({"contours", "seed"})
    ->Args({60, 1})
    ->Args({200, 1})
    ->Args({600, 1})
    ->Args({600, 2})
    ->Args({600, 3})
    ->Args({5000, 1});

}  // namespace
