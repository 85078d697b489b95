// What is done about a database file before anybody works with it: a damaged one is put aside for
// the newest good backup, or served as it is, for reading alone.

#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace leafcutter::server {

struct Rescue {
    std::string trouble;  // Not empty: it may only be read, and why.
    std::string notice;   // What was done, for people; empty: all was well.
    bool restored = false;
};

// Looks at the file, if there is one. A large one that nobody suspects is looked at later, beside
// the work: see Engine::check(). Throws DatabaseUnusable for one that can't be opened at all:
// locked, no right to it, of a newer Leafcutter.
Rescue make_usable(const std::filesystem::path& file, const std::filesystem::path& backups);

// The next start looks at all of it.
void mark_suspect(const std::filesystem::path& file) noexcept;

// The backups of a folder, newest first.
std::vector<std::filesystem::path> backups_in(const std::filesystem::path& folder);

// With its seal. Throws std::system_error.
void remove_backup(const std::filesystem::path& file);

}  // namespace leafcutter::server
