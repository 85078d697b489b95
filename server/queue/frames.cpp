#include "server/queue/frames.h"

#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <unistd.h>

namespace leafcutter::server {

namespace {

constexpr std::size_t kHead = 1 + sizeof(std::uint64_t);
constexpr std::uint64_t kLongest = 4ULL << 30;

}  // namespace

std::string frame_head(char kind, std::uint64_t bytes) {
    std::string head(kHead, kind);
    std::memcpy(head.data() + 1, &bytes, sizeof(bytes));
    return head;
}

std::optional<Frame> FrameReader::next() {
    const std::string_view rest = std::string_view(waiting_).substr(taken_);
    std::uint64_t length = 0;
    if (rest.size() < kHead) {
        return std::nullopt;
    }
    std::memcpy(&length, rest.data() + 1, sizeof(length));
    if (length > kLongest) {
        throw std::length_error("a message of impossible length");
    }
    if (rest.size() - kHead < length) {
        return std::nullopt;
    }
    Frame frame{rest.front(), std::string(rest.substr(kHead, length))};
    taken_ += kHead + length;
    if (taken_ > waiting_.size() / 2) {
        waiting_.erase(0, taken_);
        taken_ = 0;
    }
    return frame;
}

bool write_all(int fd, std::string_view bytes) {
    while (!bytes.empty()) {
        const ssize_t written = ::write(fd, bytes.data(), bytes.size());
        if (written < 0 && errno == EINTR) {
            continue;
        }
        if (written < 0) {
            return false;
        }
        bytes.remove_prefix(static_cast<std::size_t>(written));
    }
    return true;
}

std::optional<Frame> read_frame(int fd, FrameReader& reader) {
    std::array<char, 65536> piece;
    while (true) {
        if (auto frame = reader.next()) {
            return frame;
        }
        const ssize_t got = ::read(fd, piece.data(), piece.size());
        if (got < 0 && errno == EINTR) {
            continue;
        }
        if (got <= 0) {
            return std::nullopt;
        }
        reader.add({piece.data(), static_cast<std::size_t>(got)});
    }
}

}  // namespace leafcutter::server
