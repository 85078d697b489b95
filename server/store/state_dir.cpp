#include "server/store/state_dir.h"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <sys/file.h>
#include <system_error>
#include <unistd.h>
#include <utility>

#include <fmt/format.h>

namespace leafcutter::server {

StateDir::StateDir(std::filesystem::path path) : path_(std::move(path)) {
    std::error_code error;
    if (std::filesystem::create_directories(path_, error)) {
        std::filesystem::permissions(path_, std::filesystem::perms::owner_all, error);
    }
    const std::filesystem::path lock = path_ / "state.lock";
    lock_fd_ = ::open(lock.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
    if (lock_fd_ < 0) {
        throw StateDirUnusable(fmt::format("state folder {}: {}; name a writable one with --state",
                                           path_.string(), std::generic_category().message(errno)));
    }
    if (::flock(lock_fd_, LOCK_EX | LOCK_NB) != 0) {
        ::close(lock_fd_);
        throw StateDirUnusable(
            fmt::format("state folder {} belongs to a daemon that is running; stop it or name "
                        "another with --state",
                        path_.string()));
    }
}

StateDir::~StateDir() {
    ::close(lock_fd_);
}

}  // namespace leafcutter::server
