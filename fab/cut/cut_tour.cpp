#include "fab/cut/cut_tour.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "fab/cut/point_grid.h"

namespace leafcutter::fab {

namespace {

constexpr double kGainMm = 1e-6;  // Less is no improvement, or rounding would go round in circles.

using Stops = std::vector<std::vector<TourStart>>;

class Tour {
public:
    Tour(const Stops& stops, const Eigen::Vector2d& from, const geometry::Context& context)
        : stops_(stops), from_(from), context_(context) {}

    std::vector<TourStop> find() {
        nearest_neighbour();
        choose_starts();
        find_neighbours();
        constexpr int kRounds = 8;
        for (int round = 0; round < kRounds; ++round) {
            const double before = length();
            improve_order();
            choose_starts();
            if (length() > before - 1e-3) {
                break;
            }
        }
        return tour_;
    }

private:
    const TourStart& at(std::size_t position) const {
        return stops_[tour_[position].stop][tour_[position].start];
    }
    // Where the tour comes from before `position`.
    const Eigen::Vector2d& exit_before(std::size_t position) const {
        return position == 0 ? from_ : at(position - 1).exit;
    }

    double length() const {
        double sum = 0.0;
        for (std::size_t i = 0; i < tour_.size(); ++i) {
            sum += (at(i).entry - exit_before(i)).norm();
        }
        return sum;
    }

    void nearest_neighbour() {
        std::vector<Eigen::Vector2d> points;
        std::vector<TourStop> names;
        for (std::size_t stop = 0; stop < stops_.size(); ++stop) {
            for (std::size_t start = 0; start < stops_[stop].size(); ++start) {
                points.push_back(stops_[stop][start].entry);
                names.push_back({stop, start});
            }
        }
        PointGrid grid(points);
        std::vector<std::size_t> first_point(stops_.size(), 0);
        for (std::size_t i = names.size(); i-- > 0;) {
            first_point[names[i].stop] = i;
        }
        Eigen::Vector2d here = from_;
        while (tour_.size() < stops_.size()) {
            const TourStop next = names[grid.nearest(here)];
            tour_.push_back(next);
            here = stops_[next.stop][next.start].exit;
            for (std::size_t i = 0; i < stops_[next.stop].size(); ++i) {
                grid.remove(first_point[next.stop] + i);
            }
        }
    }

    // Best starts for the order as it is: shortest path through layers of starts.
    void choose_starts() {
        std::vector<std::vector<std::size_t>> came_from(tour_.size());
        std::vector<double> cost{0.0};
        const std::vector<TourStart> home{{from_, from_, 0}};
        const std::vector<TourStart>* before = &home;
        for (std::size_t i = 0; i < tour_.size(); ++i) {
            const std::vector<TourStart>& here = stops_[tour_[i].stop];
            std::vector<double> next(here.size(), std::numeric_limits<double>::infinity());
            came_from[i].resize(here.size());
            for (std::size_t b = 0; b < here.size(); ++b) {
                for (std::size_t a = 0; a < before->size(); ++a) {
                    const double way = cost[a] + (here[b].entry - (*before)[a].exit).norm();
                    if (way < next[b]) {
                        next[b] = way;
                        came_from[i][b] = a;
                    }
                }
            }
            cost = std::move(next);
            before = &here;
        }
        auto best =
            static_cast<std::size_t>(std::min_element(cost.begin(), cost.end()) - cost.begin());
        for (std::size_t i = tour_.size(); i-- > 0;) {
            tour_[i].start = best;
            best = came_from[i][best];
        }
    }

    // Stops near any start of each stop, whatever starts are chosen now.
    void find_neighbours() {
        std::vector<Eigen::Vector2d> points;
        std::vector<std::size_t> owner;
        for (std::size_t stop = 0; stop < stops_.size(); ++stop) {
            for (const TourStart& start : stops_[stop]) {
                points.push_back(start.entry);
                owner.push_back(stop);
            }
        }
        const PointGrid grid(points);
        constexpr std::size_t kNear = 6;
        constexpr std::size_t kMost = 24;
        neighbours_.assign(stops_.size(), {});
        for (std::size_t i = 0; i < points.size(); ++i) {
            std::vector<std::size_t>& near = neighbours_[owner[i]];
            for (const std::size_t other : grid.nearest_others(i, owner, kNear)) {
                if (near.size() < kMost &&
                    std::find(near.begin(), near.end(), owner[other]) == near.end()) {
                    near.push_back(owner[other]);
                }
            }
        }
    }

    void number_positions(std::size_t first, std::size_t last) {
        for (std::size_t i = first; i <= last; ++i) {
            position_[tour_[i].stop] = i;
        }
    }

    void improve_order() {
        position_.resize(stops_.size());
        if (tour_.empty()) {
            return;
        }
        number_positions(0, tour_.size() - 1);
        constexpr int kSweeps = 12;
        for (int sweep = 0; sweep < kSweeps; ++sweep) {
            bool better = false;
            for (std::size_t stop = 0; stop < stops_.size(); ++stop) {
                context_.check();
                for (const std::size_t other : neighbours_[stop]) {
                    better |= try_reversal(position_[stop], position_[other]);
                    better |= try_moves(stop, other);
                    better |= try_new_start(stop, other);
                }
            }
            if (!better) {
                return;
            }
        }
    }

    // 2-opt: brings the exits, or the entries, of two stops together by running all between
    // backward.
    bool try_reversal(std::size_t i, std::size_t j) {
        const std::size_t low = std::min(i, j);
        const std::size_t high = std::max(i, j);
        return reverse_if_shorter(low + 1, high) || reverse_if_shorter(low, high - 1);
    }

    bool reverse_if_shorter(std::size_t first, std::size_t last) {
        double gain = (at(first).entry - exit_before(first)).norm() -
                      (at(last).exit - exit_before(first)).norm();
        if (last + 1 < tour_.size()) {
            gain += (at(last + 1).entry - at(last).exit).norm() -
                    (at(last + 1).entry - at(first).entry).norm();
        }
        if (gain <= kGainMm) {
            return false;
        }
        reverse(first, last);
        number_positions(first, last);
        return true;
    }

    void reverse(std::size_t first, std::size_t last) {
        std::reverse(tour_.begin() + static_cast<std::ptrdiff_t>(first),
                     tour_.begin() + static_cast<std::ptrdiff_t>(last) + 1);
        for (std::size_t i = first; i <= last; ++i) {
            if (stops_[tour_[i].stop].size() == 2) {
                tour_[i].start = 1 - tour_[i].start;
            }
        }
    }

    // Or-opt: up to three stops from `stop` on, moved to just after `other`, either way round.
    bool try_moves(std::size_t stop, std::size_t other) {
        constexpr std::size_t kLongest = 3;
        for (std::size_t count = 1; count <= kLongest; ++count) {
            const std::size_t first = position_[stop];
            const std::size_t last = first + count - 1;
            const std::size_t target = position_[other];
            if (last >= tour_.size() || (target >= first && target <= last) ||
                target + 1 == first) {
                continue;
            }
            if (move_if_shorter(first, last, target)) {
                return true;
            }
        }
        return false;
    }

    bool move_if_shorter(std::size_t first, std::size_t last, std::size_t target) {
        const bool at_end = last + 1 == tour_.size();
        const double taken = (at(first).entry - exit_before(first)).norm() +
                             (at_end ? 0.0 : (at(last + 1).entry - at(last).exit).norm());
        const double closed = at_end ? 0.0 : (at(last + 1).entry - exit_before(first)).norm();
        const bool onto_end = target + 1 == tour_.size();
        const Eigen::Vector2d& leave = at(target).exit;
        const double opened = onto_end ? 0.0 : (at(target + 1).entry - leave).norm();
        const auto joined = [&](const Eigen::Vector2d& entry, const Eigen::Vector2d& exit) {
            return (entry - leave).norm() + (onto_end ? 0.0 : (at(target + 1).entry - exit).norm());
        };
        const double forward = joined(at(first).entry, at(last).exit);
        const double backward = joined(at(last).exit, at(first).entry);
        if (taken - closed + opened - std::min(forward, backward) <= kGainMm) {
            return false;
        }
        if (backward < forward) {
            reverse(first, last);
        }
        shift(first, last, target);
        return true;
    }

    // A closed stop goes between `other` and its successor and starts where that is shortest.
    bool try_new_start(std::size_t stop, std::size_t other) {
        const std::vector<TourStart>& starts = stops_[stop];
        const std::size_t from = position_[stop];
        const std::size_t target = position_[other];
        if (starts.size() <= 2 || target + 1 == from) {
            return false;
        }
        const bool at_end = from + 1 == tour_.size();
        const bool onto_end = target + 1 == tour_.size();
        const Eigen::Vector2d& before = at(target).exit;
        const Eigen::Vector2d& after = onto_end ? before : at(target + 1).entry;
        double gain = (at(from).entry - exit_before(from)).norm();
        if (!at_end) {
            gain += (at(from + 1).entry - at(from).exit).norm() -
                    (at(from + 1).entry - exit_before(from)).norm();
        }
        gain += (after - before).norm();
        double least = gain - kGainMm;
        std::size_t best = starts.size();
        for (std::size_t i = 0; i < starts.size(); ++i) {
            const double way = (starts[i].entry - before).norm() +
                               (onto_end ? 0.0 : (after - starts[i].exit).norm());
            if (way < least) {
                least = way;
                best = i;
            }
        }
        if (best == starts.size()) {
            return false;
        }
        tour_[from].start = best;
        shift(from, from, target);
        return true;
    }

    // Moves tour_[first..last] to just after `target`, which is not among them.
    void shift(std::size_t first, std::size_t last, std::size_t target) {
        const auto begin = tour_.begin();
        const auto offset = [](std::size_t i) { return static_cast<std::ptrdiff_t>(i); };
        if (target > last) {
            std::rotate(begin + offset(first), begin + offset(last) + 1,
                        begin + offset(target) + 1);
            number_positions(first, target);
        } else {
            std::rotate(begin + offset(target) + 1, begin + offset(first),
                        begin + offset(last) + 1);
            number_positions(target + 1, last);
        }
    }

    const Stops& stops_;
    Eigen::Vector2d from_;
    const geometry::Context& context_;
    std::vector<TourStop> tour_;
    std::vector<std::size_t> position_;  // Of each stop in the tour.
    std::vector<std::vector<std::size_t>> neighbours_;
};

}  // namespace

std::vector<TourStop> shortest_tour(const Stops& stops,
                                    const Eigen::Vector2d& from,
                                    const geometry::Context& context) {
    return Tour(stops, from, context).find();
}

}  // namespace leafcutter::fab
