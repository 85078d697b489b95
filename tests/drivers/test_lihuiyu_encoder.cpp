// From G-code to the bytes of a Lihuiyu board, and back.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
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

// A random program: places in steps, about half of the moves burning, three speeds.
std::vector<CutMove> random_moves(unsigned seed) {
    std::mt19937 random(seed);
    const auto pick = [&random](int low, int high) {
        return std::uniform_int_distribution<int>(low, high)(random);
    };
    constexpr std::array<double, 3> kSpeeds{12.5, 20.0, 133.0};
    std::vector<CutMove> moves;
    double x = 6000.0;
    double y = -4000.0;
    for (int i = 0; i < 60; ++i) {
        const int reach =
            std::array<int, 4>{3, 40, 300, 5000}[static_cast<std::size_t>(pick(0, 3))];
        x = std::clamp(x + pick(-reach, reach), 0.0, 12000.0);
        y = std::clamp(y + pick(-reach, reach), -8000.0, 0.0);
        moves.push_back({x, y, pick(0, 1) == 1, kSpeeds[static_cast<std::size_t>(pick(0, 2))], 0});
    }
    return moves;
}

double distance_to_line(const StepPlace& a, const StepPlace& b, double x, double y) {
    const double dx = static_cast<double>(b.x - a.x);
    const double dy = static_cast<double>(b.y - a.y);
    const double px = x - static_cast<double>(a.x);
    const double py = y - static_cast<double>(a.y);
    const double along =
        std::clamp((px * dx + py * dy) / std::max(dx * dx + dy * dy, 1e-9), 0.0, 1.0);
    return std::hypot(px - along * dx, py - along * dy);
}

// Takes the pieces of one burning move from the front: they lead to its end, at its speed, within
// half a step of its line, the beam on all the way.
void expect_drawn(const std::vector<Drawn>& drawn,
                  std::size_t& next,
                  const StepPlace& from,
                  const CutMove& move) {
    const StepPlace to = to_steps(bed_in_steps(), move.x_mm, move.y_mm);
    StepPlace at = from;
    while (!(at == to)) {
        ASSERT_LT(next, drawn.size());
        const Drawn& piece = drawn[next++];
        ASSERT_TRUE(piece.beam);
        ASSERT_TRUE(piece.from == at);
        EXPECT_NEAR(piece.speed, move.speed_mm_per_s, 0.01 * move.speed_mm_per_s);
        EXPECT_LE(distance_to_line(from, to, static_cast<double>(piece.to.x),
                                   static_cast<double>(piece.to.y)),
                  0.5 + 1e-9);
        at = piece.to;
    }
}

TEST(LihuiyuEncoder, DecodesToTheSegmentsItWasMadeOf) {
    for (unsigned seed = 1; seed <= 200; ++seed) {
        EncoderOptions options = in_steps();
        options.longest_burn_s = seed % 2 == 0 ? 0.5 : 0.02;
        const std::vector<CutMove> moves = random_moves(seed);
        // Runs that go on from one move into the next are one: cut them where the moves end.
        std::vector<Drawn> drawn;
        for (const Drawn& piece : decode(encode_job(moves, {}, options).stream())) {
            const long steps = std::max(std::labs(piece.to.x - piece.from.x),
                                        std::labs(piece.to.y - piece.from.y));
            StepPlace at = piece.from;
            for (long i = 1; i <= steps && piece.beam; ++i) {
                const StepPlace to{piece.from.x + (piece.to.x - piece.from.x) * i / steps,
                                   piece.from.y + (piece.to.y - piece.from.y) * i / steps};
                drawn.push_back({at, to, true, piece.speed});
                at = to;
            }
        }
        std::size_t next = 0;
        StepPlace at;
        for (const CutMove& move : moves) {
            if (move.beam) {
                ASSERT_NO_FATAL_FAILURE(expect_drawn(drawn, next, at, move)) << "seed " << seed;
            }
            at = to_steps(bed_in_steps(), move.x_mm, move.y_mm);
        }
        EXPECT_EQ(next, drawn.size()) << "seed " << seed;
    }
}

TEST(LihuiyuEncoder, EndsAtTheLastPlaceWhateverComesBefore) {
    for (unsigned seed = 1; seed <= 100; ++seed) {
        const std::vector<CutMove> moves = random_moves(seed);
        const EncodedJob job = encode_job(moves, {77, 11}, in_steps());
        const StepPlace end = to_steps(bed_in_steps(), moves.back().x_mm, moves.back().y_mm);
        EXPECT_TRUE(job.packets.back().end == end);
        LihuiyuInterpreter interpreter;
        StepPlace at{77, 11};
        for (const char byte : job.stream()) {
            for (const BoardAction& action : interpreter.take(byte)) {
                at.x += action.dx;
                at.y += action.dy;
            }
        }
        EXPECT_TRUE(at == end) << "seed " << seed;
    }
}

TEST(LihuiyuEncoder, FillsEveryPacketWithoutAPadInsideTheProgram) {
    for (unsigned seed = 1; seed <= 100; ++seed) {
        const EncodedJob job = encode_job(random_moves(seed), {}, in_steps());
        const std::string stream = job.stream();
        EXPECT_EQ(stream.find('F'), stream.rfind("FNSE"));
        EXPECT_NE(stream.back(), 'E');  // An M3 forgets a program that fills its last packet.
    }
}

TEST(LihuiyuEncoder, AddsAPacketWhereAProgramWouldFillTheLast) {
    bool seen = false;
    for (int steps = 1; steps < 2000; steps += 7) {
        const std::string stream = encoded({{1.0 * steps, 0, true, 20, 0}, {0, 0, true, 20, 0}});
        ASSERT_EQ(stream.size() % kPayloadBytes, 0U);
        ASSERT_EQ(stream.back(), 'F');
        seen =
            seen || stream.substr(stream.size() - kPayloadBytes) == std::string(kPayloadBytes, 'F');
    }
    for (unsigned seed = 1; seed <= 300; ++seed) {
        const std::string stream = encode_job(random_moves(seed), {}, in_steps()).stream();
        seen =
            seen || stream.substr(stream.size() - kPayloadBytes) == std::string(kPayloadBytes, 'F');
    }
    EXPECT_TRUE(seen);
}

TEST(CutMoves, FollowArcsWithinHalfAStep) {
    const auto moves = read_cut_moves(
        "M4\nG0 X30 Y20\nG3 X10 Y20 I-10 J0 S5 F600\nG2 X30 Y20 R10\nG91\nG1 X1 Y0\n");
    double worst = 0.0;
    for (std::size_t i = 1; i + 1 < moves.size(); ++i) {
        EXPECT_TRUE(moves[i].beam);
        EXPECT_DOUBLE_EQ(moves[i].speed_mm_per_s, 10.0);
        const double mx = (moves[i].x_mm + moves[i - 1].x_mm) / 2.0;
        const double my = (moves[i].y_mm + moves[i - 1].y_mm) / 2.0;
        worst = std::max(worst, std::abs(std::hypot(mx - 20.0, my - 20.0) - 10.0));
    }
    EXPECT_LE(worst, 0.0127 + 1e-9);
    EXPECT_GT(worst, 0.005);
    EXPECT_NEAR(moves.back().x_mm, 31.0, 1e-12);
    EXPECT_NEAR(moves.back().y_mm, 20.0, 1e-12);
}

TEST(CutMoves, UseInchesAndTheBeamOnlyWithPower) {
    const auto moves = read_cut_moves("G20\nM3 S10\nG0 X1\nG1 X2 F60\nG1 X3 S0\nM5\nG1 X4\n");
    ASSERT_EQ(moves.size(), 4U);
    EXPECT_DOUBLE_EQ(moves[1].x_mm, 50.8);
    EXPECT_TRUE(moves[1].beam);
    EXPECT_DOUBLE_EQ(moves[1].speed_mm_per_s, 25.4);
    EXPECT_FALSE(moves[0].beam || moves[2].beam || moves[3].beam);
}

// As MeerK40t and K40 Whisperer write them: with line ends, "-", and the beam left to N.
constexpr std::string_view kForeignEgv =
    "Document type : LHYMICRO-GL file\n"
    "File version: 1.0.01\n"
    "Copyright: Unknown\n"
    "Creator-Software: another\n"
    "\n"
    "%0%0%0%0%\n"
    "IBzzzvRzzzvS1P\n"
    "ICV2490731016000027CNLBS1EDz139Rz139Tz139Lz139FNSE-\n";

TEST(Egv, IsReadAsOtherProgramsWriteIt) {
    const std::vector<CutMove> moves = read_egv(kForeignEgv, {}, bed_in_steps());
    ASSERT_EQ(moves.size(), 5U);
    EXPECT_FALSE(moves[0].beam);
    EXPECT_EQ(moves[0].x_mm, 787);
    EXPECT_EQ(moves[0].y_mm, -787);
    EXPECT_TRUE(moves[4].beam);
    EXPECT_NEAR(moves[4].speed_mm_per_s, 15.0, 0.01);
    EXPECT_EQ(moves[2].x_mm, 787 + 394);
    EXPECT_EQ(moves[2].y_mm, -787 - 394);
    EXPECT_EQ(moves[4].y_mm, -787);
}

TEST(Egv, IsReadBackAsItWasWritten) {
    for (unsigned seed = 1; seed <= 50; ++seed) {
        const EncodedJob job = encode_job(random_moves(seed), {}, in_steps());
        const std::string egv = write_egv(job);
        ASSERT_TRUE(is_egv(egv));
        const EncodedJob again = encode_job(read_egv(egv, {}, bed_in_steps()), {}, in_steps());
        EXPECT_DOUBLE_EQ(again.burn_mm, job.burn_mm) << "seed " << seed;
        EXPECT_TRUE(again.packets.back().end == job.packets.back().end);
    }
}

TEST(Egv, IsRefusedWhenCutShortAnywhere) {
    const std::string egv = write_egv(encode_job({{100, -50, true, 20, 0}}, {}, in_steps()));
    const std::size_t end = egv.rfind("FNSE") + 4;
    for (std::size_t cut = 0; cut < end; ++cut) {
        const std::string_view part = std::string_view(egv).substr(0, cut);
        const bool nothing_begun = cut > 0 && part.back() == '%';
        if (!nothing_begun || cut < egv.find("%0%0%0%0%") + 9) {
            EXPECT_THROW(read_egv(part, {}, bed_in_steps()), ProgramRefused) << cut;
        }
    }
}

TEST(Egv, RefusesRasterAndNoise) {
    const std::string head = "Document type : LHYMICRO-GL file\nFile version: 1\n\n%0%0%0%0%";
    for (const char* body :
         {"IV1552121G002NLBS1EDnUxTtFNSE", "ICV1752231021000191NRBS1EDB1x0FNSE", "hello",
          "ICV9992231NRBS1EBaFNSE", "INRBS1EBaFNSE", "ICV1752231021000191NRBS1EB12FNSE"}) {
        EXPECT_THROW(read_egv(head + body, {}, bed_in_steps()), ProgramRefused) << body;
    }
}

// Any bytes: the interpreter complains, and neither fails nor lights a beam outside a cut.
TEST(LihuiyuInterpreter, TakesAnyBytes) {
    std::mt19937 random(7);
    const std::string letters = "ICVNRBTLMS1EDUFP@G|abz0123456789W\n\xFF";
    for (int round = 0; round < 300; ++round) {
        LihuiyuInterpreter interpreter;
        for (int i = 0; i < 300; ++i) {
            const char byte = letters[random() % letters.size()];
            for (const BoardAction& action : interpreter.take(byte)) {
                EXPECT_FALSE(action.beam && action.kind != BoardAction::Kind::Cut);
            }
        }
    }
}

TEST(LihuiyuInterpreter, ReportsWhatACarefulProgramNeverSends) {
    const auto complaint = [](std::string_view stream) {
        LihuiyuInterpreter interpreter;
        for (const char byte : stream) {
            for (const BoardAction& action : interpreter.take(byte)) {
                if (action.kind == BoardAction::Kind::Violation) {
                    return action.text;
                }
            }
        }
        return std::string();
    };
    const std::string cut = "ICV1752231021000191NRBS1E";
    EXPECT_EQ(complaint(cut + "DBaUFNSEFFF"), "");
    EXPECT_THAT(complaint(cut + "DBaFNSE"), HasSubstr("beam is still on"));
    EXPECT_THAT(complaint(cut + "BaX"), HasSubstr("'X'"));
    EXPECT_THAT(complaint(cut + "B12U"), HasSubstr("three digits"));
    EXPECT_THAT(complaint(cut + "B999"), HasSubstr("above 255"));
    EXPECT_THAT(complaint("IDS1P"), HasSubstr("lit outside"));
    EXPECT_THAT(complaint("INRBS1E"), HasSubstr("without a speed"));
    EXPECT_THAT(complaint("IV1752231NRBS1E"), HasSubstr("raster"));
    EXPECT_THAT(complaint("Ba"), HasSubstr("outside a program"));
    EXPECT_THAT(complaint(cut + "DI"), HasSubstr("middle of a cut"));
}

}  // namespace
}  // namespace leafcutter::drivers
