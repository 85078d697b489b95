#include "drivers/lihuiyu/runs.h"

#include <algorithm>
#include <cstdlib>

#include <fmt/format.h>

namespace leafcutter::drivers {

namespace {

constexpr long kZ = 255;
constexpr long kLastLetter = 25;
constexpr long kLastBarred = 51;

int sign(long value) {
    return value > 0 ? 1 : value < 0 ? -1 : 0;
}

}  // namespace

std::vector<Run> runs_of_line(const StepPlace& way) {
    const long across = std::labs(way.x);
    const long down = std::labs(way.y);
    const long major = std::max(across, down);
    const long minor = std::min(across, down);
    const bool x_major = across >= down;
    const Run diagonal{sign(way.x), sign(way.y), 0};
    const Run straight{x_major ? diagonal.dx : 0, x_major ? 0 : diagonal.dy, 0};
    std::vector<Run> runs;
    long before = 0;
    for (long i = 1; i <= major; ++i) {
        const long after = (2 * i * minor + major) / (2 * major);
        const Run& kind = after == before ? straight : diagonal;
        before = after;
        if (runs.empty() || runs.back().dx != kind.dx || runs.back().dy != kind.dy) {
            runs.push_back(kind);
        }
        ++runs.back().length;
    }
    return runs;
}

std::string encode_distance(long steps) {
    std::string text(static_cast<std::size_t>(steps / kZ), 'z');
    const long rest = steps % kZ;
    if (rest > kLastBarred) {
        return text + fmt::format("{:03}", rest);
    }
    if (rest > kLastLetter) {
        text += '|';
    }
    if (rest > 0) {
        text += static_cast<char>('a' + (rest > kLastLetter ? rest - kLastLetter : rest) - 1);
    }
    return text;
}

std::string encode_way(const StepPlace& way) {
    std::string text;
    if (way.x != 0) {
        text += way.x < 0 ? 'T' : 'B';
        text += encode_distance(std::labs(way.x));
    }
    if (way.y != 0) {
        text += way.y < 0 ? 'L' : 'R';
        text += encode_distance(std::labs(way.y));
    }
    return text;
}

}  // namespace leafcutter::drivers
