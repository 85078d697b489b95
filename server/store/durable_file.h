// Files that are to outlive a power cut.

#pragma once

#include <filesystem>

namespace leafcutter::server {

// Each throws std::system_error.
void sync_file(const std::filesystem::path& file);
void sync_folder(const std::filesystem::path& folder);

// Renames within a file system; on disk when this returns.
void rename_durably(const std::filesystem::path& from, const std::filesystem::path& to);

}  // namespace leafcutter::server
