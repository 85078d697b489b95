// A ZIP archive of a job's files, stored without compression.

#pragma once

#include <cstdint>
#include <vector>

#include "server/store/blobs.h"
#include "server/store/records.h"

namespace leafcutter::server {

// Writes the archive to `out` and returns its size. Throws BlobWriteFailed if the disk is full or
// the archive would pass 4 GB.
std::int64_t write_zip(const Blobs& blobs,
                       const std::vector<ArtifactRecord>& files,
                       const FileHandle& out);

}  // namespace leafcutter::server
