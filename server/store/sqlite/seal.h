// A seal on a database file that nobody works with: its digest, in a file beside it. SQLite looks
// at the form of what it reads, not at the bytes of a name or a number; whatever rots on the disk
// between two runs of the daemon breaks the seal.

#pragma once

#include <filesystem>

namespace leafcutter::server {

enum class Seal {
    None,    // Nobody sealed it: the daemon was killed, or somebody put another file there since.
    Whole,   // Bit by bit as it was left.
    Broken,  // Other bytes, and nobody wrote them.
};

// Of a closed file without a journal; does nothing for one that has a journal or has more than 256
// MB: a start must not wait for it. A seal that can't be written is none.
void put_seal(const std::filesystem::path& file) noexcept;

// Reads the whole file if it was sealed.
Seal seal_of(const std::filesystem::path& file);

// Before anything is written to the file. Throws std::system_error.
void take_seal_off(const std::filesystem::path& file);

}  // namespace leafcutter::server
