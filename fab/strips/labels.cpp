#include "fab/strips/labels.h"

#include <array>
#include <cmath>
#include <numbers>

namespace leafcutter::fab {

namespace {

using Eigen::Vector2d;

// Our own font, on a grid: x from 0, y from 0 (base line) to kCapital. A stroke is a run of points
// written "xy", strokes are parted by blanks. No stroke lies on another: a laser burns each line
// once.
struct Glyph {
    char letter;
    int width;
    std::string_view strokes;
};

constexpr int kCapital = 6;
constexpr int kGap = 2;  // Between glyphs.

constexpr std::array kGlyphs = {
    Glyph{'0', 4, "103041453616050110 1234"},
    Glyph{'1', 2, "051610 0020"},
    Glyph{'2', 4, "05163645440040"},
    Glyph{'3', 4, "0516364544334241301001 1333"},
    Glyph{'4', 4, "30360242"},
    Glyph{'5', 4, "460603334241301001"},
    Glyph{'6', 4, "4536160501103041423303"},
    Glyph{'7', 4, "064610"},
    Glyph{'8', 4, "130405163645443313 1302011030414233"},
    Glyph{'9', 4, "0110304145361605041343"},
    Glyph{'A', 4, "002640 1232"},
    Glyph{'B', 4, "00063645443342413000 0333"},
    Glyph{'C', 4, "4536160501103041"},
    Glyph{'D', 4, "00062644422000"},
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
    Glyph{'O', 4, "103041453616050110"},
    Glyph{'P', 4, "00063645443303"},
    Glyph{'Q', 4, "103041453616050110 2240"},
    Glyph{'R', 4, "00063645443303 2340"},
    Glyph{'S', 4, "453616050413334241301001"},
    Glyph{'T', 4, "0646 2026"},
    Glyph{'U', 4, "060110304146"},
    Glyph{'V', 4, "062046"},
    Glyph{'W', 4, "0610243046"},
    Glyph{'X', 4, "0046 0640"},
    Glyph{'Y', 4, "062346 2320"},
    Glyph{'Z', 4, "06460040"},
    Glyph{'.', 0, "0001"},
    Glyph{'-', 3, "0333"},
    Glyph{'+', 4, "0343 2125"},
    Glyph{'/', 4, "0046"},
    Glyph{':', 0, "0001 0405"},
    Glyph{'(', 1, "16050110"},
    Glyph{')', 1, "06151100"},
    Glyph{'#', 4, "1016 3036 0242 0444"},
    Glyph{'<', 3, "350331"},
    Glyph{'>', 3, "053301"},
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

void add_strokes(const Glyph& glyph, int x, std::vector<Polyline>& strokes) {
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
        strokes.back().emplace_back(static_cast<double>(x + glyph.strokes[i] - '0') / kCapital,
                                    static_cast<double>(glyph.strokes[i + 1] - '0') / kCapital);
        i += 2;
    }
}

}  // namespace

std::vector<Polyline> text_strokes(std::string_view text) {
    std::vector<Polyline> strokes;
    int x = 0;
    for (const char letter : text) {
        const Glyph& glyph = glyph_of(letter);
        add_strokes(glyph, x, strokes);
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
