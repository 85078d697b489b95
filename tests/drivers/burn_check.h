// What a simulated beam burnt, held against the path of its program.

#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "drivers/burn/beam_follower.h"
#include "drivers/burn/beam_path.h"
#include "drivers/sim/beam_log.h"

namespace leafcutter::drivers {

inline double length_of(const BurntPiece& piece) {
    return std::hypot(piece.x1_mm - piece.x0_mm, piece.y1_mm - piece.y0_mm);
}

inline double burnt_mm(std::span<const BurntPiece> pieces) {
    double sum = 0.0;
    for (const BurntPiece& piece : pieces) {
        sum += length_of(piece);
    }
    return sum;
}

// How far from the path the beam was at worst, if it burns the path in order and once, having begun
// when `begun_mm` of it were burnt.
inline double worst_deviation(const BeamPath& path,
                              std::span<const BurntPiece> pieces,
                              double begun_mm = 0.0) {
    constexpr double kDrift = 0.3;  // Targets are rounded to whole steps.
    double burnt = begun_mm;
    double worst = 0.0;
    for (const BurntPiece& piece : pieces) {
        burnt += length_of(piece);
        double nearest = 1e9;
        double best = burnt;
        for (double try_mm = burnt - kDrift; try_mm <= burnt + kDrift; try_mm += 0.01) {
            const Point at = path.point_at(path.way_of_burn(std::max(0.0, try_mm)));
            const double off = std::hypot(at[0] - piece.x1_mm, at[1] - piece.y1_mm);
            if (off < nearest) {
                nearest = off;
                best = try_mm;
            }
        }
        burnt = best;
        worst = std::max(worst, nearest);
    }
    return worst;
}

// A journal in memory, safe at once.
class KeptJournal final : public JournalSink {
public:
    void note(const JournalRecord& record) override {
        journal.records.push_back(record);
        if (record.kind == JournalRecord::Kind::May) {
            lines_ = record.lines;
        }
    }
    std::size_t lines_on_disk() const override { return lines_; }

    Journal journal;

private:
    std::size_t lines_ = 0;
};

}  // namespace leafcutter::drivers
