#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "fab/strips/mark_room.h"

namespace leafcutter::fab {
namespace {

using Eigen::Vector2d;

Polyline sampled(const MarkShape& shape) {
    Polyline points;
    const Polyline contour = shape.contour();
    for (std::size_t i = 0; i + 1 < contour.size(); ++i) {
        for (int k = 0; k <= 200; ++k) {
            points.emplace_back(contour[i] + k / 200.0 * (contour[i + 1] - contour[i]));
        }
    }
    return points;
}

double distance(const MarkShape& one, const MarkShape& other) {
    double least = 1e9;
    for (const Vector2d& p : sampled(one)) {
        for (const Vector2d& q : sampled(other)) {
            least = std::min(least, (p - q).norm());
        }
    }
    return least;
}

// Apart only if really so far apart; and always if half as far again.
TEST(AreApart, AgreesWithDistancesOfSampledPoints) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    const auto shape = [&](bool box) {
        const Vector2d middle(4.0 * uniform(random), 4.0 * uniform(random));
        const double angle = 3.0 * uniform(random);
        const Vector2d along(std::cos(angle), std::sin(angle));
        return box ? MarkShape::box(middle, along, {1.5, 0.6}) : MarkShape(middle, middle + along);
    };
    int apart = 0;
    for (int i = 0; i < 60; ++i) {
        const MarkShape one = shape(i % 2 == 0);
        const MarkShape other = shape(i % 3 == 0);
        const double gap = distance(one, other);
        if (are_apart(one, other, 0.3)) {
            ++apart;
            EXPECT_GT(gap, 0.3) << i;
        } else {
            EXPECT_LT(gap, 0.45) << i;
        }
        EXPECT_EQ(are_apart(one, other, 0.3), are_apart(other, one, 0.3)) << i;
    }
    EXPECT_GT(apart, 10);
    EXPECT_LT(apart, 55);
}

TEST(AreApart, SeesLinesOnOneAnotherAndBoxesInBoxes) {
    EXPECT_FALSE(are_apart({{0, 0}, {2, 0}}, {{1, 0}, {3, 0}}, 0.0));
    EXPECT_TRUE(are_apart({{0, 0}, {2, 0}}, {{2.5, 0}, {3, 0}}, 0.4));
    EXPECT_FALSE(are_apart(MarkShape::box({0, 0}, {1, 0}, {5, 5}), {{-1, 0}, {1, 0}}, 0.0));
}

TEST(MarkRoom, IsFreeInsideTheOutlineAwayFromWhatIsTaken) {
    Piece piece;
    piece.outline = {{0, 0}, {20, 0}, {20, 10}, {0, 10}};
    piece.cuts = {{{5, 2}, {5, 8}}};
    MarkRoom room(piece);
    const MarkShape line({10, 2}, {10, 8});
    EXPECT_TRUE(room.is_free(line, 0.5));
    EXPECT_FALSE(room.is_free({{4, 5}, {6, 5}}, 0.1)) << "over a slit";
    EXPECT_FALSE(room.is_free({{19, 5}, {21, 5}}, 0.1)) << "over the edge";
    EXPECT_TRUE(room.is_clear({{19, 5}, {21, 5}}, 0.1));
    EXPECT_FALSE(room.is_free(MarkShape::box({10, 5}, {1, 0}, {30, 30}), 0.0)) << "about it all";
    const std::size_t before = room.taken();
    room.take(line, 3);
    EXPECT_FALSE(room.is_free(line, 0.5));
    EXPECT_FALSE(room.is_free(line, 0.5, 4));
    EXPECT_TRUE(room.is_free(line, 0.5, 3)) << "what the same owner took";
    room.give_back(before);
    EXPECT_TRUE(room.is_free(line, 0.5));
}

}  // namespace
}  // namespace leafcutter::fab
