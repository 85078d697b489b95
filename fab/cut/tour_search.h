// A tour that is being improved: which moves make it shorter, and how to take them back.

#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "fab/cut/cut_tour.h"
#include "fab/nest/random.h"
#include "geometry/context.h"

namespace leafcutter::fab {

class TourSearch {
public:
    // `neighbours` of each place: those that are worth coming next to it. `tour` holds every place
    // once and keeps the problem's precedence. All outlive the search.
    TourSearch(const TourProblem& problem,
               const std::vector<std::vector<std::size_t>>& neighbours,
               std::vector<TourStop> tour,
               const geometry::Context& context);

    // Until no move makes it shorter.
    void descend();

    // Swaps neighbouring runs at random places and mends the tour round them; keeps what comes out
    // no longer. Looks at so many distances.
    void kick(std::int64_t evaluations, Random& random);

    double length_mm() const;
    std::vector<TourStop> tour() const;

    // Other starts for the same order, place by place.
    void set_starts(const std::vector<TourStop>& tour);

private:
    struct Step {  // Of the journal.
        std::size_t low = 0;
        std::size_t middle = 0;
        std::size_t high = 0;  // low = high: `middle` is a place, its old start follows.
        std::size_t start = 0;
        bool reversed = false;
    };
    struct Insertion {
        double gain = 0.0;
        std::size_t after = 0;  // Position; the number of places: at the very beginning.
        std::size_t start = 0;
        bool backward = false;
    };

    std::size_t at(std::size_t position) const { return order_[position]; }
    const Eigen::Vector2d& exit_before(std::size_t position) const {
        return position == 0 ? problem_.from : exit_[order_[position - 1]];
    }
    double way(const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
        ++evaluations_;
        return (to - from).norm();
    }

    void touch(std::size_t position);
    void drain();
    bool improve(std::size_t place);
    bool try_start(std::size_t place);
    bool try_reversal(std::size_t first, std::size_t last);
    bool try_moves(std::size_t place, std::size_t other);
    bool try_move(std::size_t first, std::size_t last, std::size_t target);
    bool try_placing(std::size_t place, std::size_t target);
    std::size_t best_start(std::size_t place,
                           const Eigen::Vector2d& before,
                           const Eigen::Vector2d* after);

    bool may_reverse(std::size_t first, std::size_t last) const;
    bool may_pass(std::size_t low, std::size_t middle, std::size_t high) const;

    void choose(std::size_t place, std::size_t start);
    void reverse(std::size_t first, std::size_t last);
    void rotate(std::size_t low, std::size_t middle, std::size_t high);
    void turn_over(std::size_t first, std::size_t last);
    void shift_ends(std::size_t low, std::size_t middle, std::size_t high);
    void undo();

    const TourProblem& problem_;
    const std::vector<std::vector<std::size_t>>& neighbours_;
    const geometry::Context& context_;
    std::vector<std::vector<std::size_t>> earlier_;  // Of each place; empty without precedence.
    std::vector<std::vector<std::size_t>> later_;
    std::vector<std::size_t> order_;
    std::vector<std::size_t> position_;
    std::vector<std::size_t> start_;
    std::vector<Eigen::Vector2d> entry_;
    std::vector<Eigen::Vector2d> exit_;
    std::vector<std::size_t> queue_;  // Places whose surroundings changed.
    std::vector<char> queued_;
    std::vector<Step> journal_;
    bool writes_journal_ = false;
    double gained_mm_ = 0.0;
    std::int64_t evaluations_ = 0;
};

}  // namespace leafcutter::fab
