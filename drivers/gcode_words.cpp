#include "drivers/gcode_words.h"

#include <algorithm>
#include <cstddef>
#include <limits>

namespace leafcutter::drivers {

namespace {

bool is_digit(char letter) {
    return letter >= '0' && letter <= '9';
}

}  // namespace

std::optional<double> read_decimal(std::string_view text, std::size_t& at) {
    double sign = 1.0;
    if (at < text.size() && (text[at] == '-' || text[at] == '+')) {
        sign = text[at] == '-' ? -1.0 : 1.0;
        ++at;
    }
    double value = 0.0;
    double scale = 1.0;
    std::size_t digits = 0;
    bool fraction = false;
    for (; at < text.size(); ++at) {
        if (is_digit(text[at])) {
            ++digits;
            value = value * 10.0 + (text[at] - '0');
            scale *= fraction ? 10.0 : 1.0;
        } else if (text[at] == '.' && !fraction) {
            fraction = true;
        } else {
            break;
        }
    }
    if (digits == 0) {
        return std::nullopt;
    }
    return sign * value / scale;
}

std::string strip_gcode(std::string_view line) {
    std::string stripped;
    bool comment = false;
    for (const char letter : line) {
        if (comment) {
            comment = letter != ')';
        } else if (letter == '(') {
            comment = true;
        } else if (letter == ';') {
            break;
        } else if (static_cast<unsigned char>(letter) > ' ' && letter != '/') {
            const bool lower = letter >= 'a' && letter <= 'z';
            stripped += lower ? static_cast<char>(letter - 'a' + 'A') : letter;
        }
    }
    return stripped;
}

GcodeWords split_words(std::string_view stripped) {
    GcodeWords result;
    std::size_t at = 0;
    while (at < stripped.size()) {
        const char letter = stripped[at];
        if (letter < 'A' || letter > 'Z') {
            result.fault = WordFault::LetterExpected;
            return result;
        }
        ++at;
        const std::optional<double> value = read_decimal(stripped, at);
        if (!value) {
            result.fault = WordFault::BadNumber;
            return result;
        }
        result.words.push_back({letter, *value});
    }
    return result;
}

int whole_part(double value) {
    constexpr std::numeric_limits<int> kInt;
    return static_cast<int>(
        std::clamp(value, static_cast<double>(kInt.min()), static_cast<double>(kInt.max())));
}

std::string without_inline_word(std::string_view stripped) {
    std::string result(stripped);
    const std::string_view start = stripped.substr(0, 2);
    const std::size_t at = result.find('I');
    if ((start == "M3" || start == "M4" || start == "M5") && at != std::string::npos) {
        const std::size_t end = result.find_first_not_of("0123456789", at + 1);
        result.erase(at, end == std::string::npos ? end : end - at);
    }
    return result;
}

}  // namespace leafcutter::drivers
