// Messages through a pipe: a letter, a length, bytes.

#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace leafcutter::server {

struct Frame {
    char kind = 0;
    std::string bytes;
};

std::string frame_head(char kind, std::uint64_t bytes);

// Cuts whole frames off the front of what has arrived.
class FrameReader {
public:
    void add(std::string_view bytes) { waiting_ += bytes; }

    // Nothing: there is no whole one yet. Throws std::length_error for one that is too long to be
    // meant.
    std::optional<Frame> next();

private:
    std::string waiting_;
    std::size_t taken_ = 0;
};

// For a process that does nothing else meanwhile. False, nothing: the other end is gone.
bool write_all(int fd, std::string_view bytes);
std::optional<Frame> read_frame(int fd, FrameReader& reader);

}  // namespace leafcutter::server
