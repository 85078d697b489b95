#include "server/cli/interrupt.h"

#include <array>
#include <atomic>
#include <cerrno>
#include <fcntl.h>
#include <system_error>
#include <unistd.h>

namespace leafcutter::server {

namespace {

// A signal handler may touch nothing but this.
std::atomic<int> pipe_of_handler{-1};

constexpr char kSignalled = 's';
constexpr char kEnd = 'e';

extern "C" void write_to_pipe(int /*number*/) {
    const int saved = errno;
    const int pipe = pipe_of_handler.load();
    if (pipe >= 0) {
        [[maybe_unused]] const ssize_t written = write(pipe, &kSignalled, 1);
    }
    errno = saved;
}

// A stop request runs callbacks and wakes waiters, which no handler may do: done by a thread of its
// own.
void forward(int pipe, const std::stop_source& source) {
    // Reads on after a signal: the end is written to a pipe that must still have its reader.
    char what = 0;
    while (what != kEnd) {
        const ssize_t got = read(pipe, &what, 1);
        if (got == 0 || (got < 0 && errno != EINTR)) {
            break;
        }
        if (got == 1 && what == kSignalled) {
            source.request_stop();
        }
    }
    close(pipe);
}

}  // namespace

InterruptWatch::InterruptWatch() {
    std::array<int, 2> ends{};
    if (pipe2(ends.data(), O_CLOEXEC) != 0) {
        throw std::system_error(errno, std::generic_category(), "pipe");
    }
    listen_ = ends[0];
    wake_ = ends[1];
    pipe_of_handler = wake_;
    thread_ = std::jthread(forward, ends[0], source_);
    struct sigaction action {};
    action.sa_handler = write_to_pipe;
    action.sa_flags = static_cast<int>(SA_RESETHAND | SA_RESTART);
    sigaction(SIGINT, &action, &before_int_);
    sigaction(SIGTERM, &action, &before_term_);
}

InterruptWatch::~InterruptWatch() {
    sigaction(SIGINT, &before_int_, nullptr);
    sigaction(SIGTERM, &before_term_, nullptr);
    pipe_of_handler = -1;
    [[maybe_unused]] const ssize_t written = write(wake_, &kEnd, 1);
    thread_.join();
    close(wake_);
    close(listen_);
}

}  // namespace leafcutter::server
