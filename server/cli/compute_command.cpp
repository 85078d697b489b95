// leafcutter compute-job: one computation for the daemon, which starts it; not for people.

#include <cstdlib>
#include <memory>
#include <unistd.h>

#include <CLI/CLI.hpp>

#include "server/cli/command.h"
#include "server/queue/compute_child.h"
#include "server/recut_compute.h"
#include "server/weave_compute.h"

namespace leafcutter::server {

namespace {

ComputeOutput compute_job(const ComputeInput& input, const geometry::Context& context) {
    return input.recut_json.empty() ? weave_job(input, context) : recut_job_pieces(input, context);
}

}  // namespace

void add_compute_command(CLI::App& app, const CommonOptions&) {
    CLI::App* command = app.add_subcommand("compute-job", "One computation, for the daemon");
    command->group("");                                         // Not shown.
    const auto memory_mb = std::make_shared<std::uint64_t>(0);  // Shared with the callback.
    command->add_option("--memory-mb", *memory_mb, "Budget");
    command->callback([memory_mb] {
        // Whatever prints something prints it to the log.
        const int out = ::dup(STDOUT_FILENO);
        ::dup2(STDERR_FILENO, STDOUT_FILENO);
        ComputeBudget budget;
        budget.memory_bytes = *memory_mb << 20U;
        const int status = serve_parent(STDIN_FILENO, out, budget, compute_job);
        ::_exit(status);  // Nothing is worth the time of taking a million objects apart.
    });
}

}  // namespace leafcutter::server
