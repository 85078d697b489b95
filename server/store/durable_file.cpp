#include "server/store/durable_file.h"

#include <cerrno>
#include <fcntl.h>
#include <system_error>
#include <unistd.h>

namespace leafcutter::server {

namespace {

void sync_opened(const std::filesystem::path& path, int flags) {
    const int fd = ::open(path.c_str(), flags | O_RDONLY | O_CLOEXEC);
    const bool synced = fd >= 0 && ::fsync(fd) == 0;
    const int error = errno;
    if (fd >= 0) {
        ::close(fd);
    }
    if (!synced) {
        throw std::system_error(error, std::generic_category(), "sync of " + path.string());
    }
}

}  // namespace

void sync_file(const std::filesystem::path& file) {
    sync_opened(file, 0);
}

void sync_folder(const std::filesystem::path& folder) {
    sync_opened(folder, O_DIRECTORY);
}

void rename_durably(const std::filesystem::path& from, const std::filesystem::path& to) {
    std::filesystem::rename(from, to);
    sync_folder(to.parent_path());
}

}  // namespace leafcutter::server
