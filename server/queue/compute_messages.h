// What the daemon and its computing children say to each other, as JSON in frames.

#pragma once

#include <string>

#include "server/queue/compute_runner.h"

namespace leafcutter::server {

// Kinds of frames: to the child (a job, files of a package, a mesh), then from it.
constexpr char kJobFrame = 'J';
constexpr char kMeshFrame = 'M';
constexpr char kProgressFrame = 'P';
constexpr char kPathFrame = 'N';  // Of the file that follows; both ways.
constexpr char kFileFrame = 'F';
constexpr char kResultFrame = 'R';  // The last one, as is kErrorFrame.
constexpr char kErrorFrame = 'E';

std::string job_message(const ComputeInput& input, unsigned threads);

// Without mesh and files. Throws nlohmann's exceptions, as all that follow.
struct JobMessage {
    ComputeInput input;
    unsigned threads = 1;
};
JobMessage read_job_message(const std::string& text);

std::string progress_message(const ComputeProgress& progress);
ComputeProgress read_progress_message(const std::string& text);

// Without the package's files.
std::string result_message(const ComputeOutput& output);
ComputeOutput read_result_message(const std::string& text);

std::string failure_message(const JobFailure& failure);
JobFailure read_failure_message(const std::string& text);

}  // namespace leafcutter::server
