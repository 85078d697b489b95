// The child's side of a computation.

#include "server/queue/compute_child.h"

#include <csignal>
#include <cstdio>
#include <new>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <fmt/format.h>

#include "server/crash_point.h"
#include "server/queue/compute_messages.h"
#include "server/queue/frames.h"

namespace leafcutter::server {

namespace {

using Clock = std::chrono::steady_clock;

// For the handler of failed allocations, which may not allocate.
int parent_fd = -1;
std::string no_memory;

[[noreturn]] void say_no_memory() {
    write_all(parent_fd, no_memory);
    ::_exit(1);
}

void prepare_last_words(int out, const ComputeBudget& budget) {
    const JobFailure failure{
        "budget", "memory-budget",
        fmt::format("the computation needs more than the {} MB it is given: make the mesh "
                    "coarser, or raise job_memory_mb",
                    budget.memory_bytes >> 20U)};
    const std::string text = failure_message(failure);
    no_memory = frame_head(kErrorFrame, text.size()) + text;
    parent_fd = out;
    std::set_new_handler(say_no_memory);
}

void set_limit(int what, rlim_t most) {
    const rlimit limit{most, most};
    ::setrlimit(static_cast<__rlimit_resource>(what), &limit);
}

// It dies with the daemon, goes behind the threads that feed lasers, and is the first that a
// machine without memory lets go.
void humble(const ComputeBudget& budget) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    constexpr int kBehind = 10;
    ::setpriority(PRIO_PROCESS, 0, kBehind);
    set_limit(RLIMIT_CORE, 0);
#ifndef __SANITIZE_ADDRESS__  // Which reserves terabytes.
    if (budget.memory_bytes > 0) {
        set_limit(RLIMIT_AS, budget.memory_bytes);
    }
#endif
    if (std::FILE* score = std::fopen("/proc/self/oom_score_adj", "w")) {
        std::fputs("900", score);
        std::fclose(score);
    }
}

bool send(int out, char kind, std::string_view bytes) {
    return write_all(out, frame_head(kind, bytes.size())) && write_all(out, bytes);
}

geometry::Context context_for(int out, unsigned threads) {
    geometry::Context context;
    context.threads = threads;
    context.clock_s = [] {
        return std::chrono::duration<double>(Clock::now().time_since_epoch()).count();
    };
    context.progress = [out, last = ComputeProgress{}, told = Clock::time_point{}](
                           std::string_view stage, double fraction) mutable {
        constexpr auto kShortestGap = std::chrono::milliseconds(50);
        const Clock::time_point now = Clock::now();
        if (stage == last.stage && now - told < kShortestGap) {
            return;
        }
        last = {std::string(stage), fraction};
        told = now;
        send(out, kProgressFrame, progress_message(last));
    };
    return context;
}

bool send_output(int out, const ComputeOutput& output) {
    for (const fab::PackageFile& file : output.package.files) {
        if (!send(out, kPathFrame, file.path) || !send(out, kFileFrame, file.bytes)) {
            return false;
        }
    }
    return send(out, kResultFrame, result_message(output));
}

// Up to the mesh, the last frame; none if the parent talks nonsense.
std::optional<std::string> read_mesh(int in, FrameReader& reader, ComputeInput& input) {
    std::string path;
    while (auto frame = read_frame(in, reader)) {
        if (frame->kind == kMeshFrame) {
            return std::move(frame->bytes);
        }
        if (frame->kind == kPathFrame) {
            path = std::move(frame->bytes);
        } else if (frame->kind == kFileFrame) {
            input.package.push_back({std::move(path), std::move(frame->bytes)});
        } else {
            break;
        }
    }
    return std::nullopt;
}

}  // namespace

int serve_parent(int in, int out, const ComputeBudget& budget, const Compute& compute) {
    humble(budget);
    prepare_last_words(out, budget);
    FrameReader reader;
    const auto job = read_frame(in, reader);
    if (!job || job->kind != kJobFrame) {
        return 2;
    }
    try {
        JobMessage message = read_job_message(job->bytes);
        const auto mesh = read_mesh(in, reader, message.input);
        if (!mesh) {
            return 2;
        }
        crash_point("compute.child");
        message.input.bytes = std::as_bytes(std::span(*mesh));
        return send_output(out, compute(message.input, context_for(out, message.threads))) ? 0 : 1;
    } catch (const std::bad_alloc&) {
        say_no_memory();
    } catch (const std::exception& error) {
        send(out, kErrorFrame, failure_message(failure_of(error)));
        return 1;
    }
}

}  // namespace leafcutter::server
