// Splits a line of G-code into its words, by the rules of Grbl's reader.

#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace leafcutter::drivers {

struct GcodeWord {
    char letter = 0;     // Upper case.
    double value = 0.0;  // As written: no unit applied.
};

// The line without comments, blanks and control characters, in upper case. A `(` comment that is
// not closed reaches to the end of the line; a leading `/` is dropped.
std::string strip_gcode(std::string_view line);

enum class WordFault { LetterExpected, BadNumber };

// A plain decimal number at `at`, which moves behind it: Grbl knows no exponent.
std::optional<double> read_decimal(std::string_view text, std::size_t& at);

// Cut off behind the point; the largest or least int where it is beyond that.
int whole_part(double value);

struct GcodeWords {
    std::vector<GcodeWord> words;
    std::optional<WordFault> fault;  // Set: `words` ends before the faulty one.
};

// Takes a stripped line.
GcodeWords split_words(std::string_view stripped);

// A stripped line without the I of Marlin's M3, M4, M5: inline power, which goes with the moves as
// that of the other families always does.
std::string without_inline_word(std::string_view stripped);

}  // namespace leafcutter::drivers
