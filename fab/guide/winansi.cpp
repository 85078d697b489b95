#include "fab/guide/winansi.h"

#include <array>
#include <cstdint>

#include "fab/utf8.h"

namespace leafcutter::fab::guide {

namespace {

// What Windows-1252 has at 0x80 to 0x9f; 0 where it has nothing.
constexpr std::array<char32_t, 32> kHighControls = {
    0x20ac, 0,      0x201a, 0x0192, 0x201e, 0x2026, 0x2020, 0x2021, 0x02c6, 0x2030, 0x0160,
    0x2039, 0x0152, 0,      0x017d, 0,      0,      0x2018, 0x2019, 0x201c, 0x201d, 0x2022,
    0x2013, 0x2014, 0x02dc, 0x2122, 0x0161, 0x203a, 0x0153, 0,      0x017e, 0x0178};

// U+0100 to U+017F without their accents.
constexpr std::string_view kLatinExtendedA =
    "AaAaAaCcCcCcCcDdDdEeEeEeEeEeGgGgGgGgHhHhIiIiIiIiIiIiJjKkkLlLlLlLlLlNnNnNnnNnOoOoOoOoRrRrRrSsSs"
    "SsSsTtTtTtUuUuUuUuUuUuWwYyYZzZzZzs";
static_assert(kLatinExtendedA.size() == 128);

char letter_of(char32_t code) {
    if (code < 0x20 || (code >= 0x7f && code < 0xa0)) {
        return ' ';
    }
    if (code < 0x100) {
        return static_cast<char>(code);
    }
    for (std::size_t i = 0; i < kHighControls.size(); ++i) {
        if (kHighControls[i] == code) {
            return static_cast<char>(0x80 + i);
        }
    }
    if (code < 0x180) {
        return kLatinExtendedA[code - 0x100];
    }
    switch (code) {
        case 0x2010:  // Hyphens and the minus sign.
        case 0x2011:
        case 0x2212:
            return '-';
        case 0x2002:  // Blanks of several widths.
        case 0x2003:
        case 0x2009:
        case 0x202f:
            return ' ';
        default:
            return '?';
    }
}

}  // namespace

std::string to_winansi(std::string_view utf8) {
    const std::string text = valid_utf8(utf8);
    std::string result;
    for (std::size_t i = 0; i < text.size();) {
        const auto lead = static_cast<unsigned char>(text[i]);
        const std::size_t length = lead < 0x80 ? 1 : lead < 0xe0 ? 2 : lead < 0xf0 ? 3 : 4;
        char32_t code = length == 1 ? lead : lead & (0xffU >> (length + 1));
        for (std::size_t k = 1; k < length && i + k < text.size(); ++k) {
            code = (code << 6U) | (static_cast<unsigned char>(text[i + k]) & 0x3fU);
        }
        i += length;
        // An accent of its own that follows its letter is left out.
        if (code < 0x300 || code > 0x36f) {
            result += letter_of(code);
        }
    }
    return result;
}

}  // namespace leafcutter::fab::guide
