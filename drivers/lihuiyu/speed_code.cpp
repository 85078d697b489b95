#include "drivers/lihuiyu/speed_code.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

namespace leafcutter::drivers {

namespace {

constexpr double kStepMm = 25.4;  // Times steps per ms: mm/s, at 1/1000 inch per step.
constexpr double kSlowMmPerS = 7.0;
constexpr double kDiagonalRatio = 0.261199033289;
constexpr int kMostDiagonalSteps = 128;
constexpr int kCounts = 65536;

constexpr std::array<std::string_view, 8> kNames{"A", "B", "B1", "B2", "M", "M1", "M2", "M3"};

struct Equation {
    double b = 0.0;
    double m = 0.0;
};

bool is_m_family(LihuiyuBoard board) {
    return board >= LihuiyuBoard::M;
}

bool slows_diagonals(LihuiyuBoard board) {
    return board != LihuiyuBoard::A && board != LihuiyuBoard::B && board != LihuiyuBoard::M;
}

bool counts_slowly(LihuiyuBoard board, double mm_per_s) {
    const bool knows =
        board == LihuiyuBoard::M2 || board == LihuiyuBoard::M3 || board == LihuiyuBoard::B2;
    return knows && mm_per_s < kSlowMmPerS;
}

int acceleration_for(double mm_per_s) {
    if (mm_per_s <= 25.4) {
        return 1;
    }
    if (mm_per_s <= 60.0) {
        return 2;
    }
    return mm_per_s < 127.0 ? 3 : 4;
}

Equation equation_of(const SpeedModel& model, int acceleration, bool slowly) {
    const auto by_acceleration = [acceleration](double low, double middle, double high) {
        return acceleration == 4 ? high : acceleration == 3 ? middle : low;
    };
    Equation equation;
    if (is_m_family(model.board)) {
        equation = {slowly ? 8.0 : by_acceleration(5120.0, 5632.0, 6144.0), 12120.0};
    } else {
        equation = {by_acceleration(784.0, 896.0, 1024.0),
                    model.board == LihuiyuBoard::B2 ? 24240.0 : 2000.0};
    }
    equation.m *= model.slope / (slowly ? 12.0 : 1.0);
    return equation;
}

std::string sixteen_bits(double value) {
    const int whole = static_cast<int>(value);
    return fmt::format("{:03}{:03}", whole / 256, whole % 256);
}

[[noreturn]] void refuse(LihuiyuBoard board, double mm_per_s, std::string_view what) {
    throw std::invalid_argument(
        fmt::format("{:.4g} mm/s: {} board {}", mm_per_s, what, to_string(board)));
}

// The digits at the front of `text`, taken off it.
std::string_view take_digits(std::string_view& text) {
    const std::size_t end = std::min(text.find_first_not_of("0123456789"), text.size());
    const std::string_view digits = text.substr(0, end);
    text.remove_prefix(end);
    return digits;
}

int number_at(std::string_view digits, std::size_t at, std::size_t count) {
    int number = 0;
    for (const char digit : digits.substr(at, count)) {
        number = 10 * number + (digit - '0');
    }
    return number;
}

}  // namespace

std::string_view to_string(LihuiyuBoard board) {
    return kNames[static_cast<std::size_t>(board)];
}

LihuiyuBoard parse_lihuiyu_board(std::string_view name) {
    const auto* const found = std::find(kNames.begin(), kNames.end(), name);
    if (found == kNames.end()) {
        throw std::invalid_argument(
            fmt::format("board \"{}\": must be one of {}", name, fmt::join(kNames, ", ")));
    }
    return static_cast<LihuiyuBoard>(found - kNames.begin());
}

std::string encode_speed(const SpeedModel& model, double mm_per_s) {
    if (!(mm_per_s > 0.0) || mm_per_s > kFastestCutMmPerS) {
        refuse(model.board, mm_per_s,
               fmt::format("cutting speeds are above 0 and up to {:g} on", kFastestCutMmPerS));
    }
    const int acceleration = acceleration_for(mm_per_s);
    const bool slowly = counts_slowly(model.board, mm_per_s);
    const Equation equation = equation_of(model, acceleration, slowly);
    const double period_ms = kStepMm / mm_per_s;
    const double value = kCounts - (equation.b + equation.m * period_ms);
    if (value < 0.0) {
        const double slowest = std::ceil(100.0 * kStepMm * equation.m / (kCounts - equation.b));
        refuse(model.board, mm_per_s,
               fmt::format("there is no code for it; the next faster speed is {:.2f} on",
                           slowest / 100.0));
    }
    std::string code = fmt::format("CV{}{}", sixteen_bits(value), acceleration);
    if (slows_diagonals(model.board)) {
        const int steps = std::min(static_cast<int>(mm_per_s) + 1, kMostDiagonalSteps);
        const double delay = kDiagonalRatio * equation.m * period_ms / steps;
        code += fmt::format("{:03}{}", steps, sixteen_bits(std::min(delay, kCounts - 1.0)));
    }
    return code + (slowly ? "C" : "");
}

std::optional<DecodedSpeed> decode_speed(const SpeedModel& model, std::string_view code) {
    if (!code.empty() && code[0] == 'C') {
        code.remove_prefix(1);
    }
    if (code.empty() || code[0] != 'V') {
        return std::nullopt;
    }
    code.remove_prefix(1);
    const std::string_view digits = take_digits(code);
    const bool known_length = digits.size() == 7 || digits.size() == 16;
    if (!known_length || (!code.empty() && code != "C")) {
        return std::nullopt;
    }
    const int high = number_at(digits, 0, 3);
    const int low = number_at(digits, 3, 3);
    const int acceleration = number_at(digits, 6, 1);
    if (high > 255 || low > 255 || acceleration < 1 || acceleration > 4) {
        return std::nullopt;
    }
    const Equation equation = equation_of(model, acceleration, code == "C");
    const double ticks = kCounts - (256 * high + low) - equation.b;
    if (!(ticks > 0.0)) {
        return std::nullopt;
    }
    // Nine zeros stand for no compensation.
    const bool slows = digits.size() == 16 && number_at(digits, 7, 3) != 0;
    return DecodedSpeed{kStepMm * equation.m / ticks, acceleration, slows};
}

}  // namespace leafcutter::drivers
