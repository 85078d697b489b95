// Densities on nesting instances: bench_nest SECONDS SEEDS INSTANCE… prints a table row for each.
// Time is the processor's, shared by two threads: a busy machine doesn't spoil the figures.

#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <iterator>
#include <limits>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "fab/nest/instance.h"
#include "fab/nest/instance_io.h"

namespace {

using namespace leafcutter;

constexpr unsigned kThreads = 2;

double processor_seconds() {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec)) / kThreads;
}

std::string read_file(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

void run(const std::string& path, double seconds, int seeds) {
    const fab::NestInstance instance = fab::read_instance(read_file(path));
    geometry::Context context;
    context.threads = kThreads;
    context.clock_s = processor_seconds;
    double sum = 0.0;
    double least = 1.0;
    double most = 0.0;
    std::int64_t evaluations = 0;
    std::string course;
    const double begun = processor_seconds();
    for (int seed = 1; seed <= seeds; ++seed) {
        const double start = processor_seconds();
        double next = 0.0;
        const auto improved = [&](const fab::InstanceSolution& solution) {
            const double at = processor_seconds() - start;
            if (seed == 1 && at >= next) {
                course += fmt::format(" {:.1f}s:{:.1f}", at, 100.0 * solution.density);
                next = std::max(0.5, 1.6 * at);
            }
        };
        fab::CompactionOptions options;
        options.seed = static_cast<std::uint64_t>(seed);
        options.time_s = seconds;
        options.max_evaluations = std::numeric_limits<std::int64_t>::max() / 4;
        const fab::InstanceSolution solution = fab::solve(instance, options, context, improved);
        sum += solution.density;
        least = std::min(least, solution.density);
        most = std::max(most, solution.density);
        evaluations += solution.evaluations;
    }
    const double spent = processor_seconds() - begun;
    fmt::print("| {} | {:.2f} | {:.2f} | {:.2f} | {:.0f} k |{}\n", instance.name,
               100.0 * sum / seeds, 100.0 * least, 100.0 * most,
               static_cast<double>(evaluations) / 1e3 / spent, course);
    std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 4) {
        fmt::print(stderr, "bench_nest SECONDS SEEDS INSTANCE...\n");
        return 2;
    }
    fmt::print("| instance | mean % | least | most | evaluations/s |\n|---|---|---|---|---|\n");
    for (int i = 3; i < argc; ++i) {
        run(argv[i], std::atof(argv[1]), std::atoi(argv[2]));
    }
    return 0;
}
