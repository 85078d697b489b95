// Grbl 1.1 line protocol as a pure state machine: bytes in, events out. Opens nothing.
//
// Flow control is character counting: the sender keeps the bytes of unacknowledged lines within
// the controller's receive buffer, and each "ok" or "error:N" frees the oldest line. Nothing else
// counts: not the banner, "ALARM:N", "[…]", "<…>", "$n=v", nor ">startup line:ok". Room for one
// more line than is counted stays free, so that an "ok" that noise has doubled can't overfill the
// buffer.

#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace leafcutter::drivers {

struct GrblEvent {
    // Garbled: what noise has left of an "ok"; GarbledError: of "ok" or "error:N", nobody knows.
    enum class Kind {
        Ack,
        Error,
        Alarm,
        Status,
        Banner,
        Setting,
        Message,
        Garbled,
        GarbledError,
        Other
    };

    Kind kind = Kind::Other;
    int code = 0;      // N of "error:N" or "ALARM:N", otherwise 0.
    std::string text;  // The whole line, without its line end.
};

class GrblProtocol {
public:
    // One less than Grbl's 128: version 0.9 and some clones hold only that.
    static constexpr std::size_t kSafeRxBytes = 127;
    static constexpr std::size_t kMaxLine = 79;

    explicit GrblProtocol(std::size_t rx_buffer_bytes = kSafeRxBytes);

    // Takes any split of the incoming stream and returns the lines completed by it. Endless lines
    // are cut at 512 bytes.
    std::vector<GrblEvent> receive(std::string_view bytes);

    // Returns the bytes to write now, or nothing while the controller's buffer is full.
    // Throws std::invalid_argument for a line that could never fit, or that holds a byte which the
    // controller takes out of the stream (line ends, real-time commands).
    std::optional<std::string> offer(std::string_view line);

    std::size_t bytes_in_flight() const { return bytes_in_flight_; }
    std::size_t lines_in_flight() const { return line_sizes_.size(); }
    std::size_t rx_buffer_bytes() const { return rx_buffer_bytes_; }

    void set_rx_buffer_bytes(std::size_t bytes) { rx_buffer_bytes_ = bytes; }
    std::size_t longest_line() const { return longest_line_; }
    void set_longest_line(std::size_t characters) { longest_line_ = characters; }

    // After a reset: the controller has forgotten what it was sent.
    void forget_lines();

    std::size_t oldest_line_bytes() const { return line_sizes_.empty() ? 0 : line_sizes_.front(); }

    // The oldest line counts as answered though no answer was heard.
    void resolve_oldest() { count_answer(); }

    // A line has been counted as answered too early: `bytes` are still in the controller.
    void take_back_answer(std::size_t bytes);

private:
    GrblEvent classify(std::string line) const;
    void count_answer();

    std::size_t reserve() const;

    std::size_t rx_buffer_bytes_;
    std::size_t longest_line_ = kMaxLine;
    std::size_t bytes_in_flight_ = 0;
    std::deque<std::size_t> line_sizes_;  // Sent, not yet acknowledged; oldest first.
    std::deque<std::size_t> answered_;    // Sizes of the lines answered last.
    std::string partial_;
};

// A byte that Grbl takes for a real-time command wherever it stands.
bool is_realtime_byte(char byte);

}  // namespace leafcutter::drivers
