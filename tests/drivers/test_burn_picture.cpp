#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drivers/sim/burn_picture.h"

namespace leafcutter::drivers {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

BurntPiece piece(double x0, double y0, double x1, double y1, double s) {
    BurntPiece piece;
    piece.x0_mm = x0;
    piece.y0_mm = y0;
    piece.x1_mm = x1;
    piece.y1_mm = y1;
    piece.s = s;
    return piece;
}

TEST(BurnPicture, HasALayerForEachPowerAndThinTravel) {
    const std::vector<BurntPiece> burnt{piece(0, 0, 10, 0, 100), piece(10, 0, 10, 5, 100),
                                        piece(20, 5, 30, 5, 800)};
    const std::string svg = burn_svg(burnt);
    EXPECT_THAT(svg, HasSubstr("width=\"36.000mm\" height=\"11.000mm\""));
    EXPECT_THAT(svg, HasSubstr("inkscape:label=\"S 100\""));
    EXPECT_THAT(svg, HasSubstr("inkscape:label=\"S 800\""));
    // From the second piece to the third alone: the first two meet.
    EXPECT_THAT(svg, HasSubstr("<path d=\"M10.000 5.000L20.000 5.000\"/>"));
    EXPECT_LT(svg.find("S 100"), svg.find("S 800"));
}

// Width and height of a PNG file.
std::array<std::size_t, 2> size_of(const std::string& png) {
    const auto number = [&](std::size_t at) {
        std::size_t value = 0;
        for (std::size_t i = 0; i < 4; ++i) {
            value = value * 256 + static_cast<unsigned char>(png[at + i]);
        }
        return value;
    };
    return {number(16), number(20)};
}

TEST(BurnPicture, IsAPngOfTheSizeAskedFor) {
    const std::vector<BurntPiece> burnt{piece(0, 0, 94, 0, 100), piece(0, 0, 0, 44, 200)};
    const std::string png = burn_png(burnt, 500);
    EXPECT_THAT(png, StartsWith("\x89PNG\r\n\x1a\n"));
    EXPECT_EQ(size_of(png), (std::array<std::size_t, 2>{500, 250}));
    EXPECT_NE(burn_png(burnt, 500), burn_png({burnt.data(), 1}, 500));
    EXPECT_EQ(size_of(burn_png({}, 16)), (std::array<std::size_t, 2>{16, 16}));
    EXPECT_THROW(burn_png(burnt, 15), std::invalid_argument);
    EXPECT_THROW(burn_png(burnt, 20000), std::invalid_argument);
}

}  // namespace
}  // namespace leafcutter::drivers
