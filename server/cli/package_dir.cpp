#include "server/cli/package_dir.h"

#include <cstdio>
#include <fcntl.h>
#include <fstream>
#include <system_error>
#include <unistd.h>

#include <fmt/format.h>

#include "server/cli/command.h"

namespace leafcutter::server {

namespace fs = std::filesystem;

namespace {

bool holds_package(const fs::path& directory) {
    std::ifstream report(directory / "report.json", std::ios::binary);
    std::string start(400, '\0');
    report.read(start.data(), static_cast<std::streamsize>(start.size()));
    return start.find("\"leafcutter-report/") != std::string::npos;
}

fs::path beside(const fs::path& path, const char* what) {
    return path.parent_path() / fmt::format("{}.{}-{}", path.filename().string(), what, ::getpid());
}

void write_files(const fs::path& directory, const fab::Package& package) {
    for (const fab::PackageFile& file : package.files) {
        const fs::path path = directory / file.path;
        fs::create_directories(path.parent_path());
        std::ofstream stream(path, std::ios::binary | std::ios::trunc);
        stream.write(file.bytes.data(), static_cast<std::streamsize>(file.bytes.size()));
        stream.close();
        if (!stream) {
            throw UsageError(fmt::format("{}: can't be written", path.string()));
        }
    }
}

// Takes a directory away with it unless it was moved elsewhere.
class TemporaryDir {
public:
    explicit TemporaryDir(fs::path path) : path_(std::move(path)) { fs::create_directories(path_); }
    ~TemporaryDir() {
        std::error_code ignored;
        fs::remove_all(path_, ignored);
    }
    TemporaryDir(const TemporaryDir&) = delete;
    TemporaryDir& operator=(const TemporaryDir&) = delete;

    const fs::path& path() const { return path_; }

private:
    fs::path path_;
};

// Afterwards `fresh` holds what was there before. At once where the file system can do that.
void change_places(const fs::path& fresh, const fs::path& place) {
    if (::renameat2(AT_FDCWD, fresh.c_str(), AT_FDCWD, place.c_str(), RENAME_EXCHANGE) == 0) {
        return;
    }
    const fs::path aside = beside(place, "old");
    fs::rename(place, aside);
    std::error_code failure;
    fs::rename(fresh, place, failure);
    if (failure) {
        fs::rename(aside, place);
        throw fs::filesystem_error("rename", place, failure);
    }
    fs::rename(aside, fresh);
}

}  // namespace

PackageDir::PackageDir(const std::string& path) {
    std::error_code failure;
    path_ = fs::weakly_canonical(path, failure);
    if (path.empty() || failure) {
        throw UsageError(fmt::format("-o {}: {}", path, failure ? failure.message() : "is empty"));
    }
    if (path_.filename().empty()) {
        path_ = path_.parent_path();
    }
    if (path_ == path_.root_path()) {
        throw UsageError(fmt::format("-o {}: name a directory of its own", path));
    }
    if (!fs::exists(path_, failure)) {
        return;
    }
    if (!fs::is_directory(path_, failure)) {
        throw UsageError(fmt::format("-o {}: is a file; name a directory", path));
    }
    if (!fs::is_empty(path_, failure) && !holds_package(path_)) {
        throw UsageError(
            fmt::format("-o {}: holds other files than a package; name a new directory", path));
    }
}

void PackageDir::write(const fab::Package& package) const {
    try {
        const TemporaryDir partial(beside(path_, "partial"));
        write_files(partial.path(), package);
        if (fs::exists(path_)) {
            change_places(partial.path(), path_);
        } else {
            fs::rename(partial.path(), path_);
        }
    } catch (const fs::filesystem_error& error) {
        throw UsageError(fmt::format("-o {}: {}", path_.string(), error.code().message()));
    }
}

}  // namespace leafcutter::server
