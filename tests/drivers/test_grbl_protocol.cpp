#include <random>
#include <stdexcept>

#include <gtest/gtest.h>

#include "drivers/grbl/protocol.h"

namespace leafcutter::drivers {
namespace {

using Kind = GrblEvent::Kind;

TEST(GrblProtocol, HoldsALineThatWouldOverflowTheControllerBuffer) {
    GrblProtocol protocol(/*rx_buffer_bytes=*/10);
    ASSERT_TRUE(protocol.offer("G1 X10"));  // 7 bytes with the line end.
    EXPECT_FALSE(protocol.offer("G1 Y5"));

    protocol.receive("ok\r\n");
    EXPECT_TRUE(protocol.offer("G1 Y5"));
}

TEST(GrblProtocol, JoinsAReplySplitAtAnyByte) {
    const std::string reply =
        "<Idle|MPos:0.000,0.000,0.000|FS:0,0>\r\nok\r\nerror:22\r\nALARM:2\r\n";
    for (std::size_t cut = 0; cut <= reply.size(); ++cut) {
        GrblProtocol protocol;
        auto events = protocol.receive(reply.substr(0, cut));
        for (auto& event : protocol.receive(reply.substr(cut))) {
            events.push_back(event);
        }
        ASSERT_EQ(events.size(), 4U) << "cut at " << cut;
        EXPECT_EQ(events[0].kind, Kind::Status);
        EXPECT_EQ(events[1].kind, Kind::Ack);
        EXPECT_EQ(events[2].kind, Kind::Error);
        EXPECT_EQ(events[2].code, 22);
        EXPECT_EQ(events[3].kind, Kind::Alarm);
        EXPECT_EQ(events[3].code, 2);
    }
}

TEST(GrblProtocol, CountsOnlyOkAndErrorAsAnswers) {
    for (const std::string reply :
         {"\r\nGrbl 1.1h ['$' for help]\r\n", ">G54:ok\r\n", "[MSG:ok]\r\n", "ALARM:1\r\n",
          "$0=10\r\n", "<Idle|MPos:0,0,0>\r\n", "okay\r\n", " ok\r\n", "o\x1bk\r\n"}) {
        GrblProtocol protocol;
        protocol.offer("G0X1");
        protocol.receive(reply);
        EXPECT_EQ(protocol.lines_in_flight(), 1U) << reply;
    }
}

TEST(GrblProtocol, RefusesALineThatHoldsARealTimeByteOrNeverFits) {
    GrblProtocol protocol;
    EXPECT_THROW(protocol.offer("G1X1!"), std::invalid_argument);
    EXPECT_THROW(protocol.offer("G1X1\x18"), std::invalid_argument);
    EXPECT_THROW(protocol.offer("G1X1\x84"), std::invalid_argument);
    EXPECT_THROW(protocol.offer("G1X1\nG1X2"), std::invalid_argument);
    EXPECT_THROW(protocol.offer(std::string(80, 'X')), std::invalid_argument);
    EXPECT_EQ(protocol.bytes_in_flight(), 0U);
    EXPECT_TRUE(protocol.offer(std::string(79, 'X')));
}

TEST(GrblProtocol, KeepsWithinTheBufferWhateverTheOrderOfLinesAndAnswers) {
    std::mt19937 random(7);
    GrblProtocol protocol;
    std::size_t unanswered_bytes = 0;
    std::deque<std::size_t> sizes;
    for (int turn = 0; turn < 20000; ++turn) {
        if (random() % 3 != 0) {
            const std::size_t size = 1 + random() % 79;
            if (protocol.offer(std::string(size, 'G'))) {
                sizes.push_back(size + 1);
                unanswered_bytes += size + 1;
            }
        } else if (!sizes.empty()) {
            protocol.receive(random() % 5 == 0 ? "error:20\r\n" : "ok\r\n");
            unanswered_bytes -= sizes.front();
            sizes.pop_front();
        }
        ASSERT_LE(unanswered_bytes, 127U);
        ASSERT_EQ(protocol.bytes_in_flight(), unanswered_bytes);
    }
}

TEST(GrblProtocol, SurvivesAStreamWithoutLineEnds) {
    GrblProtocol protocol;
    std::size_t bytes = 0;
    for (const GrblEvent& event : protocol.receive(std::string(100000, '\xff'))) {
        EXPECT_EQ(event.kind, Kind::Other);
        bytes += event.text.size();
    }
    EXPECT_GT(bytes, 99000U);
}

TEST(GrblProtocol, TakesAnAnswerNobodyAskedForWithoutLosingCount) {
    GrblProtocol protocol;
    protocol.receive("ok\r\nok\r\n");
    EXPECT_EQ(protocol.bytes_in_flight(), 0U);
    protocol.offer("G0X1");
    EXPECT_EQ(protocol.bytes_in_flight(), 5U);
}

}  // namespace
}  // namespace leafcutter::drivers
