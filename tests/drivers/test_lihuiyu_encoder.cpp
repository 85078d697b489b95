// From G-code to the bytes of a Lihuiyu board, and back.

#include <cmath>
#include <random>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drivers/device.h"
#include "drivers/lihuiyu/egv.h"
#include "drivers/lihuiyu/encoder.h"
#include "drivers/lihuiyu/interpreter.h"

namespace leafcutter::drivers {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

// A bed whose program coordinates are steps right of and below the home corner... in mm of one
// step.
LihuiyuBed bed_in_steps() {
    LihuiyuBed bed;
    bed.width_mm = bed.height_mm = 12000.0;
    bed.steps_per_mm = 1.0;
    bed.origin_down_mm = 0.0;
    return bed;
}

EncoderOptions in_steps() {
    EncoderOptions options;
    options.bed = bed_in_steps();
    options.longest_burn_s = 1e9;
    return options;
}

struct Drawn {
    StepPlace from;
    StepPlace to;
    bool beam = false;
    double speed = 0.0;
};

// What an interpreter that knows nothing of the encoder makes of a stream.
std::vector<Drawn> decode(std::string_view stream, const SpeedModel& model = {}) {
    LihuiyuInterpreter interpreter(model);
    std::vector<Drawn> drawn;
    StepPlace at;
    for (const char byte : stream) {
        for (const BoardAction& action : interpreter.take(byte)) {
            EXPECT_NE(action.kind, BoardAction::Kind::Violation) << action.text;
            const StepPlace to{at.x + action.dx, at.y + action.dy};
            if (!(to == at)) {
                drawn.push_back({at, to, action.beam, action.speed.mm_per_s});
            }
            at = to;
        }
    }
    EXPECT_FALSE(interpreter.in_program());
    return drawn;
}

std::string encoded(const std::vector<CutMove>& moves) {
    return encode_job(moves, {}, in_steps()).stream();
}

TEST(SpeedCode, IsThatOfOtherPrograms) {
    const auto code = [](LihuiyuBoard board, double speed) {
        return encode_speed({board, 1.0}, speed);
    };
    EXPECT_EQ(code(LihuiyuBoard::M2, 5), "CV2352371006000223C");
    EXPECT_EQ(code(LihuiyuBoard::M2, 20), "CV1752231021000191");
    EXPECT_EQ(code(LihuiyuBoard::M2, 50), "CV2112432051000031");
    EXPECT_EQ(code(LihuiyuBoard::M2, 100), "CV2212493101000007");
    EXPECT_EQ(code(LihuiyuBoard::M2, 200), "CV2252524128000003");
    EXPECT_EQ(code(LihuiyuBoard::M, 20), "CV1752231");
    EXPECT_EQ(code(LihuiyuBoard::A, 20), "CV2430041");
    EXPECT_EQ(code(LihuiyuBoard::B2, 20), "CV1321751021001126");
}

TEST(SpeedCode, DecodesToTheSpeedItWasMadeOf) {
    for (const char* name : {"A", "B", "B1", "B2", "M", "M1", "M2", "M3"}) {
        const SpeedModel model{parse_lihuiyu_board(name), 0.92};
        for (double speed = 10.0; speed <= 240.0; speed *= 1.07) {
            const auto decoded = decode_speed(model, encode_speed(model, speed));
            ASSERT_TRUE(decoded) << name << " at " << speed;
            EXPECT_NEAR(decoded->mm_per_s, speed, 0.01 * speed * (1.0 + speed / 30.0)) << name;
        }
    }
}

TEST(SpeedCode, RefusesSpeedsThatTheBoardHasNoCodeFor) {
    EXPECT_THROW(encode_speed({LihuiyuBoard::B2, 1.0}, 8.0), std::invalid_argument);
    EXPECT_THROW(encode_speed({LihuiyuBoard::M, 1.0}, 4.0), std::invalid_argument);
    EXPECT_THROW(encode_speed({LihuiyuBoard::M2, 1.0}, 0.0), std::invalid_argument);
    EXPECT_THROW(encode_speed({LihuiyuBoard::M2, 1.0}, 241.0), std::invalid_argument);
    EXPECT_NO_THROW(encode_speed({LihuiyuBoard::B2, 1.0}, 9.52));
    EXPECT_NO_THROW(encode_speed({LihuiyuBoard::M2, 1.0}, 0.5));
}

TEST(SpeedCode, ReadsNoOtherText) {
    for (const char* text : {"", "C", "CV", "V175223", "CV17522310210001910", "CV2562231",
                             "CV1752560", "CV1752235", "V1752231G002", "CV1752231X"}) {
        EXPECT_FALSE(decode_speed({}, text)) << text;
    }
}

TEST(LihuiyuPacket, HasTheChecksumOfOtherPrograms) {
    EXPECT_EQ(crc8(view(make_payload(""))), 0x50);
    EXPECT_EQ(crc8(view(make_payload("IPP"))), 0xE4);
    EXPECT_EQ(crc8(view(make_payload("IS2P"))), 0x0F);
    EXPECT_EQ(crc8(view(make_payload("I"))), 0x82);
}

TEST(LihuiyuPacket, IsWrittenInTwoGroups) {
    const std::string bytes = wire_bytes(make_payload("IPP"));
    ASSERT_EQ(bytes.size(), kWirePacketBytes);
    EXPECT_EQ(bytes.substr(0, 6), std::string("\xA6\0IPPF", 6));
    EXPECT_EQ(bytes.substr(kFirstTransferBytes), "\xA6\xE4");
}

TEST(LihuiyuDistance, AddsUpToItselfWhateverItsLength) {
    EXPECT_EQ(encode_distance(1), "a");
    EXPECT_EQ(encode_distance(25), "y");
    EXPECT_EQ(encode_distance(26), "|a");
    EXPECT_EQ(encode_distance(51), "|z");
    EXPECT_EQ(encode_distance(52), "052");
    EXPECT_EQ(encode_distance(255), "z");
    EXPECT_EQ(encode_distance(511), "zza");
    for (long steps = 1; steps < 1500; ++steps) {
        const auto drawn = decode("IB" + encode_distance(steps) + "S1P");
        ASSERT_EQ(drawn.size(), 1U) << steps;
        EXPECT_EQ(drawn[0].to.x, steps);
    }
}

TEST(LihuiyuEncoder, WritesTheSquareByteForByte) {
    const std::vector<CutMove> square{{787, -787, false, 0, 0},
                                      {1181, -787, true, 20, 0},
                                      {1181, -1181, true, 20, 0},
                                      {787, -1181, true, 20, 0},
                                      {787, -787, true, 20, 0}};
    EXPECT_EQ(encoded(square),
              "ICV1752231021000191BzzzvRzzzvN"
              "RBS1EDBz139Rz139Tz139Lz139UFNS"
              "EFFFFFFFFFFFFFFFFFFFFFFFFFFFFF");
}

TEST(LihuiyuEncoder, WritesSlopesAsStraightAndDiagonalRuns) {
    // One right for two down: diagonal, straight, diagonal, … to the right and down, then mirrored.
    EXPECT_EQ(encoded({{4, -8, true, 20, 0}, {1, -6, true, 20, 0}}),
              "ICV1752231021000191NRBS1EDMaUU"
              "DRaMaRaMaRaMaRaTLMaTaMaUFNSEFF");
}

TEST(LihuiyuEncoder, BeginsANewSectionForAnotherSpeedAndForAFarPlace) {
    const std::vector<CutMove> moves{{100, 0, true, 20, 0},
                                     {100, -100, true, 50, 0},
                                     {500, -100, false, 0, 0},
                                     {600, -100, true, 50, 0}};
    EXPECT_EQ(encoded(moves),
              "ICV1752231021000191NRBS1EUUUUU"
              "DB100U@NSECV2112432051000031NR"
              "BS1EDR100U@NSECV21124320510000"
              "31Bz145NRBS1EDB100UFNSEFFFFFFF");
}

TEST(LihuiyuEncoder, CrossesSmallGapsWithoutARapidMove) {
    const std::string stream =
        encoded({{100, 0, true, 20, 0}, {160, 0, false, 0, 0}, {200, 0, true, 20, 0}});
    EXPECT_THAT(stream, HasSubstr("DB100UB060DB|oU"));
}

}  // namespace
}  // namespace leafcutter::drivers
