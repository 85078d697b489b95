#include "fab/strips/labels.h"

#include <array>
#include <cmath>
#include <numbers>
#include <utility>

namespace leafcutter::fab {

namespace {

using Eigen::Vector2d;

constexpr std::array kGlyphs = {
    Glyph{'0', 4, "103041453616050110"},
    Glyph{'1', 2, "042620"},
    Glyph{'2', 4, "05163645440040"},
    Glyph{'3', 4, "064623334241301001"},
    Glyph{'4', 4, "30360242"},
    Glyph{'5', 4, "4606033342413000"},
    Glyph{'6', 4, "360200404303"},
    Glyph{'7', 4, "064610"},
    Glyph{'8', 4, "103041051636450110"},
    Glyph{'9', 4, "430306464000"},
    Glyph{'A', 4, "002640 1232"},
    Glyph{'B', 4, "00063645443342413000 0333"},
    Glyph{'C', 4, "4536160501103041"},
    Glyph{'D', 5, "000626532000"},
    Glyph{'E', 4, "46060040 0333"},
    Glyph{'F', 4, "460600 0333"},
    Glyph{'G', 4, "45361605011030414323"},
    Glyph{'H', 4, "0006 4046 0343"},
    Glyph{'I', 2, "0020 1016 0626"},
    Glyph{'J', 4, "0110304146"},
    Glyph{'K', 4, "0006 460340"},
    Glyph{'L', 4, "060040"},
    Glyph{'M', 4, "0006234640"},
    Glyph{'N', 4, "00064046"},
    Glyph{'O', 6, "204062644626040220"},
    Glyph{'P', 4, "00063645443303"},
    Glyph{'Q', 6, "204062644626040220 4260"},
    Glyph{'R', 4, "00063645443303 2340"},
    Glyph{'S', 4, "453616050413334241301001"},
    Glyph{'T', 4, "0646 2026"},
    Glyph{'U', 4, "060110304146"},
    Glyph{'V', 4, "062046"},
    Glyph{'W', 4, "0610243046"},
    Glyph{'X', 4, "0046 0640"},
    Glyph{'Y', 4, "062346 2320"},
    Glyph{'Z', 4, "06460040 0343"},
    Glyph{'.', 0, "0001"},
    Glyph{'-', 3, "0333"},
    Glyph{'+', 4, "0343 2125"},
    Glyph{'/', 4, "0046"},
    Glyph{':', 0, "0001 0405"},
    Glyph{'(', 1, "16050110"},
    Glyph{')', 1, "06151100"},
    Glyph{'#', 4, "1016 3036 0242 0444"},
    Glyph{'<', 5, "53033623"},
    Glyph{'>', 5, "03532623"},
    Glyph{' ', 2, ""},
};

// What the font doesn't know is drawn as a box.
constexpr Glyph kUnknown{'?', 4, "0006464000"};

const Glyph& glyph_of(char letter) {
    const char upper =
        letter >= 'a' && letter <= 'z' ? static_cast<char>(letter - 'a' + 'A') : letter;
    for (const Glyph& glyph : kGlyphs) {
        if (glyph.letter == upper) {
            return glyph;
        }
    }
    return kUnknown;
}

}  // namespace

std::span<const Glyph> font() {
    return kGlyphs;
}

std::vector<Polyline> glyph_strokes(const Glyph& glyph) {
    std::vector<Polyline> strokes;
    bool open = false;
    for (std::size_t i = 0; i < glyph.strokes.size();) {
        if (glyph.strokes[i] == ' ') {
            open = false;
            ++i;
            continue;
        }
        if (!open) {
            strokes.emplace_back();
            open = true;
        }
        strokes.back().emplace_back(glyph.strokes[i] - '0', glyph.strokes[i + 1] - '0');
        i += 2;
    }
    return strokes;
}

std::vector<Polyline> text_strokes(std::string_view text) {
    std::vector<Polyline> strokes;
    int x = 0;
    for (const char letter : text) {
        const Glyph& glyph = glyph_of(letter);
        for (Polyline& stroke : glyph_strokes(glyph)) {
            for (Vector2d& point : stroke) {
                point = Vector2d(point.x() + x, point.y()) / kCapital;
            }
            strokes.push_back(std::move(stroke));
        }
        x += glyph.width + kGap;
    }
    return strokes;
}

double text_width(std::string_view text) {
    int x = text.empty() ? 0 : -kGap;
    for (const char letter : text) {
        x += glyph_of(letter).width + kGap;
    }
    return static_cast<double>(x) / kCapital;
}

std::vector<Polyline> mark_strokes(const Mark& mark) {
    std::vector<Polyline> strokes = text_strokes(mark.text);
    const double angle = mark.angle_deg * std::numbers::pi / 180.0;
    const Vector2d x(std::cos(angle), std::sin(angle));
    const Vector2d y(-x.y(), x.x());
    for (Polyline& stroke : strokes) {
        for (Vector2d& point : stroke) {
            point = mark.at + mark.height_mm * (point.x() * x + point.y() * y);
        }
    }
    return strokes;
}

}  // namespace leafcutter::fab
