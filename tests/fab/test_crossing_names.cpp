#include <algorithm>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fab/strips/crossing_names.h"

namespace leafcutter::fab {
namespace {

using testing::ElementsAre;

TEST(NameWishes, NameTheEndsAndEveryFewCells) {
    const std::vector<int> numbers{3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
    const std::vector<char> over(numbers.size(), 0);
    EXPECT_THAT(name_wishes({numbers, over, 4}),
                ElementsAre(ElementsAre(0, 1, 2, 3), ElementsAre(12, 11, 10, 9),
                            ElementsAre(4, 5, 3), ElementsAre(8, 9, 7)));
}

TEST(NameWishes, PreferCellsThatLieUnder) {
    const std::vector<int> numbers{1, 2, 3, 4};
    const std::vector<char> under{0, 1, 0, 1};
    EXPECT_THAT(name_wishes({numbers, under, 9}),
                ElementsAre(ElementsAre(1, 3, 0, 2), ElementsAre(3, 1, 2, 0)));
}

TEST(NameWishes, NameEachRunWhereNumbersJump) {
    const std::vector<int> numbers{7, 8, 9, 1, 2, 3, 30, 29, 28, 5};
    const std::vector<char> over(numbers.size(), 0);
    const auto wishes = name_wishes({numbers, over, 6});
    for (const int first : {0, 3, 6, 9}) {
        EXPECT_TRUE(std::any_of(wishes.begin(), wishes.end(), [&](const NameWish& wish) {
            return wish.front() == first;
        })) << first;
    }
}

TEST(NameWishes, StayWithinTheirRun) {
    const std::vector<int> numbers{1, 2, 9, 8, 7, 4};
    const std::vector<char> under(numbers.size(), 1);
    for (const NameWish& wish : name_wishes({numbers, under, 4})) {
        const auto [low, high] = std::minmax_element(wish.begin(), wish.end());
        EXPECT_TRUE(*high <= 1 || (*low >= 2 && *high <= 4) || *low == 5);
    }
}

TEST(NameWishes, AreNoneWithoutCells) {
    EXPECT_TRUE(name_wishes({{}, {}, 4}).empty());
}

}  // namespace
}  // namespace leafcutter::fab
