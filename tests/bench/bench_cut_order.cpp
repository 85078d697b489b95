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

// Beside the shortest order: how much cooler, for how much more travel.
void cool_bands(benchmark::State& state) {
    const std::vector<CutPath> paths = test::shuffled_bands(static_cast<int>(state.range(0)), 1);
    OrderRules rules;
    rules.cooling.decay_s = static_cast<double>(state.range(1));
    const HeatModel model(paths, rules.cooling);
    const std::vector<OrderedPath> shortest = find_order(paths, kHome, rules);
    rules.heat = static_cast<double>(state.range(2)) / 100.0;
    std::vector<OrderedPath> cool;
    for (auto _ : state) {
        cool = find_order(paths, kHome, rules);
    }
    const auto travel = [&](const std::vector<OrderedPath>& order) {
        std::vector<CutPath> run;
        for (const OrderedPath& place : order) {
            run.push_back(as_ordered(paths[place.path], place));
        }
        return travel_mm(run, kHome);
    };
    state.counters["peak"] = model.peak(shortest, kHome);
    state.counters["cool_peak"] = model.peak(cool, kHome);
    state.counters["travel_ratio"] = travel(cool) / travel(shortest);
}

BENCHMARK(cool_bands)
    ->Unit(benchmark::kMillisecond)
    ->ArgNames({"contours", "decay_s", "percent"})
    ->Args({200, 8, 50})
    ->Args({600, 8, 50})
    ->Args({600, 8, 55})
    ->Args({600, 30, 50});
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
