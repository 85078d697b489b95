// A connection while a worker has it: reads and writes with deadlines.

#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace leafcutter::server {

struct Patience {
    std::chrono::milliseconds per_step{10000};
    std::int64_t least_bytes_per_s = 16384;  // After per_step, over the whole transfer.
};

class Connection {
public:
    // `early` was read beyond the head already. Owns nothing: the edge closes `fd`.
    Connection(int fd, std::string early, const Patience& patience);

    // The body to come, and whether the client waits to be asked for it.
    void expect_body(std::int64_t bytes, bool wants_continue);

    // Part of the body; 0 at its end. Throws RequestAborted.
    std::size_t read_body(std::span<char> room);
    std::int64_t body_left() const { return body_left_; }

    // False if the client is gone or too slow.
    bool write_all(const char* data, std::size_t size);

    int fd() const { return fd_; }

    // What came after the body: the begin of the next request.
    std::string take_early();

private:
    using Clock = std::chrono::steady_clock;

    bool wait_for(short event) const;
    bool is_too_slow(std::int64_t moved) const;

    int fd_;
    std::string early_;
    Patience patience_;
    std::int64_t body_left_ = 0;
    std::int64_t moved_in_ = 0;
    std::int64_t moved_out_ = 0;
    bool owes_continue_ = false;
    Clock::time_point since_ = Clock::now();
};

// The connection under a number of at most `most`, as soon as others are gone; -1: it is closed.
int with_low_number(int fd, int most);

}  // namespace leafcutter::server
