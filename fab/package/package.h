// The files of a finished job, as documented in docs (contract section 2): held in memory, written
// by whoever asked for them.

#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace leafcutter::fab {

struct PackageFile {
    std::string path;  // Relative, forward slashes: "sheets/sheet-001.svg".
    std::string bytes;
};

struct Package {
    std::vector<PackageFile> files;

    // Null if there is no such file.
    const PackageFile* find(std::string_view path) const;
};

}  // namespace leafcutter::fab
