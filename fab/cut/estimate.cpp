// Junction speed after S. K. Jeon, "Improving Grbl: Cornering Algorithm" (2011): the speed with
// which a circle, tangent to both lines and at most the deviation away from their corner, can be
// driven.

#include "fab/cut/estimate.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "fab/cut/motion.h"

namespace leafcutter::fab {

namespace {

constexpr double kJunctionDeviationMm = 0.01;

struct Block {
    double length_mm = 0.0;
    double speed_mm_per_s = 0.0;
    Eigen::Vector2d direction = Eigen::Vector2d::Zero();
    double entry_mm_per_s = 0.0;  // Highest speed at its start.
};

double corner_speed(const Block& before, const Block& after, double acceleration) {
    const double limit = std::min(before.speed_mm_per_s, after.speed_mm_per_s);
    const double cosine = -before.direction.dot(after.direction);  // Of the angle between the legs.
    if (cosine > 0.999999) {
        return 0.0;
    }
    const double half_sine = std::sqrt(std::max(0.0, 0.5 * (1.0 - cosine)));
    if (half_sine > 0.999999) {
        return limit;
    }
    const double square = acceleration * kJunctionDeviationMm * half_sine / (1.0 - half_sine);
    return std::min(limit, std::sqrt(square));
}

// Accelerates from `entry`, cruises at most at the block's speed, ends at `exit`.
double block_seconds(const Block& block, double exit, double acceleration) {
    const double entry = block.entry_mm_per_s;
    const double peak =
        std::min(block.speed_mm_per_s,
                 std::sqrt(acceleration * block.length_mm + (entry * entry + exit * exit) / 2.0));
    const double ramps_mm =
        (2.0 * peak * peak - entry * entry - exit * exit) / (2.0 * acceleration);
    const double cruise_mm = std::max(0.0, block.length_mm - ramps_mm);
    return (2.0 * peak - entry - exit) / acceleration + cruise_mm / peak;
}

double reachable(double from, double length_mm, double acceleration) {
    return std::sqrt(from * from + 2.0 * acceleration * length_mm);
}

double seconds_of(std::vector<Block>& blocks, double acceleration) {
    double exit = 0.0;
    for (std::size_t i = blocks.size(); i-- > 0;) {
        Block& block = blocks[i];
        const double corner = i == 0 ? 0.0 : corner_speed(blocks[i - 1], block, acceleration);
        block.entry_mm_per_s = std::min(corner, reachable(exit, block.length_mm, acceleration));
        exit = block.entry_mm_per_s;
    }
    double seconds = 0.0;
    for (std::size_t i = 0; i < blocks.size(); ++i) {
        const double most = reachable(blocks[i].entry_mm_per_s, blocks[i].length_mm, acceleration);
        double leave = 0.0;
        if (i + 1 < blocks.size()) {
            blocks[i + 1].entry_mm_per_s = std::min(blocks[i + 1].entry_mm_per_s, most);
            leave = blocks[i + 1].entry_mm_per_s;
        }
        seconds += block_seconds(blocks[i], leave, acceleration);
    }
    return seconds;
}

}  // namespace

CutEstimate estimate_cut(const CutProgram& program, const MachineProfile& machine) {
    CutEstimate estimate;
    std::vector<Block> blocks;
    Eigen::Vector2d at = Eigen::Vector2d::Zero();
    for (const Motion& motion : motions(program, machine)) {
        const Eigen::Vector2d step = motion.to - at;
        const double length = step.norm();
        at = motion.to;
        (motion.burns ? estimate.burn_mm : estimate.travel_mm) += length;
        if (length > 0.0 && motion.feed_mm_per_min > 0.0) {
            const double feed = motion.burns
                                    ? std::min(motion.feed_mm_per_min, machine.rapid_mm_per_min)
                                    : motion.feed_mm_per_min;
            blocks.push_back({length, feed / 60.0, step / length, 0.0});
        }
    }
    if (machine.acceleration_mm_per_s2 > 0.0) {
        estimate.seconds = seconds_of(blocks, machine.acceleration_mm_per_s2);
    }
    return estimate;
}

}  // namespace leafcutter::fab
