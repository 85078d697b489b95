// How meshes become jobs, whatever kind of call brings them.

#pragma once

#include <cstdint>

#include "server/http/multipart.h"
#include "server/http/request.h"
#include "server/http/response.h"
#include "server/queue/compute_runner.h"
#include "server/store/job_store.h"

namespace leafcutter::server {

class App;

// Throws HttpProblem (507).
void check_room(App& app, std::int64_t bytes);

// Streams the current part into the blob store. Throws BlobWriteFailed.
SourceFile store_mesh(App& app, MultipartReader& parts, const PartHead& head);

// Checks the parameters, puts the job into the queue, heeds the request's Idempotency-Key. Throws
// geometry::Error, KeyReused.
AddedJob take_job(App& app, const Request& request, NewJob job);

// The same for what is checked already; 201.
Response take_checked_job(App& app, const Request& request, NewJob job);

// A job that is computed already. Throws HttpProblem (507), BlobWriteFailed.
Response take_ready_job(App& app, NewJob job, const ComputeOutput& output);

}  // namespace leafcutter::server
