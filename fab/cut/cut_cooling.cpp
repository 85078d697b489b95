// Local search on travel + price · Σ excess: the excess of a path is how far its heat index lies
// over the one aimed at. Only paths with an excess, and those before them, are moved. The price
// rises from round to round, so that cheap changes are made first.

#include "fab/cut/cut_cooling.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace leafcutter::fab {

namespace {

using Eigen::Vector2d;

constexpr double kFirstPrice = 1.0;  // Of an excess of 1, in mean ways from path to path.
constexpr double kPriceGrowth = 2.0;
constexpr int kRounds = 9;
constexpr std::size_t kTried = 8;  // Starts of a path that are looked at with all they change.
constexpr std::size_t kStep = 3;   // How far along the order a path is moved at least tried.
constexpr double kGainMm = 1e-6;

class Cooling {
public:
    Cooling(const CoolingTask& task,
            std::vector<OrderedPath> order,
            const geometry::Context& context)
        : task_(task),
          context_(context),
          order_(std::move(order)),
          places_(order_.size()),
          position_(order_.size()),
          index_(order_.size()),
          earlier_(order_.size()),
          later_(order_.size()) {
        for (const auto& [first, second] : task.before) {
            earlier_[second].push_back(first);
            later_[first].push_back(second);
        }
        refresh();
        mean_way_mm_ = travel() / static_cast<double>(std::max<std::size_t>(1, order_.size()));
        aim_ = (1.0 - task.heat) * peak();
    }

    std::vector<OrderedPath> run() {
        constexpr double kNoHeat = 1e-3;
        if (order_.size() < 2 || peak() < kNoHeat) {
            return order_;
        }
        std::vector<OrderedPath> best = order_;
        double least = peak();
        aim_ = std::max(aim_, kNoHeat);
        price_mm_ = kFirstPrice * mean_way_mm_;
        for (int round = 0; round < kRounds && peak() > aim_; ++round) {
            for (const std::size_t path : hot_paths()) {
                context_.check();
                improve(path);
            }
            refresh();
            if (peak() < least) {
                least = peak();
                best = order_;
            }
            price_mm_ *= kPriceGrowth;
        }
        return best;
    }

private:
    // A changed order, and what is known of it.
    struct Trial {
        std::vector<OrderedPath> order;
        std::vector<std::size_t> touched;  // Paths whose index may be another.
    };

    double travel_of(const std::vector<OrderedPath>& order) const {
        double sum = 0.0;
        Vector2d at = task_.from;
        for (const OrderedPath& place : order) {
            sum += (task_.model.entry(place) - at).norm();
            at = task_.model.exit(place);
        }
        return sum;
    }
    double travel() const { return travel_of(order_); }
    double peak() const { return *std::max_element(index_.begin(), index_.end()); }
    double excess(double index) const { return std::max(0.0, index / aim_ - 1.0); }

    void refresh() {
        for (std::size_t i = 0; i < order_.size(); ++i) {
            places_[order_[i].path] = order_[i];
            position_[order_[i].path] = i;
        }
        begins_ = task_.model.begins_s(order_, task_.from);
        for (const OrderedPath& place : order_) {
            index_[place.path] = task_.model.index(place, begins_[place.path], places_, begins_);
        }
    }

    std::vector<std::size_t> hot_paths() const {
        std::vector<std::size_t> hot;
        for (std::size_t path = 0; path < index_.size(); ++path) {
            if (index_[path] > aim_) {
                hot.push_back(path);
            }
        }
        std::stable_sort(hot.begin(), hot.end(),
                         [&](std::size_t a, std::size_t b) { return index_[a] > index_[b]; });
        return hot;
    }

    void improve(std::size_t path) {
        if (index_[path] <= aim_ || try_starts(path) || try_positions(path)) {
            return;
        }
        if (position_[path] > 0) {
            try_starts(order_[position_[path] - 1].path);
        }
    }

    // All ways to run a path.
    std::vector<OrderedPath> ways(std::size_t path) const {
        std::vector<OrderedPath> ways;
        for (const bool backward : {false, true}) {
            if (!task_.model.closed(path)) {
                ways.push_back({path, 0.0, backward});
                continue;
            }
            for (const double start : task_.starts_mm[path]) {
                ways.push_back({path, start, backward});
            }
        }
        return ways;
    }

    // Those that promise the most: by their own way and their own heat alone.
    std::vector<OrderedPath> best_ways(std::size_t path, std::size_t position) {
        const Vector2d before = position == 0 ? task_.from : task_.model.exit(order_[position - 1]);
        std::vector<std::pair<double, std::size_t>> costs;
        std::vector<OrderedPath> all = ways(path);
        for (std::size_t i = 0; i < all.size(); ++i) {
            double cost = (task_.model.entry(all[i]) - before).norm();
            if (position + 1 < order_.size()) {
                cost += (task_.model.entry(order_[position + 1]) - task_.model.exit(all[i])).norm();
            }
            cost += price_mm_ * excess(task_.model.index(all[i], begins_[path], places_, begins_));
            costs.emplace_back(cost, i);
        }
        std::sort(costs.begin(), costs.end());
        std::vector<OrderedPath> best;
        for (std::size_t i = 0; i < std::min(kTried, costs.size()); ++i) {
            best.push_back(all[costs[i].second]);
        }
        return best;
    }

    bool try_starts(std::size_t path) {
        const std::size_t position = position_[path];
        std::vector<std::size_t> touched = task_.model.near(path);
        touched.push_back(path);
        for (const OrderedPath& way : best_ways(path, position)) {
            Trial trial{order_, touched};
            trial.order[position] = way;
            if (accept(std::move(trial))) {
                return true;
            }
        }
        return false;
    }

    bool try_positions(std::size_t path) {
        const std::size_t here = position_[path];
        std::vector<std::size_t> targets;
        for (std::size_t step = 1; step <= kStep; ++step) {
            targets.push_back(here + step);
            targets.push_back(here >= step ? here - step : 0);
        }
        for (const std::size_t other : task_.model.near(path)) {
            targets.push_back(position_[other]);
            targets.push_back(position_[other] + 1);
        }
        std::sort(targets.begin(), targets.end());
        targets.erase(std::unique(targets.begin(), targets.end()), targets.end());
        return std::any_of(targets.begin(), targets.end(), [&](std::size_t target) {
            return target < order_.size() && target != here && may_move(path, target) &&
                   try_position(path, target);
        });
    }

    bool may_move(std::size_t path, std::size_t target) const {
        const auto after = [&](std::size_t other) { return position_[other] >= target; };
        const auto before = [&](std::size_t other) { return position_[other] <= target; };
        return std::none_of(earlier_[path].begin(), earlier_[path].end(), after) &&
               std::none_of(later_[path].begin(), later_[path].end(), before);
    }

    bool try_position(std::size_t path, std::size_t target) {
        const std::size_t here = position_[path];
        Trial trial{order_, task_.model.near(path)};
        trial.order.erase(trial.order.begin() + static_cast<std::ptrdiff_t>(here));
        const Vector2d before =
            target == 0 ? task_.from : task_.model.exit(trial.order[target - 1]);
        OrderedPath best = order_[here];
        double least = std::numeric_limits<double>::infinity();
        for (const OrderedPath& way : ways(path)) {
            double cost = (task_.model.entry(way) - before).norm();
            if (target < trial.order.size()) {
                cost += (task_.model.entry(trial.order[target]) - task_.model.exit(way)).norm();
            }
            if (cost < least) {
                least = cost;
                best = way;
            }
        }
        trial.order.insert(trial.order.begin() + static_cast<std::ptrdiff_t>(target), best);
        const std::size_t low = std::min(here, target);
        const std::size_t high = std::min(std::max(here, target) + 2, order_.size());
        constexpr std::size_t kLongestRun = 24;  // The ends of a longer one tell enough.
        for (std::size_t i = low; i < high; ++i) {
            if (i < low + kLongestRun || i + kLongestRun >= high) {
                trial.touched.push_back(trial.order[i].path);
            }
        }
        std::vector<OrderedPath> other_way = trial.order;
        if (accept(trial)) {
            return true;
        }
        trial.order = std::move(other_way);
        trial.order[target].backward = !trial.order[target].backward;
        return accept(std::move(trial));
    }

    // Takes the trial if it is better.
    bool accept(Trial trial) {
        std::vector<std::size_t>& touched = trial.touched;
        std::sort(touched.begin(), touched.end());
        touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
        double cost = travel_of(trial.order) - travel();
        for (const std::size_t path : touched) {
            cost -= price_mm_ * excess(index_[path]);
        }
        std::vector<OrderedPath> places(trial.order.size());
        for (const OrderedPath& place : trial.order) {
            places[place.path] = place;
        }
        const std::vector<double> begins = task_.model.begins_s(trial.order, task_.from);
        std::vector<double> indices;
        for (const std::size_t path : touched) {
            indices.push_back(task_.model.index(places[path], begins[path], places, begins));
            cost += price_mm_ * excess(indices.back());
            if (cost > -kGainMm && path == touched.back()) {
                return false;
            }
        }
        order_ = std::move(trial.order);
        places_ = std::move(places);
        begins_ = begins;
        for (std::size_t i = 0; i < order_.size(); ++i) {
            position_[order_[i].path] = i;
        }
        for (std::size_t i = 0; i < touched.size(); ++i) {
            index_[touched[i]] = indices[i];
        }
        return true;
    }

    const CoolingTask& task_;
    const geometry::Context& context_;
    std::vector<OrderedPath> order_;
    std::vector<OrderedPath> places_;  // By path, as all below.
    std::vector<std::size_t> position_;
    std::vector<double> begins_;
    std::vector<double> index_;
    std::vector<std::vector<std::size_t>> earlier_;
    std::vector<std::vector<std::size_t>> later_;
    double mean_way_mm_ = 0.0;
    double aim_ = 0.0;
    double price_mm_ = 0.0;
};

}  // namespace

std::vector<OrderedPath> cooled(const CoolingTask& task,
                                std::vector<OrderedPath> order,
                                const geometry::Context& context) {
    return Cooling(task, std::move(order), context).run();
}

}  // namespace leafcutter::fab
