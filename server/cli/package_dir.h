// A package as a directory, written so that it is there whole or not at all.

#pragma once

#include <filesystem>
#include <string>

#include "fab/package/package.h"

namespace leafcutter::server {

class PackageDir {
public:
    // Throws UsageError if `path` is no place for a package: a file, or a directory with anything
    // in it that is no package. Nothing is written yet.
    explicit PackageDir(const std::string& path);

    // Writes into a directory beside it, which then takes the place of an older package. Throws
    // UsageError naming the file that can't be written; then nothing is left behind.
    void write(const fab::Package& package) const;

private:
    std::filesystem::path path_;
};

}  // namespace leafcutter::server
