#include "geometry/io/text_scanner.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <system_error>

#include <fmt/format.h>

namespace leafcutter::geometry {

namespace {

constexpr bool is_blank(char letter) {
    return letter == ' ' || letter == '\t' || letter == '\v' || letter == '\f';
}

std::string_view without_plus(std::string_view word) {
    const bool signed_number = word.size() > 1 && word[0] == '+' && word[1] != '-';
    return signed_number ? word.substr(1) : word;
}

}  // namespace

std::string_view as_text(std::span<const std::byte> bytes) {
    std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    if (text.starts_with("\xEF\xBB\xBF")) {
        text.remove_prefix(3);
    }
    return text;
}

Error bad_line(std::string code, std::size_t line, const std::string& message) {
    return {ErrorKind::BadFile, std::move(code), fmt::format("line {}: {}", line, message)};
}

std::string quoted(std::string_view word) {
    constexpr std::size_t kLongest = 40;
    std::string clean(word.substr(0, kLongest));
    std::replace_if(
        clean.begin(), clean.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
    return '"' + clean + (word.size() > kLongest ? "...\"" : "\"");
}

bool LineScanner::next() {
    if (position_ >= text_.size()) {
        return false;
    }
    ++number_;
    const std::string_view rest = text_.substr(position_, max_line_bytes_ + 1);
    const std::size_t end = rest.find_first_of("\n\r");
    const std::size_t length = std::min(end, rest.size());
    if (length > max_line_bytes_) {
        throw bad_line("line-too-long", number_,
                       fmt::format("longer than {} bytes; this is no text file", max_line_bytes_));
    }
    line_ = rest.substr(0, length);
    position_ += length;
    if (text_.substr(position_, 2) == "\r\n") {
        position_ += 2;
    } else if (position_ < text_.size()) {
        position_ += 1;
    }
    return true;
}

bool LineScanner::next_content() {
    while (next()) {
        line_ = line_.substr(0, line_.find('#'));
        if (!std::all_of(line_.begin(), line_.end(), is_blank)) {
            return true;
        }
    }
    return false;
}

std::string_view take_word(std::string_view& line) {
    std::size_t begin = 0;
    while (begin < line.size() && is_blank(line[begin])) {
        ++begin;
    }
    std::size_t end = begin;
    while (end < line.size() && !is_blank(line[end])) {
        ++end;
    }
    const std::string_view word = line.substr(begin, end - begin);
    line.remove_prefix(end);
    return word;
}

std::string lower_case(std::string_view word) {
    std::string lower(word);
    for (char& letter : lower) {
        if (letter >= 'A' && letter <= 'Z') {
            letter = static_cast<char>(letter - 'A' + 'a');
        }
    }
    return lower;
}

std::optional<double> parse_number(std::string_view word) {
    word = without_plus(word);
    double value = 0.0;
    const char* end = word.data() + word.size();
    const auto [stop, status] = std::from_chars(word.data(), end, value);
    if (stop != end || status == std::errc::invalid_argument) {
        return std::nullopt;
    }
    if (status == std::errc::result_out_of_range) {
        // from_chars doesn't say on which side: too small is as good as 0, too large is infinite.
        const bool underflow = word.find("e-") != word.npos || word.find("E-") != word.npos;
        return underflow ? 0.0 : std::numeric_limits<double>::infinity();
    }
    return value;
}

std::optional<std::int64_t> parse_integer(std::string_view word) {
    word = without_plus(word);
    std::int64_t value = 0;
    const char* end = word.data() + word.size();
    const auto [stop, status] = std::from_chars(word.data(), end, value);
    if (stop != end || status != std::errc()) {
        return std::nullopt;
    }
    return value;
}

Eigen::Vector3d take_position(std::string_view& line, std::size_t line_number) {
    Eigen::Vector3d position;
    for (int axis = 0; axis < 3; ++axis) {
        const std::string_view word = take_word(line);
        if (word.empty()) {
            throw bad_line("truncated", line_number,
                           fmt::format("a vertex needs 3 coordinates, this one has {}", axis));
        }
        const std::optional<double> value = parse_number(word);
        if (!value) {
            throw bad_line("bad-number", line_number,
                           fmt::format("{} is no number; a coordinate is expected", quoted(word)));
        }
        if (!std::isfinite(*value)) {
            throw bad_line("non-finite", line_number,
                           fmt::format("non-finite coordinate {}", quoted(word)));
        }
        position[axis] = *value;
    }
    return position;
}

}  // namespace leafcutter::geometry
