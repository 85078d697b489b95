// The planner and stepper of the simulated controller: straight moves with acceleration limits,
// joined at the speeds that Grbl's junction deviation allows. Time is virtual.
//
// Follows Grbl 1.1's planner.c in its rules (look-ahead over the queue, junction deviation) with
// constant-acceleration phases integrated exactly in place of step segments.

#pragma once

#include <array>
#include <cstddef>
#include <deque>
#include <limits>
#include <optional>

#include "drivers/sim/beam_log.h"

namespace leafcutter::drivers {

using Axes = std::array<double, 3>;  // mm, or mm/s, or mm/s²; X Y Z.

enum class BeamMode { Off, Constant, Dynamic };  // M5, M3, M4.

struct Move {
    Axes target_mm{};              // Machine coordinates.
    double feed_mm_per_min = 0.0;  // Ignored by a rapid move.
    bool rapid = false;
    double power_s = 0.0;
    BeamMode beam = BeamMode::Off;
    bool scale_power = false;  // Laser mode with M4: power follows the speed.
    Axes work_offset_mm{};     // For the beam log: work = machine - offset.
};

struct MotionLimits {
    Axes max_mm_per_s{};
    Axes acceleration{};  // mm/s²
    double junction_deviation_mm = 0.0;
};

struct MotionOverrides {
    double feed = 1.0;
    double rapid = 1.0;
    double power = 1.0;
    // $31 and $30: S from above 0 is put out as at least the one and at most the other.
    double least_s = 0.0;
    double most_s = std::numeric_limits<double>::max();

    // What is put out for this S.
    double put_out(double s) const;
};

class MotionQueue {
public:
    static constexpr std::size_t kCapacity = 15;

    bool full() const { return blocks_.size() >= kCapacity; }
    bool empty() const { return blocks_.empty(); }
    std::size_t size() const { return blocks_.size(); }

    // Returns false, and queues nothing, for a move of no length. Needs !full().
    bool push(const Move& move, const MotionLimits& limits);

    const MotionOverrides& overrides() const { return overrides_; }
    void set_overrides(const MotionOverrides& overrides, double now_s, BeamLog& log);

    // Slows down to a stand and stays there until release().
    void hold();
    void release();
    bool holding() const { return holding_; }
    bool standing() const { return speed_ == 0.0 && (holding_ || blocks_.empty()); }

    // Moves for at most `seconds`, to the end of the running block at most. Returns the time used:
    // less than `seconds` at the end of a block or at a stand.
    double advance(double seconds, double now_s, BeamLog& log);

    // Drops every block where it stands. The position stays.
    void clear(double now_s, BeamLog& log);

    // A position known otherwise (homing). Needs empty().
    void set_position(const Axes& position_mm) { position_mm_ = end_mm_ = position_mm; }

    const Axes& position_mm() const { return position_mm_; }
    const Axes& end_mm() const { return end_mm_; }
    double speed_mm_per_s() const { return speed_; }

    // The power put out now by the running block, or nothing when none runs.
    std::optional<double> running_power() const;

private:
    struct Block {
        Move move;
        Axes unit{};
        double length_mm = 0.0;
        double left_mm = 0.0;
        double programmed_mm_per_s = 0.0;
        double top_mm_per_s = 0.0;  // Rapid rate along this direction.
        double acceleration = 0.0;
        double junction_speed = 0.0;  // Most that the corner before this block allows.
        double entry_speed = 0.0;
    };
    struct Phase {
        double acceleration = 0.0;  // Signed.
        double length_mm = 0.0;
        double end_speed = 0.0;
    };

    double nominal(const Block& block) const;
    double corner_speed(const Block& before, const Block& after, const MotionLimits& limits) const;
    void plan();
    Phase next_phase() const;
    double run_phase(const Phase& phase, double budget_s);
    void begin_piece(double now_s);
    void end_piece(double now_s, BeamLog& log);

    std::deque<Block> blocks_;
    MotionOverrides overrides_;
    Axes position_mm_{};
    Axes end_mm_{};
    double speed_ = 0.0;
    bool holding_ = false;
    std::optional<BurntPiece> piece_;
};

}  // namespace leafcutter::drivers
