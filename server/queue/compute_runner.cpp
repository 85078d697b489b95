#include "server/queue/compute_runner.h"

#include <algorithm>
#include <array>
#include <new>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <spdlog/spdlog.h>

#include "geometry/error.h"
#include "server/crash_point.h"
#include "server/stock_choice.h"
#include "server/store/store_error.h"

namespace leafcutter::server {

namespace {

using Clock = std::chrono::steady_clock;

std::string_view name_of(geometry::ErrorKind kind) {
    switch (kind) {
        case geometry::ErrorKind::BadFile:
            return "bad-file";
        case geometry::ErrorKind::BadMesh:
            return "bad-mesh";
        case geometry::ErrorKind::BadOption:
            return "bad-option";
        case geometry::ErrorKind::NotSupported:
            return "not-supported";
        case geometry::ErrorKind::SelfCheck:
            return "self-check";
    }
    return "internal";
}

std::string media_type_of(std::string_view path) {
    using Type = std::pair<std::string_view, std::string_view>;
    constexpr std::array kTypes = {
        Type{".json", "application/json"},
        Type{".svg", "image/svg+xml"},
        Type{".html", "text/html; charset=utf-8"},
        Type{".pdf", "application/pdf"},
        Type{".csv", "text/csv; charset=utf-8"},
        Type{".gcode", "text/x-gcode"},
        Type{".dxf", "image/vnd.dxf"},
        Type{".obj", "model/obj"},
        Type{".mtl", "model/mtl"},
        Type{".stl", "model/stl"},
        Type{".glb", "model/gltf-binary"},
    };
    const auto* const known = std::find_if(kTypes.begin(), kTypes.end(), [path](const Type& type) {
        return path.ends_with(type.first);
    });
    return std::string(known == kTypes.end() ? "application/octet-stream" : known->second);
}

double seconds_since_start() {
    return std::chrono::duration<double>(Clock::now().time_since_epoch()).count();
}

}  // namespace

ComputedJob stored_result(const Blobs& blobs, const ComputeOutput& output) {
    ComputedJob result;
    result.summary_json = output.summary_json;
    for (const fab::PackageFile& file : output.package.files) {
        const BlobId blob = blobs.put(file.bytes);
        result.artifacts.push_back({file.path, blob.bytes, blob.sha256, media_type_of(file.path)});
    }
    for (const SheetPlan& plan : output.sheets) {
        const auto program = std::find_if(
            result.artifacts.begin(), result.artifacts.end(), [&plan](const auto& file) {
                return !plan.program_path.empty() && file.path == plan.program_path;
            });
        const std::string sha256 = program == result.artifacts.end() ? "" : program->sha256;
        result.sheets.push_back({plan.number, plan.material, sha256, plan.estimated_s, false,
                                 plan.size_mm, plan.stock, plan.offcut_json});
    }
    return result;
}

JobFailure failure_of(const std::exception& error) {
    if (const auto* failed = dynamic_cast<const ComputeFailed*>(&error)) {
        return failed->failure();
    }
    if (dynamic_cast<const BlobWriteFailed*>(&error) != nullptr) {
        return {"internal", "disk",
                fmt::format("its package could not be stored: {}", error.what())};
    }
    if (const auto* refused = dynamic_cast<const geometry::Error*>(&error)) {
        return {std::string(name_of(refused->kind())), refused->code(), refused->what()};
    }
    if (dynamic_cast<const std::bad_alloc*>(&error) != nullptr) {
        return {"internal", "out-of-memory", "the computation needs more memory than there is"};
    }
    return {"internal", "internal", std::string("the computation broke down: ") + error.what()};
}

ComputeRunner::ComputeRunner(Store& store,
                             Compute compute,
                             const ComputeOptions& options,
                             std::function<void(const std::string&)> on_progress)
    : store_(store),
      compute_(std::move(compute)),
      options_(options),
      on_progress_(std::move(on_progress)) {
    for (unsigned i = 0; i < options.workers; ++i) {
        workers_.emplace_back([this](const std::stop_token& stop) { loop(stop, Lane::All); });
    }
    if (options.workers > 0) {
        workers_.emplace_back([this](const std::stop_token& stop) { loop(stop, Lane::Recuts); });
    }
}

ComputeRunner::~ComputeRunner() {
    for (std::jthread& worker : workers_) {
        worker.request_stop();
    }
    workers_.clear();
}

void ComputeRunner::wake() {
    {
        const std::scoped_lock lock(mutex_);
        ++wakes_;
    }
    arrived_.notify_all();
}

void ComputeRunner::stop_job(const std::string& id) {
    const std::scoped_lock lock(mutex_);
    const auto found = running_.find(id);
    if (found != running_.end()) {
        found->second.stop.request_stop();
    }
}

std::vector<JobLease> ComputeRunner::running() const {
    const std::scoped_lock lock(mutex_);
    std::vector<JobLease> jobs;
    for (const auto& [id, running] : running_) {
        jobs.push_back({id, running.fence});
    }
    return jobs;
}

std::optional<ComputeProgress> ComputeRunner::progress(const std::string& id) const {
    const std::scoped_lock lock(mutex_);
    const auto found = running_.find(id);
    return found == running_.end() ? std::nullopt : std::optional(found->second.progress);
}

void ComputeRunner::loop(const std::stop_token& stop, Lane lane) {
    unsigned long seen = 0;
    while (!stop.stop_requested()) {
        {
            std::unique_lock lock(mutex_);
            arrived_.wait(lock, stop, [&] { return wakes_ != seen; });
            seen = wakes_;
        }
        try {
            while (!stop.stop_requested() && compute_next(stop, lane)) {
            }
        } catch (const std::exception& error) {  // The store failed; the jobs are still there.
            spdlog::error("compute worker: {}", error.what());
            constexpr std::chrono::seconds kPause{1};
            std::unique_lock lock(mutex_);
            arrived_.wait_for(lock, stop, kPause, [] { return false; });
            --seen;
        }
    }
}

bool ComputeRunner::compute_next(const std::stop_token& stop, Lane lane) {
    const std::optional<JobRecord> job =
        lane == Lane::Recuts ? store_.jobs.claim_recut() : store_.jobs.claim();
    if (!job) {
        return false;
    }
    spdlog::info("job {}: computing {} ({} bytes)", job->id, job->file.name, job->file.bytes);
    {
        const std::scoped_lock lock(mutex_);
        running_[job->id].progress = {"read", 0.0};
        running_[job->id].fence = job->fence;
    }
    bool settled = true;
    try {
        compute(*job, stop);
    } catch (const StoreError& error) {
        spdlog::error("job {}: {}", job->id, error.what());
        settled = false;
    }
    {
        const std::scoped_lock lock(mutex_);
        running_.erase(job->id);
    }
    if (!settled) {
        give_back(*job, stop);
    }
    return true;
}

// The store took neither result nor failure: back to the queue as soon as it takes anything.
void ComputeRunner::give_back(const JobRecord& job, const std::stop_token& stop) {
    constexpr std::chrono::seconds kPause{1};
    while (!stop.stop_requested()) {
        try {
            store_.jobs.requeue({job.id, job.fence});
            return;
        } catch (const StoreError&) {
            std::unique_lock lock(mutex_);
            arrived_.wait_for(lock, stop, kPause, [] { return false; });
        }
    }
}

void ComputeRunner::compute(const JobRecord& job, const std::stop_token& stop) {
    std::stop_source source;
    {
        const std::scoped_lock lock(mutex_);
        source = running_.at(job.id).stop;
    }
    const std::stop_callback forward(stop, [&source] { source.request_stop(); });
    // Cancelled between the claim and now: nobody could stop what did not run yet.
    const std::optional<JobRecord> now = store_.jobs.find(job.id);
    if (!now || now->state != JobState::Computing) {
        return;
    }
    geometry::Context context;
    context.stop = source.get_token();
    context.threads = job.recut_json.empty() ? options_.threads_per_job : 1;
    context.clock_s = seconds_since_start;
    context.progress = [this, &job](std::string_view stage, double fraction) {
        note_progress(job.id, stage, fraction);
    };
    try {
        finish(job, output_of(job, context));
    } catch (const geometry::Cancelled&) {
        const bool requeued = stop.stop_requested() && store_.jobs.requeue({job.id, job.fence});
        spdlog::info("job {}: {}", job.id, requeued ? "back in the queue" : "cancelled");
    } catch (const ComputeCrashed& error) {
        spdlog::warn("job {}: {}", job.id, error.what());
        store_.jobs.crashed({job.id, job.fence}, error.what());
    } catch (const StoreError&) {
        throw;  // No fault of the job's: it is still there when the store is back.
    } catch (const std::exception& error) {
        spdlog::info("job {}: failed: {}", job.id, error.what());
        store_.jobs.fail({job.id, job.fence}, failure_of(error));
    } catch (...) {  // A thread's top: whatever it was, only this job fails.
        store_.jobs.fail({job.id, job.fence},
                         {"internal", "internal", "the computation broke down"});
    }
}

ComputeOutput ComputeRunner::output_of(const JobRecord& job,
                                       const geometry::Context& context) const {
    if (!job.recut_json.empty()) {
        return compute_(recut_input(job), context);
    }
    const std::unique_ptr<MappedBlob> mesh = store_.blobs.map(job.file.sha256);
    return compute_(
        {job.file.name, mesh->bytes(), params_of(job), job.name, texts_of(store_.materials.list())},
        context);
}

ComputeInput ComputeRunner::recut_input(const JobRecord& job) const {
    ComputeInput input;
    input.file_name = job.file.name;
    input.job_name = job.name;
    input.material_records = texts_of(store_.materials.list());
    input.recut_json = job.recut_json;
    for (const char* path : kRecutFiles) {
        const auto artifact = store_.jobs.artifact(job.recut_of, path);
        if (!artifact) {
            throw ComputeFailed({"bad-option", "no-package",
                                 "the job whose pieces are wanted has no package any more"});
        }
        input.package.push_back({path, store_.blobs.read(artifact->sha256)});
    }
    return input;
}

// With the sheets of the store that it names, as they are at hand now.
std::string ComputeRunner::params_of(const JobRecord& job) const {
    nlohmann::json params = nlohmann::json::parse(job.params_json);
    return names_stock(params) ? with_stock(std::move(params), store_.stock.list()).dump()
                               : job.params_json;
}

void ComputeRunner::finish(const JobRecord& job, const ComputeOutput& output) {
    crash_point("compute.before-result");
    const ComputedJob result = stored_result(store_.blobs, output);
    for (const ArtifactRecord& file : result.artifacts) {
        store_.blobs.share(file.sha256);  // This node may not be there when it is wanted.
    }
    const bool kept = store_.jobs.finish({job.id, job.fence}, result);
    spdlog::info("job {}: {}", job.id, kept ? "ready" : "cancelled at the last moment");
}

void ComputeRunner::note_progress(const std::string& id, std::string_view stage, double fraction) {
    constexpr auto kShortestGap = std::chrono::milliseconds(100);
    {
        const std::scoped_lock lock(mutex_);
        Running& running = running_.at(id);
        const Clock::time_point now = Clock::now();
        const bool same_stage = running.progress.stage == stage;
        running.progress = {std::string(stage), fraction};
        if (same_stage && now - running.told < kShortestGap) {
            return;
        }
        running.told = now;
    }
    on_progress_(id);
}

}  // namespace leafcutter::server
