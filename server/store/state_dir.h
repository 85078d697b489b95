// The daemon's folder: owned by one process at a time.

#pragma once

#include <filesystem>
#include <stdexcept>

namespace leafcutter::server {

// The state folder can't be used; the message says why and what to do.
class StateDirUnusable : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

// Holds the lock on a state folder as long as it lives; the kernel lets go when the process dies.
class StateDir {
public:
    // Creates the folder (mode 0700) if needed. Throws StateDirUnusable, at once, if another daemon
    // has it.
    explicit StateDir(std::filesystem::path path);
    ~StateDir();
    StateDir(const StateDir&) = delete;
    StateDir& operator=(const StateDir&) = delete;

    const std::filesystem::path& path() const { return path_; }

private:
    std::filesystem::path path_;
    int lock_fd_ = -1;
};

}  // namespace leafcutter::server
