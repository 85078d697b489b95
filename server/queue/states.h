// The states of jobs and cuts, and which may follow which. The table is the rule: the store refuses
// every move that is not in it.

#pragma once

#include <optional>
#include <string_view>

namespace leafcutter::server {

enum class JobState { Queued, Computing, Ready, Done, Failed, Cancelled };

enum class CutState {
    Waiting,        // In the device's queue; nothing may fire.
    Armed,          // An operator named the program; the runner takes it up next.
    Cutting,        // The beam may be on. Only from here.
    Paused,         // The machine holds, beam off.
    AwaitingSheet,  // One sheet is done, the next one has to be loaded.
    Done,
    Aborted,
    Failed,
    Interrupted,  // The machine or the daemon went away mid-cut. Never left again.
};

std::string_view to_string(JobState state);
std::string_view to_string(CutState state);
std::optional<JobState> job_state_named(std::string_view name);
std::optional<CutState> cut_state_named(std::string_view name);

bool may_follow(JobState from, JobState to);
bool may_follow(CutState from, CutState to);

// Nothing follows any more.
bool is_final(CutState state);

// The cut occupies its device: armed, cutting, paused or between two sheets.
bool occupies_device(CutState state);

}  // namespace leafcutter::server
