#include "server/queue/states.h"

#include <algorithm>
#include <array>
#include <utility>

namespace leafcutter::server {

namespace {

using Job = JobState;
using Cut = CutState;

constexpr std::array<std::pair<Job, std::string_view>, 6> kJobNames{
    {{Job::Queued, "queued"},
     {Job::Computing, "computing"},
     {Job::Ready, "ready"},
     {Job::Done, "done"},
     {Job::Failed, "failed"},
     {Job::Cancelled, "cancelled"}}};

constexpr std::array<std::pair<Cut, std::string_view>, 9> kCutNames{
    {{Cut::Waiting, "waiting"},
     {Cut::Armed, "armed"},
     {Cut::Cutting, "cutting"},
     {Cut::Paused, "paused"},
     {Cut::AwaitingSheet, "awaiting-sheet"},
     {Cut::Done, "done"},
     {Cut::Aborted, "aborted"},
     {Cut::Failed, "failed"},
     {Cut::Interrupted, "interrupted"}}};

// Computing -> queued: the daemon died while computing, or stops; geometry is at-least-once. Failed
// or cancelled -> queued: somebody wants it tried again.
constexpr std::array<std::pair<Job, Job>, 10> kJobMoves{{{Job::Queued, Job::Computing},
                                                         {Job::Queued, Job::Cancelled},
                                                         {Job::Computing, Job::Ready},
                                                         {Job::Computing, Job::Failed},
                                                         {Job::Computing, Job::Cancelled},
                                                         {Job::Computing, Job::Queued},
                                                         {Job::Ready, Job::Done},
                                                         {Job::Queued, Job::Failed},
                                                         {Job::Failed, Job::Queued},
                                                         {Job::Cancelled, Job::Queued}}};

// No state but armed leads to cutting except a pause, and nothing leads out of interrupted: the
// beam is at-most-once. Armed -> waiting / awaiting-sheet: arming never survives a restart.
constexpr std::array<std::pair<Cut, Cut>, 21> kCutMoves{
    {{Cut::Waiting, Cut::Armed},         {Cut::Waiting, Cut::Aborted},
     {Cut::Armed, Cut::Cutting},         {Cut::Armed, Cut::Waiting},
     {Cut::Armed, Cut::AwaitingSheet},   {Cut::Armed, Cut::Aborted},
     {Cut::Armed, Cut::Failed},          {Cut::Cutting, Cut::Paused},
     {Cut::Cutting, Cut::AwaitingSheet}, {Cut::Cutting, Cut::Done},
     {Cut::Cutting, Cut::Aborted},       {Cut::Cutting, Cut::Failed},
     {Cut::Cutting, Cut::Interrupted},   {Cut::Paused, Cut::Cutting},
     {Cut::Paused, Cut::AwaitingSheet},  {Cut::Paused, Cut::Done},
     {Cut::Paused, Cut::Aborted},        {Cut::Paused, Cut::Failed},
     {Cut::Paused, Cut::Interrupted},    {Cut::AwaitingSheet, Cut::Armed},
     {Cut::AwaitingSheet, Cut::Aborted}}};

template <typename State, std::size_t N>
std::string_view name_of(State state,
                         const std::array<std::pair<State, std::string_view>, N>& names) {
    for (const auto& [candidate, name] : names) {
        if (candidate == state) {
            return name;
        }
    }
    return "unknown";
}

template <typename State, std::size_t N>
std::optional<State> state_named(std::string_view wanted,
                                 const std::array<std::pair<State, std::string_view>, N>& names) {
    for (const auto& [state, name] : names) {
        if (name == wanted) {
            return state;
        }
    }
    return std::nullopt;
}

}  // namespace

std::string_view to_string(JobState state) {
    return name_of(state, kJobNames);
}

std::string_view to_string(CutState state) {
    return name_of(state, kCutNames);
}

std::optional<JobState> job_state_named(std::string_view name) {
    return state_named(name, kJobNames);
}

std::optional<CutState> cut_state_named(std::string_view name) {
    return state_named(name, kCutNames);
}

bool may_follow(JobState from, JobState to) {
    return std::find(kJobMoves.begin(), kJobMoves.end(), std::pair(from, to)) != kJobMoves.end();
}

bool may_follow(CutState from, CutState to) {
    return std::find(kCutMoves.begin(), kCutMoves.end(), std::pair(from, to)) != kCutMoves.end();
}

bool is_final(CutState state) {
    return state == Cut::Done || state == Cut::Aborted || state == Cut::Failed ||
           state == Cut::Interrupted;
}

bool occupies_device(CutState state) {
    return !is_final(state) && state != Cut::Waiting;
}

}  // namespace leafcutter::server
