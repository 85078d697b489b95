// Work in a process of its own, so that its peak memory is its own too.

#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <exception>
#include <functional>
#include <string>
#include <string_view>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

namespace leafcutter::bench {

struct ChildRun {
    std::vector<double> figures;  // What the work returned.
    double peak_mib = 0.0;        // Largest resident size of the child.
    std::string failure;          // Empty unless the work threw or the child died.
};

inline double seconds_of(const std::function<void()>& work) {
    const auto begun = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
}

// Processor time of all threads of this process.
inline double processor_s() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    const auto seconds = [](const timeval& time) {
        return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
    };
    return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

namespace detail {

inline void write_all(int pipe, const void* data, std::size_t size) {
    const char* from = static_cast<const char*>(data);
    while (size > 0) {
        const ssize_t written = write(pipe, from, size);
        if (written <= 0) {
            _exit(2);
        }
        from += written;
        size -= static_cast<std::size_t>(written);
    }
}

[[noreturn]] inline void work_in_child(int pipe, const std::function<std::vector<double>()>& work) {
    try {
        const std::vector<double> figures = work();
        write_all(pipe, figures.data(), figures.size() * sizeof(double));
        _exit(0);
    } catch (const std::exception& error) {
        const std::string_view what = error.what();
        write_all(pipe, what.data(), what.size());
        _exit(1);
    }
}

}  // namespace detail

inline ChildRun run_in_child(const std::function<std::vector<double>()>& work) {
    std::array<int, 2> ends{};
    if (pipe(ends.data()) != 0) {
        return {{}, 0.0, "no pipe"};
    }
    const pid_t child = fork();
    if (child == 0) {
        close(ends[0]);
        detail::work_in_child(ends[1], work);
    }
    close(ends[1]);
    std::string bytes;
    std::array<char, 4096> buffer{};
    for (ssize_t got = 0; (got = read(ends[0], buffer.data(), buffer.size())) > 0;) {
        bytes.append(buffer.data(), static_cast<std::size_t>(got));
    }
    close(ends[0]);
    int status = 0;
    rusage usage{};
    if (child < 0 || wait4(child, &status, 0, &usage) < 0) {
        return {{}, 0.0, "no child"};
    }
    ChildRun run;
    run.peak_mib = static_cast<double>(usage.ru_maxrss) / 1024.0;
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
        run.failure = bytes.empty() ? "the child died" : bytes;
        return run;
    }
    run.figures.resize(bytes.size() / sizeof(double));
    bytes.copy(reinterpret_cast<char*>(run.figures.data()), run.figures.size() * sizeof(double));
    return run;
}

}  // namespace leafcutter::bench
