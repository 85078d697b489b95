// One of the searches of a compaction.

#pragma once

#include <cstdint>
#include <stop_token>
#include <vector>

#include "fab/nest/board.h"
#include "fab/nest/compaction.h"
#include "fab/nest/random.h"
#include "fab/nest/separation.h"

namespace leafcutter::fab {

class Explorer {
public:
    Explorer(const BoardPlan& plan, const Packing& start, std::uint64_t seed);

    // Works for about that many evaluations. `progress` in [0, 1]: of the whole search; the last
    // fifth compresses. Throws Cancelled after a stop request.
    void advance(std::int64_t evaluations, double progress, const std::stop_token& stop);

    const Packing& best() const { return best_; }
    double best_area() const { return best_area_; }
    std::int64_t evaluations() const { return board_.evaluations(); }

    // Takes over what another search found. Better than its own, or else its own was refused.
    void adopt(const Packing& better);

private:
    struct Failed {
        std::vector<Position> positions;
        double loss = 0.0;
    };

    bool compressing() const { return progress_ >= 0.8; }
    bool takes_long() const;
    void begin_attempt();
    void begin_exploring();
    void begin_compressing();
    void attempt(std::vector<Position> positions,
                 const Extent& from,
                 const Extent& to,
                 double split);
    void succeed();
    void fail();
    void restart();
    void disrupt(std::vector<Position>& positions);
    void rehome(const std::vector<std::size_t>& homeless);

    const BoardPlan& plan_;
    Random random_;
    Board board_;
    Separation separation_;
    PoseSearch search_;
    std::vector<std::size_t> large_;  // Items that make up three quarters of all hulls.
    Packing start_;
    Packing best_;  // Since the last restart.
    double best_area_ = 0.0;
    Extent target_;
    double shrink_ = 0.01;  // By which an attempt wants less area.
    double progress_ = 0.0;
    double begun_ = 0.0;  // Progress when the attempt began.
    std::int64_t begun_evaluations_ = 0;
    bool working_ = false;
    bool compressed_ = false;     // The attempt is one of the compressing phase.
    std::vector<Failed> failed_;  // At the present target, least overlap first.
};

}  // namespace leafcutter::fab
