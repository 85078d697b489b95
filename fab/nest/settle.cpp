#include "fab/nest/settle.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <thread>

#include "fab/nest/random.h"
#include "fab/nest/separation.h"
#include "geometry/error.h"

namespace leafcutter::fab {

namespace {

constexpr std::int64_t kEpoch = 20'000;  // Evaluations of each search between two looks.
constexpr std::size_t kSearches = 2;
constexpr int kEpochsApart = 40;  // Between two exchanges.

class Settler {
public:
    Settler(const BoardPlan& plan, const std::vector<Position>& start, std::uint64_t seed)
        : plan_(plan), random_(seed), board_(plan), separation_(board_, random_) {
        begin(start);
    }

    // True once nothing overlaps.
    bool advance(std::int64_t evaluations, const std::stop_token& stop) {
        const std::int64_t until = board_.evaluations() + evaluations;
        while (!found_ && board_.evaluations() < until) {
            const Separation::State state = separation_.run(until, stop);
            found_ = state == Separation::State::Feasible;
            if (state == Separation::State::GaveUp) {
                note_failure();
                disrupt();
            }
        }
        return found_;
    }

    bool found() const { return found_; }
    const std::vector<Position>& positions() const { return board_.positions(); }
    std::int64_t evaluations() const { return board_.evaluations(); }
    double loss() const { return least_loss_; }

    // Goes on from where another search is.
    void adopt(const Settler& better) {
        least_ = better.least_;
        least_loss_ = better.least_loss_;
        disrupt();
    }

private:
    // Items without a place go where they overlap the least, in random order.
    void begin(std::vector<Position> positions) {
        std::vector<std::size_t> homeless;
        for (std::size_t item = 0; item < positions.size(); ++item) {
            if (positions[item].bin < 0) {
                homeless.push_back(item);
                put_anywhere(item, positions[item]);
            }
        }
        board_.restore(positions, whole());
        random_.shuffle(homeless);
        PoseSearch search(board_, random_);
        for (const std::size_t item : homeless) {
            board_.move(item, search.best_for(item).position);
        }
        separation_.begin({2, 60});
    }

    Extent whole() const {
        return {static_cast<int>(plan_.rooms.size()), plan_.rooms.back().width};
    }

    void put_anywhere(std::size_t item, Position& at) {
        const NestPart& part = plan_.part(item);
        const std::size_t room = random_.below(plan_.rooms.size());
        at.bin = static_cast<int>(room);
        at.turn = 0;
        at.angle_deg = part.turns_freely() ? part.allowed_deg.nearest(0.0) : part.allowed_deg[0];
        at.x = random_.unit() * plan_.rooms[room].width;
        at.y = random_.unit() * plan_.rooms[room].height;
    }

    void note_failure() {
        if (least_.empty() || separation_.best_loss() <= least_loss_) {
            least_ = separation_.best();
            least_loss_ = separation_.best_loss();
        }
    }

    // The layout of the least overlap with an item that overlaps and another one swapped.
    void disrupt() {
        board_.restore(least_, whole());
        std::vector<std::size_t> uneasy;
        for (const PoseClash& clash : board_.clashes()) {
            uneasy.push_back(clash.item);
        }
        if (!uneasy.empty() && board_.items() > 1) {
            constexpr int kMostSwaps = 3;
            const std::size_t swaps = 1 + random_.below(kMostSwaps);
            for (std::size_t i = 0; i < swaps; ++i) {
                swap(uneasy[random_.below(uneasy.size())], random_.below(board_.items()));
            }
        }
        separation_.begin({1, 40});
    }

    void swap(std::size_t a, std::size_t b) {
        const Position at_a = board_.position(a);
        const Position at_b = board_.position(b);
        board_.move(a, turned_like(plan_.part(a), at_b, at_a));
        board_.move(b, turned_like(plan_.part(b), at_a, at_b));
    }

    // The place `to` at a rotation that the part may have: the nearest, or its own from a list.
    static Position turned_like(const NestPart& part, Position to, const Position& own) {
        to.turn = own.turn;
        to.angle_deg = part.turns_freely() ? part.allowed_deg.nearest(to.angle_deg) : own.angle_deg;
        return to;
    }

    const BoardPlan& plan_;
    Random random_;
    Board board_;
    Separation separation_;
    std::vector<Position> least_;
    double least_loss_ = std::numeric_limits<double>::infinity();
    bool found_ = false;
};

void run_epoch(std::vector<std::unique_ptr<Settler>>& searches,
               std::int64_t evaluations,
               const geometry::Context& context) {
    std::vector<char> stopped(searches.size(), 0);
    const auto run = [&](std::size_t i) {
        try {
            searches[i]->advance(evaluations, context.stop);
        } catch (const geometry::Cancelled&) {
            stopped[i] = 1;
        }
    };
    {
        std::vector<std::jthread> others;
        for (std::size_t i = 1; i < searches.size() && context.threads > 1; ++i) {
            others.emplace_back(run, i);
        }
        run(0);
        for (std::size_t i = 1; i < searches.size() && context.threads <= 1; ++i) {
            run(i);
        }
    }
    if (std::find(stopped.begin(), stopped.end(), 1) != stopped.end()) {
        throw geometry::Cancelled();
    }
}

// A search that is far behind starts from where the other one is.
void follow_the_better(const std::vector<std::unique_ptr<Settler>>& searches) {
    constexpr double kFar = 1.5;
    const auto least =
        std::min_element(searches.begin(), searches.end(),
                         [](const auto& a, const auto& b) { return a->loss() < b->loss(); });
    for (const auto& search : searches) {
        if (std::isfinite(search->loss()) && search->loss() > kFar * (*least)->loss()) {
            search->adopt(**least);
        }
    }
}

}  // namespace

Settled settle(const BoardPlan& plan,
               const std::vector<Position>& start,
               const CompactionOptions& options,
               const geometry::Context& context) {
    std::vector<std::unique_ptr<Settler>> searches;
    for (std::size_t i = 0; i < kSearches; ++i) {
        searches.push_back(std::make_unique<Settler>(plan, start, options.seed * 6007 + i));
    }
    const double begun_s = context.now_s();
    Settled settled;
    int epochs = 0;
    while (!settled.found && settled.evaluations < options.max_evaluations &&
           (options.time_s <= 0.0 || context.now_s() - begun_s < options.time_s)) {
        const std::int64_t left = (options.max_evaluations - settled.evaluations) / 2 + 1;
        run_epoch(searches, std::min(kEpoch, left), context);
        settled.evaluations = 0;
        for (const auto& search : searches) {
            settled.evaluations += search->evaluations();
            if (!settled.found && search->found()) {
                settled.found = true;
                settled.positions = search->positions();
            }
        }
        if (++epochs % kEpochsApart == 0) {
            follow_the_better(searches);
        }
    }
    return settled;
}

}  // namespace leafcutter::fab
