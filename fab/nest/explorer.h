// A search that squeezes the sheets a little and then separates what overlaps, again and again
// (sections 5 and 6 of the paper named in part.h).

#pragma once

#include <cstdint>
#include <stop_token>
#include <vector>

#include "fab/nest/board.h"
#include "fab/nest/compaction.h"
#include "fab/nest/large_swap.h"
#include "fab/nest/random.h"
#include "fab/nest/search.h"
#include "fab/nest/separation.h"

namespace leafcutter::fab {

class Explorer : public Search {
public:
    Explorer(const BoardPlan& plan, const Packing& start, std::uint64_t seed);

    // The last fifth of the search compresses.
    void advance(std::int64_t evaluations, double progress, const std::stop_token& stop) override;

    const Packing& best() const override { return best_; }
    double best_area() const override { return best_area_; }
    std::int64_t evaluations() const override { return board_.evaluations(); }
    bool wanders() const override { return hopped_ && !compressing(); }
    void adopt(const Packing& better) override;

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
    void hop();
    void begin_hop();
    void rehome(const std::vector<std::size_t>& homeless);

    const BoardPlan& plan_;
    Random random_;
    Board board_;
    Separation separation_;
    PoseSearch search_;
    LargeSwap swap_;
    Packing start_;
    Packing best_;  // Since the last restart or hop.
    double best_area_ = 0.0;
    Packing home_;  // From which it hops: the best of all.
    double home_area_ = 0.0;
    Extent target_;
    double shrink_ = 0.01;  // By which an attempt wants less area.
    double progress_ = 0.0;
    double begun_ = 0.0;  // Progress when the attempt began.
    std::int64_t begun_evaluations_ = 0;
    bool working_ = false;
    bool hopping_ = false;  // The attempt is a hop.
    bool hopped_ = false;   // Ever.
    int hops_in_vain_ = 0;
    bool compressed_ = false;     // The attempt is one of the compressing phase.
    std::vector<Failed> failed_;  // At the present target, least overlap first.
};

}  // namespace leafcutter::fab
