// The proofs in whole numbers, against layouts made wrong on purpose and against plain geometry.

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "fab/nest/collision.h"
#include "fab/nest/exact.h"
#include "fab/nest/random.h"
#include "fab/nest/shape.h"
#include "fab/nest/simple_ring.h"
#include "geometry/error.h"

namespace leafcutter::fab {
namespace {

WholeRing square(std::int64_t x, std::int64_t y, std::int64_t side) {
    return {{x, y}, {x + side, y}, {x + side, y + side}, {x, y + side}};
}

std::vector<PlacedRing> pair(WholeRing a, WholeRing b) {
    return {{"a", std::move(a)}, {"b", std::move(b)}};
}

TEST(ExactProof, MeasuresTheDistanceOfTwoSquares) {
    EXPECT_DOUBLE_EQ(prove_apart(pair(square(0, 0, 10), square(13, 14, 5)), 0), 5.0);
    EXPECT_DOUBLE_EQ(prove_apart(pair(square(0, 0, 10), square(5'000'010, 3, 5)), 0), 5'000'000.0);
}

TEST(ExactProof, RefusesAGapThatIsOneUnitShort) {
    EXPECT_NO_THROW(prove_apart(pair(square(0, 0, 10), square(17, 0, 5)), 7));
    EXPECT_THROW(prove_apart(pair(square(0, 0, 10), square(16, 0, 5)), 7), geometry::Error);
}

TEST(ExactProof, RefusesContactOverlapAndNesting) {
    EXPECT_THROW(prove_apart(pair(square(0, 0, 10), square(10, 2, 5)), 0), geometry::Error);
    EXPECT_THROW(prove_apart(pair(square(0, 0, 10), square(9, 2, 5)), 0), geometry::Error);
    EXPECT_THROW(prove_apart(pair(square(0, 0, 10), square(2, 2, 5)), 0), geometry::Error);
    EXPECT_THROW(prove_apart(pair(square(2, 2, 5), square(0, 0, 10)), 0), geometry::Error);
    EXPECT_THROW(prove_apart(pair(square(0, 0, 10), square(0, 0, 10)), 0), geometry::Error);
}

TEST(ExactProof, HoldsPartsInsideAnOutlineAndClearOfAHole) {
    const WholeRing outline{{0, 0}, {100, 0}, {100, 100}, {50, 20}, {0, 100}};
    const std::vector<PlacedRing> inside{{"p", square(10, 5, 10)}};
    EXPECT_NO_THROW(prove_inside(inside, outline));
    const std::vector<PlacedRing> notch{{"p", square(45, 30, 10)}};
    EXPECT_THROW(prove_inside(notch, outline), geometry::Error);
    const std::vector<PlacedRing> across{{"p", square(40, 15, 20)}};
    EXPECT_THROW(prove_inside(across, outline), geometry::Error);
    EXPECT_THROW(prove_clear(inside, {"hole", square(12, 7, 2)}), geometry::Error);
    EXPECT_NO_THROW(prove_clear(inside, {"hole", square(30, 7, 2)}));
}

// Random triangles: the proof must find the distance that floating point finds.
TEST(ExactProof, AgreesWithPlainGeometryOnRandomTriangles) {
    Random random(7);
    const double unit = exact_unit(200.0);
    int apart = 0;
    for (int round = 0; round < 20'000; ++round) {
        std::vector<PlacedRing> placed;
        std::vector<Ring> rings;
        for (int i = 0; i < 2; ++i) {
            Ring ring;
            const Eigen::Vector2d at(random.between(0.0, 100.0), random.between(0.0, 100.0));
            for (int k = 0; k < 3; ++k) {
                ring.push_back(
                    at + Eigen::Vector2d(random.between(0.0, 60.0), random.between(0.0, 60.0)));
            }
            placed.push_back({"t", to_whole(ring, unit)});
            rings.push_back(std::move(ring));
        }
        PlacedOutlines outlines({200.0, 200.0});
        outlines.add(rings[0]);
        const double expected = outlines.distance(rings[1], 300.0);
        if (expected > 1e-4) {
            ++apart;
            EXPECT_NEAR(prove_apart(placed, 0) * unit, expected, 1e-5);
        } else if (expected == 0.0) {
            EXPECT_THROW(prove_apart(placed, 0), geometry::Error);
        }
    }
    EXPECT_GT(apart, 1000);
}

TEST(RingFault, NamesWhatIsWrong) {
    EXPECT_EQ(ring_fault({{0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}}), "");
    EXPECT_NE(ring_fault({{0.0, 0.0}, {1.0, 0.0}}), "");
    EXPECT_NE(ring_fault({{0.0, 0.0}, {1.0, 1.0}, {2.0, 2.0}}), "");
    EXPECT_NE(ring_fault({{0.0, 0.0}, {4.0, 0.0}, {1.0, 3.0}, {2.0, -1.0}}).find("crosses"),
              std::string::npos);
    EXPECT_NE(ring_fault({{0.0, 0.0}, {1.0, std::nan("")}, {0.0, 1.0}}), "");
}

}  // namespace
}  // namespace leafcutter::fab
