#include <string>

#include <gtest/gtest.h>

#include "fab/strips/labels.h"

namespace leafcutter::fab {
namespace {

constexpr std::string_view kAlphabet = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZ.-+/:()#<>";

TEST(TextStrokes, DrawsEveryLetterInsideItsBox) {
    for (const char letter : kAlphabet) {
        const std::string text(1, letter);
        const auto strokes = text_strokes(text);
        ASSERT_FALSE(strokes.empty()) << letter;
        for (const Polyline& stroke : strokes) {
            EXPECT_GE(stroke.size(), 2U) << letter;
            for (const auto& point : stroke) {
                EXPECT_GE(point.x(), 0.0);
                EXPECT_LE(point.x(), text_width(text) + 1e-12) << letter;
                EXPECT_GE(point.y(), 0.0);
                EXPECT_LE(point.y(), 1.0);
            }
        }
    }
}

TEST(TextStrokes, DrawsEveryLetterDifferently) {
    for (std::size_t i = 0; i < kAlphabet.size(); ++i) {
        for (std::size_t j = 0; j < i; ++j) {
            EXPECT_NE(text_strokes(kAlphabet.substr(i, 1)), text_strokes(kAlphabet.substr(j, 1)))
                << kAlphabet[i] << kAlphabet[j];
        }
    }
}

TEST(TextStrokes, DrawsLowerCaseAsUpper) {
    EXPECT_EQ(text_strokes("w12.1"), text_strokes("W12.1"));
}

TEST(TextStrokes, DrawsNoLineTwice) {
    for (const char letter : kAlphabet) {
        std::vector<std::pair<Eigen::Vector2d, Eigen::Vector2d>> lines;
        for (const Polyline& stroke : text_strokes(std::string(1, letter))) {
            for (std::size_t i = 0; i + 1 < stroke.size(); ++i) {
                for (const auto& [from, to] : lines) {
                    EXPECT_FALSE((from == stroke[i] && to == stroke[i + 1]) ||
                                 (to == stroke[i] && from == stroke[i + 1]))
                        << letter;
                }
                lines.emplace_back(stroke[i], stroke[i + 1]);
            }
        }
    }
}

TEST(MarkStrokes, ScalesTurnsAndMovesText) {
    Mark mark;
    mark.text = "L";
    mark.at = {5.0, 7.0};
    mark.angle_deg = 90.0;
    mark.height_mm = 3.0;
    const auto strokes = mark_strokes(mark);
    ASSERT_EQ(strokes.size(), 1U);
    EXPECT_NEAR(strokes[0][0].x(), 2.0, 1e-12);  // Top of the stem: 3 mm up, turned left.
    EXPECT_NEAR(strokes[0][0].y(), 7.0, 1e-12);
    EXPECT_NEAR(strokes[0][1].x(), 5.0, 1e-12);
    EXPECT_NEAR(strokes[0][2].y(), 9.0, 1e-12);
}

}  // namespace
}  // namespace leafcutter::fab
