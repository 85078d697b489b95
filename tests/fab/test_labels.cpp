#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "fab/strips/labels.h"

namespace leafcutter::fab {
namespace {

constexpr std::string_view kAlphabet = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZ.-+/:()#<>";

constexpr std::string_view kOfIds = "0123456789WP.+>";

const Glyph& glyph(char letter) {
    const auto found = std::find_if(font().begin(), font().end(),
                                    [&](const Glyph& one) { return one.letter == letter; });
    EXPECT_NE(found, font().end());
    return *found;
}

// Points along a glyph's strokes, an eighth of a grid step apart, its box's centre at the origin.
Polyline sampled(const Glyph& glyph, const Eigen::Vector2d& flip) {
    Polyline points;
    Eigen::AlignedBox2d box;
    for (const Polyline& stroke : glyph_strokes(glyph)) {
        for (std::size_t i = 0; i + 1 < stroke.size(); ++i) {
            const int steps = 1 + static_cast<int>(8.0 * (stroke[i + 1] - stroke[i]).norm());
            for (int k = 0; k <= steps; ++k) {
                const double part = static_cast<double>(k) / steps;
                points.emplace_back(stroke[i] + part * (stroke[i + 1] - stroke[i]));
                box.extend(points.back());
            }
        }
    }
    const Eigen::Vector2d centre = box.center();
    for (Eigen::Vector2d& point : points) {
        point = (point - centre).cwiseProduct(flip);
    }
    return points;
}

// How far the worst point of `one` lies from `other` moved by `shift`.
double farthest(const Polyline& one, const Polyline& other, const Eigen::Vector2d& shift) {
    double worst = 0.0;
    for (const Eigen::Vector2d& p : one) {
        double nearest = std::numeric_limits<double>::infinity();
        for (const Eigen::Vector2d& q : other) {
            nearest = std::min(nearest, (p - q - shift).squaredNorm());
        }
        worst = std::max(worst, nearest);
    }
    return std::sqrt(worst);
}

double difference(const Polyline& one, const Polyline& other) {
    double least = std::numeric_limits<double>::infinity();
    for (const double x : {-1.0, -0.5, 0.0, 0.5, 1.0}) {
        for (const double y : {-1.0, -0.5, 0.0, 0.5, 1.0}) {
            const Eigen::Vector2d shift(x, y);
            least = std::min(least,
                             std::max(farthest(one, other, shift), farthest(other, one, -shift)));
        }
    }
    return least;
}

TEST(Font, TellsGlyphsOfIdsApartTurnedAndMirrored) {
    const std::array<Eigen::Vector2d, 4> flips{
        {{1.0, 1.0}, {-1.0, -1.0}, {-1.0, 1.0}, {1.0, -1.0}}};
    for (std::size_t i = 0; i < kOfIds.size(); ++i) {
        const Polyline one = sampled(glyph(kOfIds[i]), flips[0]);
        for (std::size_t j = 0; j < i; ++j) {
            for (const Eigen::Vector2d& flip : flips) {
                EXPECT_GT(difference(one, sampled(glyph(kOfIds[j]), flip)), 1.0)
                    << kOfIds[i] << " and " << kOfIds[j] << " flipped by " << flip.transpose();
            }
        }
    }
}

TEST(Font, TellsLookAlikesApart) {
    const Eigen::Vector2d upright(1.0, 1.0);
    for (const std::string_view pair : {"0O", "1I", "5S", "2Z", "8B", "WM", "69", "0D"}) {
        EXPECT_GT(difference(sampled(glyph(pair[0]), upright), sampled(glyph(pair[1]), upright)),
                  0.85)
            << pair;
    }
}

// Ids stand on every piece twice: a stroke more is a jump of the head more.
TEST(Font, DrawsWhatIdsAreMadeOfInOneStroke) {
    for (const char letter : kOfIds) {
        EXPECT_EQ(glyph_strokes(glyph(letter)).size(), letter == '+' ? 2U : 1U) << letter;
    }
}

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
