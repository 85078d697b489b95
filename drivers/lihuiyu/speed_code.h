// Speed codes of LHYMICRO-GL for cutting: CV hhh lll a [sss ddd ddd] [C].
//
// The board counts clock ticks between two steps up to 65536: value = 65536 - (b + m T), with T the
// milliseconds per step of 1/1000 inch, hhh and lll its high and low byte in decimal. `a` chooses
// the acceleration by speed (1 to 25.4 mm/s, 2 to 60, 3 below 127, 4 above) and with it b. A
// trailing C slows the count twelve times. sss and ddd ddd slow diagonals down, so that they are as
// fast as straight lines.
//
//   boards          b at a = 1, 2 / 3 / 4     m       diagonals   trailing C
//   M, M1, M2, M3   5120 / 5632 / 6144       12120    all but M   M2, M3 below 7 mm/s, b = 8
//   B2               784 /  896 / 1024       24240    yes         below 7 mm/s
//   A, B, B1         784 /  896 / 1024        2000    B1          never
//
// Source: MeerK40t, meerk40t/lihuiyu/laserspeed.py (facts, no code); the maker's LHYMicro-GL2 paper
// of 2024-06-24 gives the same form with coarser limits for `a`. MeerK40t measured real speeds of
// 92 % of nominal; Options::slope corrects that.

#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace leafcutter::drivers {

enum class LihuiyuBoard { A, B, B1, B2, M, M1, M2, M3 };

std::string_view to_string(LihuiyuBoard board);

// Throws std::invalid_argument, naming the boards there are.
LihuiyuBoard parse_lihuiyu_board(std::string_view name);

struct SpeedModel {
    LihuiyuBoard board = LihuiyuBoard::M2;
    // Factor on m. 1 is the maker's software; 0.92 makes real speeds nominal on a measured M2.
    double slope = 1.0;
};

inline constexpr double kFastestCutMmPerS = 240.0;  // Above it the maker's software gives up.

// Throws std::invalid_argument for a speed that the board has no code for, naming the nearest.
std::string encode_speed(const SpeedModel& model, double mm_per_s);

struct DecodedSpeed {
    double mm_per_s = 0.0;
    int acceleration = 1;
    bool slows_diagonals = false;
};

// Reads "V2352371006000223C" or with a C before; nothing for what is no code of a cutting speed.
std::optional<DecodedSpeed> decode_speed(const SpeedModel& model, std::string_view code);

}  // namespace leafcutter::drivers
