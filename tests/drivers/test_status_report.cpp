#include <gtest/gtest.h>

#include "drivers/grbl/status_report.h"

namespace leafcutter::drivers {
namespace {

TEST(StatusReport, ReadsEveryFieldInAnyOrder) {
    const auto report = parse_status_report(
        "<Hold:1|FS:186,300|Ov:90,50,110|Bf:14,100|WCO:1.000,2.000,0.000|MPos:5.024,-3.500,0.000|"
        "Pn:XY>");
    ASSERT_TRUE(report);
    EXPECT_EQ(report->state, MachineState::Hold);
    EXPECT_EQ(report->sub_state, 1);
    EXPECT_EQ((*report->machine_position)[0], 5.024);
    EXPECT_EQ((*report->machine_position)[1], -3.5);
    EXPECT_EQ((*report->work_offset)[1], 2.0);
    EXPECT_EQ((*report->free_buffers)[0], 14);
    EXPECT_EQ((*report->free_buffers)[1], 100);
    EXPECT_EQ(report->feed, 186.0);
    EXPECT_EQ(report->power_s, 300.0);
    EXPECT_EQ((*report->override_percent)[2], 110);
    EXPECT_FALSE(report->work_position);
}

TEST(StatusReport, SkipsWhatItDoesNotKnow) {
    const auto report = parse_status_report("<Tool|WPos:1,2,3,4,5|FW:grblHAL|SD:1.2,x|H:1|F:100>");
    ASSERT_TRUE(report);
    EXPECT_EQ(report->state, MachineState::Unknown);
    EXPECT_EQ((*report->work_position)[2], 3.0);
    EXPECT_EQ(report->feed, 100.0);
    EXPECT_FALSE(report->power_s);
}

TEST(StatusReport, RefusesBrokenNumbersAndOtherLines) {
    for (const char* line : {"", "<>", "ok", "<Idle|MPos:1.0,x,0>", "<Idle|FS:1>", "<Idle|Bf:15>",
                             "<Idle|MPos:nan,0,0>", "<Idle|MPos:0,0,0", "<Idle|Ov:1,2>"}) {
        EXPECT_FALSE(parse_status_report(line)) << line;
    }
}

TEST(StatusReport, NeverReadsATruncatedReportWrongly) {
    const std::string whole = "<Run|MPos:12.345,6.789,0.000|FS:1500,250|WCO:0.000,0.000,0.000>";
    for (std::size_t length = 0; length < whole.size(); ++length) {
        EXPECT_FALSE(parse_status_report(whole.substr(0, length))) << length;
    }
    EXPECT_TRUE(parse_status_report(whole));
}

}  // namespace
}  // namespace leafcutter::drivers
