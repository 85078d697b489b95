// Lines, words and numbers of the text mesh formats, for hostile input. Internal to geometry/io.

#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include <Eigen/Core>

#include "geometry/error.h"

namespace leafcutter::geometry {

// The bytes as text; a UTF-8 byte order mark is left out.
std::string_view as_text(std::span<const std::byte> bytes);

// A defect of the file, with its line.
Error bad_line(std::string code, std::size_t line, const std::string& message);

// At most 40 bytes of `word` with everything but printable ASCII replaced, fit for any message.
std::string quoted(std::string_view word);

// Walks over the lines of a text; they end with LF, CR LF or CR.
class LineScanner {
public:
    LineScanner(std::string_view text, std::size_t max_line_bytes)
        : text_(text), max_line_bytes_(max_line_bytes) {}

    // Goes to the next line; false at the end. Throws Error(BadFile) if the line is too long.
    bool next();

    // Goes to the next line that holds more than blanks once a '#' comment is cut off.
    bool next_content();

    std::string_view line() const { return line_; }
    std::size_t number() const { return number_; }  // Of the present line, from 1.
    std::size_t bytes_left() const { return text_.size() - position_; }

private:
    std::string_view text_;
    std::size_t max_line_bytes_;
    std::size_t position_ = 0;
    std::size_t number_ = 0;
    std::string_view line_;
};

// Cuts the first word off `line`; empty when only blanks are left.
std::string_view take_word(std::string_view& line);

// ASCII only, no locale.
std::string lower_case(std::string_view word);

// The whole word as a number, or nothing. A leading '+' is taken; NaN and infinity come back as
// such.
std::optional<double> parse_number(std::string_view word);
std::optional<std::int64_t> parse_integer(std::string_view word);

// The next three words as a finite position.
// Throws Error(BadFile) with the line number for a missing, malformed or non-finite coordinate.
Eigen::Vector3d take_position(std::string_view& line, std::size_t line_number);

}  // namespace leafcutter::geometry
