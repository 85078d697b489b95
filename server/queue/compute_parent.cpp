// The daemon's side of a computing child.

#include <array>
#include <cerrno>
#include <csignal>
#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <system_error>
#include <unistd.h>
#include <utility>

#include <fmt/format.h>

#include "geometry/error.h"
#include "server/queue/compute_child.h"
#include "server/queue/compute_messages.h"
#include "server/queue/frames.h"
#include "server/store/blobs.h"

extern char** environ;

namespace leafcutter::server {

namespace {

using Clock = std::chrono::steady_clock;

struct Pipe {
    FileHandle reading;
    FileHandle writing;
};

Pipe make_pipe() {
    std::array<int, 2> ends{};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) {
        throw std::system_error(errno, std::generic_category(), "pipe");
    }
    return {FileHandle(ends[0]), FileHandle(ends[1])};
}

// Clean of the daemon's signals and files; in a group of its own, so that a terminal's Ctrl-C does
// not reach it before the daemon has decided.
pid_t spawn(int in, int out, const ComputeBudget& budget) {
    const std::string memory = std::to_string(budget.memory_bytes >> 20U);
    const std::array<const char*, 5> arguments{"leafcutter", "compute-job", "--memory-mb",
                                               memory.c_str(), nullptr};
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_adddup2(&files, in, STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&files, out, STDOUT_FILENO);
    posix_spawn_file_actions_addclosefrom_np(&files, STDERR_FILENO + 1);
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    sigset_t none;
    sigemptyset(&none);
    sigset_t all;
    sigfillset(&all);
    posix_spawnattr_setsigmask(&attributes, &none);
    posix_spawnattr_setsigdefault(&attributes, &all);
    posix_spawnattr_setpgroup(&attributes, 0);
    posix_spawnattr_setflags(
        &attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP);
    pid_t pid = 0;
    const int error = ::posix_spawn(&pid, "/proc/self/exe", &files, &attributes,
                                    const_cast<char* const*>(arguments.data()), environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&files);
    if (error != 0) {
        throw std::system_error(error, std::generic_category(), "start of a computing process");
    }
    return pid;
}

// A running child. It is dead when this is.
class Child {
public:
    explicit Child(const ComputeBudget& budget) {
        Pipe down = make_pipe();
        Pipe up = make_pipe();
        pid_ = spawn(down.reading.fd(), up.writing.fd(), budget);
        in_.emplace(std::move(down.writing));
        out_.emplace(std::move(up.reading));
        ::fcntl(in_->fd(), F_SETFL, O_NONBLOCK);
        ::fcntl(out_->fd(), F_SETFL, O_NONBLOCK);
    }
    ~Child() {
        if (pid_ > 0) {
            ::kill(pid_, SIGKILL);
            wait();
        }
    }
    Child(const Child&) = delete;
    Child& operator=(const Child&) = delete;

    // Whether anything can be read. Sends what it can of `unsent` meanwhile.
    bool exchange(std::string_view& unsent);

    // Nothing: it has no more to say.
    bool read(FrameReader& into);

    // How it ended.
    std::string wait();

private:
    pid_t pid_ = 0;
    std::optional<FileHandle> in_;
    std::optional<FileHandle> out_;
};

bool Child::exchange(std::string_view& unsent) {
    constexpr int kLookMs = 50;
    if (unsent.empty()) {
        in_.reset();
    }
    std::array<pollfd, 2> wanted{{{out_->fd(), POLLIN, 0}, {-1, POLLOUT, 0}}};
    if (in_) {
        wanted[1].fd = in_->fd();
    }
    ::poll(wanted.data(), wanted.size(), kLookMs);
    if (in_ && wanted[1].revents != 0) {
        const ssize_t written = ::write(in_->fd(), unsent.data(), unsent.size());
        if (written > 0) {
            unsent.remove_prefix(static_cast<std::size_t>(written));
        } else if (errno != EAGAIN && errno != EINTR) {
            unsent = {};  // It takes nothing more: its last words say why.
        }
    }
    return wanted[0].revents != 0;
}

bool Child::read(FrameReader& into) {
    std::array<char, 65536> piece;
    const ssize_t got = ::read(out_->fd(), piece.data(), piece.size());
    if (got > 0) {
        into.add({piece.data(), static_cast<std::size_t>(got)});
    }
    return got > 0 || (got < 0 && (errno == EAGAIN || errno == EINTR));
}

std::string Child::wait() {
    int status = 0;
    while (::waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
    }
    pid_ = 0;
    return WIFSIGNALED(status) ? fmt::format("signal {}", WTERMSIG(status))
                               : fmt::format("exit status {}", WEXITSTATUS(status));
}

// Takes the child's frames until its last one.
class Listener {
public:
    explicit Listener(const geometry::Context& context) : context_(context) {}

    // True: that was the result. Throws ComputeFailed.
    bool take(Frame frame) {
        switch (frame.kind) {
            case kProgressFrame: {
                const ComputeProgress progress = read_progress_message(frame.bytes);
                context_.progress(progress.stage, progress.fraction);
                return false;
            }
            case kPathFrame:
                path_ = std::move(frame.bytes);
                return false;
            case kFileFrame:
                files_.push_back({std::move(path_), std::move(frame.bytes)});
                return false;
            case kResultFrame:
                output_ = read_result_message(frame.bytes);
                output_.package.files = std::move(files_);
                return true;
            case kErrorFrame:
                throw ComputeFailed(read_failure_message(frame.bytes));
            default:
                throw std::runtime_error("a computing process talks nonsense");
        }
    }

    ComputeOutput output() { return std::move(output_); }

private:
    const geometry::Context& context_;
    std::string path_;
    std::vector<fab::PackageFile> files_;
    ComputeOutput output_;
};

void check_limits(const geometry::Context& context,
                  Clock::time_point begun,
                  std::chrono::seconds most) {
    if (context.stop.stop_requested()) {
        throw geometry::Cancelled();
    }
    if (most.count() > 0 && Clock::now() - begun > most) {
        throw ComputeFailed(
            {"budget", "time-budget",
             fmt::format("the computation took more than the {} s it is given", most.count())});
    }
}

ComputeOutput compute(const ComputeBudget& budget,
                      const ComputeInput& input,
                      const geometry::Context& context) {
    const auto* mesh = reinterpret_cast<const char*>(input.bytes.data());
    const std::string job = job_message(input, context.threads);
    std::string heading = frame_head(kJobFrame, job.size()) + job;
    for (const fab::PackageFile& file : input.package) {
        heading += frame_head(kPathFrame, file.path.size()) + file.path;
        heading += frame_head(kFileFrame, file.bytes.size()) + file.bytes;
    }
    heading += frame_head(kMeshFrame, input.bytes.size());
    std::string_view heading_left = heading;
    std::string_view mesh_left(mesh, input.bytes.size());
    Child child(budget);
    FrameReader reader;
    Listener listener(context);
    const Clock::time_point begun = Clock::now();
    while (true) {
        check_limits(context, begun, budget.time);
        if (!child.exchange(heading_left.empty() ? mesh_left : heading_left)) {
            continue;
        }
        const bool open = child.read(reader);
        while (auto frame = reader.next()) {
            if (listener.take(*std::move(frame))) {
                return listener.output();
            }
        }
        if (!open) {
            throw ComputeCrashed(
                fmt::format("its process ended without a word ({})", child.wait()));
        }
    }
}

}  // namespace

Compute compute_in_child(const ComputeBudget& budget) {
    return [budget](const ComputeInput& input, const geometry::Context& context) {
        return compute(budget, input, context);
    };
}

}  // namespace leafcutter::server
