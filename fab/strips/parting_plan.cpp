#include "fab/strips/parting_plan.h"

#include <algorithm>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <utility>

namespace leafcutter::fab {

namespace {

// Ways to open a closed run that are tried before it is parted in two.
constexpr int kMostOpenings = 48;

// Ways to part that are tried before the longest runs are taken one after the other.
constexpr int kMostPlans = 12;

constexpr double kNever = std::numeric_limits<double>::infinity();

struct Plan {
    double cost = kNever;
    std::vector<int> firsts;
};

class Planner {
public:
    explicit Planner(const PartingProblem& problem) : problem_(problem), n_(problem.cells) {
        at_.push_back(0.0);
        for (int i = 0; i < 2 * n_; ++i) {
            at_.push_back(at_.back() + problem.length[static_cast<std::size_t>(i % n_)]);
        }
    }

    std::vector<int> plan() { return problem_.closed ? closed() : open(); }

private:
    double joint_cost(int cell) const {
        return problem_.joint_cost[static_cast<std::size_t>(cell % n_)];
    }
    bool good(int first, int count) const { return problem_.good(first % n_, count); }

    // Behind the last cell of the longest good run that begins at `first`.
    int end_of(int first) {
        if (first >= n_) {
            return end_of(first - n_) + n_;
        }
        const auto known = ends_.find(first);
        if (known != ends_.end()) {
            return known->second;
        }
        const auto after = ends_.lower_bound(first);
        int low = first + 1;
        if (after != ends_.begin()) {
            low = std::max(low, std::prev(after)->second);
        }
        int high = problem_.closed ? first + n_ : n_;
        if (after != ends_.end()) {
            high = std::min(high, after->second);
        }
        const int end = furthest(first, low, high);
        ends_.emplace(first, end);
        return end;
    }

    // The last good end in [low, high]; `low` is taken as good.
    int furthest(int first, int low, int high) const {
        int good_end = low;
        int bad_end = high + 1;
        for (int step = 1; good_end + 1 < bad_end; step *= 2) {
            const int end = std::min(good_end + step, bad_end - 1);
            if (!good(first, end - first)) {
                bad_end = end;
                break;
            }
            good_end = end;
        }
        while (bad_end - good_end > 1) {
            const int end = good_end + (bad_end - good_end) / 2;
            (good(first, end - first) ? good_end : bad_end) = end;
        }
        return good_end;
    }

    // Ends of the parts if each is as long as can be, from `from` to `to`.
    std::vector<int> longest(int from, int to) {
        std::vector<int> ends{from};
        while (ends.back() < to) {
            ends.push_back(std::min(to, end_of(ends.back())));
        }
        return ends;
    }

    // The first places from which the remaining parts still reach `to`.
    std::vector<int> earliest(const std::vector<int>& latest, int to) {
        std::vector<int> places(latest.size(), latest.front());
        places.back() = to;
        for (std::size_t m = latest.size() - 1; m-- > 1;) {
            int low = latest.front() + static_cast<int>(m);
            int high = latest[m];
            while (low < high) {
                const int middle = low + (high - low) / 2;
                if (end_of(middle) >= places[m + 1]) {
                    high = middle;
                } else {
                    low = middle + 1;
                }
            }
            places[m] = high;
        }
        return places;
    }

    double part_cost(int from, int to, double mean) const {
        const double length =
            at_[static_cast<std::size_t>(to)] - at_[static_cast<std::size_t>(from)];
        const double off = mean > 0.0 ? length / mean - 1.0 : 0.0;
        return problem_.evenness * off * off;
    }

    // The cheapest way from `from` to `to` in as few parts as `latest` has.
    Plan cheapest(const std::vector<int>& latest, int to) {
        const int from = latest.front();
        const std::size_t parts = latest.size() - 1;
        const std::vector<int> first = earliest(latest, to);
        const double mean =
            (at_[static_cast<std::size_t>(to)] - at_[static_cast<std::size_t>(from)]) /
            static_cast<double>(parts);
        std::vector<std::vector<std::pair<double, int>>> best(parts + 1);  // Cost, place before.
        best[0] = {{0.0, from}};
        for (std::size_t m = 1; m <= parts; ++m) {
            for (int j = first[m]; j <= latest[m]; ++j) {
                std::pair<double, int> here{kNever, -1};
                for (int i = first[m - 1]; i <= std::min(latest[m - 1], j - 1); ++i) {
                    const double before =
                        best[m - 1][static_cast<std::size_t>(i - first[m - 1])].first;
                    if (before < here.first && end_of(i) >= j && !bad_.count({i % n_, j - i})) {
                        here = std::min(here, {before + part_cost(i, j, mean), i});
                    }
                }
                const bool joint = j < to || problem_.closed;
                best[m].emplace_back(here.first + (joint ? joint_cost(j) : 0.0), here.second);
            }
        }
        Plan plan{.cost = best[parts].back().first, .firsts = {}};
        int place = to;
        for (std::size_t m = parts; m > 0 && plan.cost < kNever; --m) {
            place = best[m][static_cast<std::size_t>(place - first[m])].second;
            plan.firsts.insert(plan.firsts.begin(), place);
        }
        return plan;
    }

    // Remembers parts of a plan that are not good after all; true if there are none.
    bool holds(const Plan& plan, int to) {
        bool all = true;
        for (std::size_t i = 0; i < plan.firsts.size(); ++i) {
            const int from = plan.firsts[i];
            const int count = (i + 1 < plan.firsts.size() ? plan.firsts[i + 1] : to) - from;
            if (count > 1 && !good(from, count)) {
                bad_.emplace(from % n_, count);
                all = false;
            }
        }
        return all;
    }

    // Each part as long as can be, tried out one by one.
    std::vector<int> by_trial(int from, int to) {
        std::vector<int> firsts;
        for (int first = from; first < to;) {
            firsts.push_back(first);
            int end = std::min(to, end_of(first));
            while (end > first + 1 && !good(first, end - first)) {
                --end;
            }
            first = end;
        }
        return firsts;
    }

    std::vector<int> open() {
        const std::vector<int> latest = longest(0, n_);
        if (latest.size() == 2 && (n_ == 1 || good(0, n_))) {
            return {0};
        }
        for (int i = 0; i < kMostPlans; ++i) {
            const Plan plan = cheapest(latest, n_);
            if (plan.cost == kNever) {
                break;
            }
            if (holds(plan, n_)) {
                return plan.firsts;
            }
        }
        return by_trial(0, n_);
    }

    std::optional<int> single_opening() const {
        std::vector<int> cells(static_cast<std::size_t>(n_));
        std::iota(cells.begin(), cells.end(), 0);
        std::stable_sort(cells.begin(), cells.end(),
                         [&](int one, int other) { return joint_cost(one) < joint_cost(other); });
        const int tries = std::min(n_, kMostOpenings);
        for (int k = 0; k < tries; ++k) {
            if (good(cells[static_cast<std::size_t>(k)], n_)) {
                return cells[static_cast<std::size_t>(k)];
            }
        }
        return std::nullopt;
    }

    // Any way to part a closed run has a joint behind its cell 0 and within the longest run there.
    std::vector<int> closed() {
        if (const std::optional<int> opening = single_opening()) {
            return {*opening};
        }
        const int window = std::min(n_, end_of(0));
        for (int i = 0; i < kMostPlans; ++i) {
            Plan best;
            for (int start = 1; start <= window; ++start) {
                const std::vector<int> latest = longest(start, start + n_);
                if (latest.size() == 2 && good(start, n_)) {
                    return {start % n_};
                }
                if (!best.firsts.empty() && latest.size() - 1 > best.firsts.size()) {
                    continue;
                }
                Plan plan = cheapest(latest, start + n_);
                const bool fewer = !best.firsts.empty() && plan.firsts.size() < best.firsts.size();
                if (plan.cost < kNever && (fewer || plan.cost < best.cost)) {
                    best = std::move(plan);
                }
            }
            if (best.cost == kNever) {
                break;
            }
            if (holds(best, best.firsts.front() + n_)) {
                return wrapped(best.firsts);
            }
        }
        return wrapped(by_trial(0, n_));
    }

    std::vector<int> wrapped(std::vector<int> firsts) const {
        for (int& first : firsts) {
            first %= n_;
        }
        std::sort(firsts.begin(), firsts.end());
        return firsts;
    }

    const PartingProblem& problem_;
    int n_;
    std::vector<double> at_;             // Length before each cell, twice round.
    std::map<int, int> ends_;            // Of the longest good runs, by first cell.
    std::set<std::pair<int, int>> bad_;  // Runs that are not good although they should be.
};

}  // namespace

std::vector<int> plan_parting(const PartingProblem& problem) {
    return problem.cells > 0 ? Planner(problem).plan() : std::vector<int>{};
}

}  // namespace leafcutter::fab
