#include <gtest/gtest.h>

#include "server/queue/spread.h"

namespace leafcutter::server {
namespace {

SheetRecord sheet(int number, double seconds, double width_mm = 100.0) {
    SheetRecord record;
    record.number = number;
    record.estimated_s = seconds;
    record.size_mm = {width_mm, 100.0};
    return record;
}

TEST(Spread, TheLongestSheetsGoFirstToWhoeverIsFree) {
    const auto wishes = spread_sheets({sheet(1, 10), sheet(2, 30), sheet(3, 20)},
                                      {{"a", {600, 400}, 0}, {"b", {600, 400}, 0}});
    ASSERT_EQ(wishes.size(), 2U);
    EXPECT_EQ(wishes[0].sheets, (std::vector<int>{2}));
    EXPECT_EQ(wishes[1].sheets, (std::vector<int>{1, 3}));
}

TEST(Spread, ABusyMachineGetsLessAndAnIdleOneMore) {
    const auto wishes = spread_sheets({sheet(1, 10), sheet(2, 10)},
                                      {{"busy", {600, 400}, 100}, {"idle", {600, 400}, 0}});
    ASSERT_EQ(wishes.size(), 1U);
    EXPECT_EQ(wishes[0].device, "idle");
}

TEST(Spread, ALargeSheetGoesOnlyWhereItFits) {
    const std::vector<CutPlace> places{{"small", {200, 200}, 0}, {"large", {600, 400}, 500}};
    const auto wishes = spread_sheets({sheet(1, 10, 500)}, places);
    ASSERT_EQ(wishes.size(), 1U);
    EXPECT_EQ(wishes[0].device, "large");
    EXPECT_THROW(spread_sheets({sheet(1, 10, 700)}, places), NotCuttable);
}

}  // namespace
}  // namespace leafcutter::server
