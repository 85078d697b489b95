// Computes queued jobs on worker threads of its own, oldest first; pieces that are wanted again
// don't wait behind whole models. A job that throws fails alone.

#pragma once

#include <array>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <span>
#include <stdexcept>
#include <stop_token>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "fab/package/package.h"
#include "geometry/context.h"
#include "server/store/store.h"

namespace leafcutter::server {

struct ComputeInput {
    std::string file_name;
    std::span<const std::byte> bytes;
    std::string params_json;
    std::string job_name;
    std::vector<std::string> material_records;  // JSON, beside the built-in materials.

    // Pieces of a package again: which ones, and what has to be known of it. Empty: the whole.
    std::string recut_json = {};
    std::vector<fab::PackageFile> package = {};
};

// All that a recut ever reads of a package.
inline constexpr std::array kRecutFiles{"report.json", "strips.json", "layout.json"};

struct SheetPlan {
    int number = 1;
    std::string material;
    std::string program_path;  // Inside the package; empty if the sheet has no program.
    double estimated_s = 0.0;
    std::array<double, 2> size_mm{};  // 0: not known.
    std::string stock;                // The entry of the stock it is of; empty: a new one.
    std::string offcut_json;          // As an entry of nesting.stock; empty: it leaves nothing.
};

struct ComputeOutput {
    fab::Package package;
    std::string summary_json;
    std::vector<SheetPlan> sheets;
};

// What turns a mesh into a package; throws geometry::Error, geometry::Cancelled.
using Compute = std::function<ComputeOutput(const ComputeInput&, const geometry::Context&)>;

// What a computation elsewhere said of its failure.
class ComputeFailed : public std::runtime_error {
public:
    explicit ComputeFailed(JobFailure failure)
        : std::runtime_error(failure.detail), failure_(std::move(failure)) {}

    const JobFailure& failure() const { return failure_; }

private:
    JobFailure failure_;
};

// It ended without a word: it may do better another time, or never.
class ComputeCrashed : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

struct ComputeOptions {
    // Jobs at the same time, and one more that only cuts pieces again; 0: none is computed here.
    unsigned workers = 1;
    unsigned threads_per_job = 1;  // Budget of each.
};

struct ComputeProgress {
    std::string stage;
    double fraction = 0.0;
};

class ComputeRunner {
public:
    // `on_progress` is called with a job's id, at most ten times a second per job.
    ComputeRunner(Store& store,
                  Compute compute,
                  const ComputeOptions& options,
                  std::function<void(const std::string& job)> on_progress);

    // Stops: jobs in work go back to the queue.
    ~ComputeRunner();
    ComputeRunner(const ComputeRunner&) = delete;
    ComputeRunner& operator=(const ComputeRunner&) = delete;

    // There may be something in the queue.
    void wake();

    // Ends the work on a job that the store no longer calls computing.
    void stop_job(const std::string& id);

    // The jobs in work here, as they were claimed.
    std::vector<JobLease> running() const;
    std::size_t workers() const { return options_.workers; }

    // Nothing if it is not in work.
    std::optional<ComputeProgress> progress(const std::string& id) const;

private:
    struct Running {
        std::stop_source stop;
        ComputeProgress progress;
        std::chrono::steady_clock::time_point told;
        std::int64_t fence = 0;
    };

    enum class Lane { All, Recuts };

    void loop(const std::stop_token& stop, Lane lane);
    bool compute_next(const std::stop_token& stop, Lane lane);
    void compute(const JobRecord& job, const std::stop_token& stop);
    ComputeOutput output_of(const JobRecord& job, const geometry::Context& context) const;
    ComputeInput recut_input(const JobRecord& job) const;
    std::string params_of(const JobRecord& job) const;
    void give_back(const JobRecord& job, const std::stop_token& stop);
    void finish(const JobRecord& job, const ComputeOutput& output);
    void note_progress(const std::string& id, std::string_view stage, double fraction);

    Store& store_;
    const Compute compute_;
    const ComputeOptions options_;
    const std::function<void(const std::string&)> on_progress_;

    mutable std::mutex mutex_;  // Guards the members below.
    std::condition_variable_any arrived_;
    unsigned long wakes_ = 1;  // Counts wake(): the queue was worth a look.
    std::map<std::string, Running> running_;

    std::vector<std::jthread> workers_;  // Last: they use everything above.
};

// Puts the files of `output` into the blobs. Throws BlobWriteFailed.
ComputedJob stored_result(const Blobs& blobs, const ComputeOutput& output);

// What a failed computation says of itself: a stable kind, a code, and words.
JobFailure failure_of(const std::exception& error);

}  // namespace leafcutter::server
