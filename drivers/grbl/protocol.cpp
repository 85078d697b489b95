#include "drivers/grbl/protocol.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <stdexcept>
#include <utility>

namespace leafcutter::drivers {

namespace {

constexpr std::size_t kLongestReply = 512;
constexpr std::size_t kAnswersKept = 8;

bool starts_with(std::string_view text, std::string_view start) {
    return text.substr(0, start.size()) == start;
}

bool is_banner(std::string_view line) {
    std::string lower(line.substr(0, 7));
    std::transform(lower.begin(), lower.end(), lower.begin(),
                   [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
    return starts_with(lower, "grbl ") || starts_with(lower, "grblhal");
}

int number_after(std::string_view line, std::size_t at) {
    int code = 0;
    std::from_chars(line.data() + at, line.data() + line.size(), code);
    return code;
}

// What is left of an "ok" after a byte of it was lost or changed: an "error:N" is never so short.
constexpr std::size_t kLongestGarbledOk = 3;
constexpr std::size_t kLongestGarbledError = 9;

bool begins_like_a_message(char letter) {
    return letter == '[' || letter == '<' || letter == '>' || letter == '$';
}

bool is_setting(std::string_view line) {
    const std::size_t equals = line.find('=');
    return line.size() > 2 && line[0] == '$' && equals != std::string_view::npos && equals > 1;
}

}  // namespace

bool is_realtime_byte(char byte) {
    const auto code = static_cast<unsigned char>(byte);
    return code == 0x18 || code == '?' || code == '!' || code == '~' || code > 0x7F;
}

GrblProtocol::GrblProtocol(std::size_t rx_buffer_bytes) : rx_buffer_bytes_(rx_buffer_bytes) {}

std::vector<GrblEvent> GrblProtocol::receive(std::string_view bytes) {
    std::vector<GrblEvent> events;
    for (const char byte : bytes) {
        const bool line_end = byte == '\n' || byte == '\r';
        if (!line_end) {
            partial_ += byte;
        }
        if ((line_end && !partial_.empty()) || partial_.size() >= kLongestReply) {
            events.push_back(classify(std::exchange(partial_, {})));
            const GrblEvent::Kind kind = events.back().kind;
            if (kind == GrblEvent::Kind::Ack || kind == GrblEvent::Kind::Error) {
                count_answer();
            }
        }
    }
    return events;
}

GrblEvent GrblProtocol::classify(std::string line) const {
    using Kind = GrblEvent::Kind;
    GrblEvent event;
    if (line == "ok") {
        event.kind = Kind::Ack;
    } else if (starts_with(line, "error:")) {
        event = {Kind::Error, number_after(line, 6), {}};
    } else if (starts_with(line, "ALARM:")) {
        event = {Kind::Alarm, number_after(line, 6), {}};
    } else if (line.front() == '<' && line.back() == '>') {
        event.kind = Kind::Status;
    } else if (is_banner(line)) {
        event.kind = Kind::Banner;
    } else if (is_setting(line)) {
        event.kind = Kind::Setting;
    } else if (line.front() == '[' && line.back() == ']') {
        event.kind = Kind::Message;
    } else if (line.size() <= kLongestGarbledOk) {
        event.kind = Kind::Garbled;
    } else if (line.size() <= kLongestGarbledError && !begins_like_a_message(line.front())) {
        event.kind = Kind::GarbledError;
    }
    event.text = std::move(line);
    return event;
}

void GrblProtocol::count_answer() {
    if (!line_sizes_.empty()) {
        bytes_in_flight_ -= line_sizes_.front();
        answered_.push_back(line_sizes_.front());
        line_sizes_.pop_front();
        if (answered_.size() > kAnswersKept) {
            answered_.pop_front();
        }
    }
}

// The longest of the lines that a doubled "ok" could have let out of the count.
std::size_t GrblProtocol::reserve() const {
    return answered_.empty() ? 0 : *std::max_element(answered_.begin(), answered_.end());
}

void GrblProtocol::take_back_answer(std::size_t bytes) {
    line_sizes_.push_front(bytes);
    bytes_in_flight_ += bytes;
}

std::optional<std::string> GrblProtocol::offer(std::string_view line) {
    const std::size_t size = line.size() + 1;
    const bool foreign = std::any_of(line.begin(), line.end(), [](char byte) {
        return byte == '\n' || byte == '\r' || is_realtime_byte(byte);
    });
    if (foreign || line.size() > longest_line_ || size > rx_buffer_bytes_) {
        throw std::invalid_argument("\"" + std::string(line) + "\": no line that Grbl can take");
    }
    if (bytes_in_flight_ > 0 && bytes_in_flight_ + size + reserve() > rx_buffer_bytes_) {
        return std::nullopt;
    }
    bytes_in_flight_ += size;
    line_sizes_.push_back(size);
    return std::string(line) + '\n';
}

void GrblProtocol::forget_lines() {
    bytes_in_flight_ = 0;
    line_sizes_.clear();
    answered_.clear();
}

}  // namespace leafcutter::drivers
