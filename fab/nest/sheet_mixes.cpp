#include "fab/nest/sheet_mixes.h"

#include <algorithm>
#include <numeric>

namespace leafcutter::fab {

namespace {

double rate(const SheetKind& kind) {
    return kind.cost / kind.area;
}

// Cheapest for their area first, the larger one of equal ones.
std::vector<std::size_t> by_rate(const SheetProblem& problem) {
    std::vector<std::size_t> order(problem.kinds.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        const double left = rate(problem.kinds[a]);
        const double right = rate(problem.kinds[b]);
        return left != right ? left < right : problem.kinds[a].area > problem.kinds[b].area;
    });
    return order;
}

// Counts of the kinds that cost something, one kind after the other.
class MixWalk {
public:
    MixWalk(const SheetProblem& problem,
            double below_cost,
            double area,
            std::span<const Mix> failed)
        : problem_(problem), below_(below_cost), area_(area), failed_(failed) {
        mix_.resize(problem.kinds.size());
        for (const std::size_t kind : by_rate(problem)) {
            if (problem.kinds[kind].cost > 0.0) {
                paid_.push_back(kind);
            } else {
                mix_[kind] = problem.kinds[kind].quantity.value_or(0);
                free_area_ += mix_[kind] * problem.kinds[kind].area;
            }
        }
    }

    std::optional<Mix> best() {
        walk(0, 0.0, free_area_);
        return best_;
    }

private:
    void walk(std::size_t index, double cost, double area) {
        constexpr int kMostSteps = 50'000;
        if (++steps_ > kMostSteps) {
            return;
        }
        if (index == paid_.size()) {
            const bool known = std::find(failed_.begin(), failed_.end(), mix_) != failed_.end();
            if (area >= area_ && area > best_area_ && !known) {
                best_area_ = area;
                best_ = mix_;
            }
            return;
        }
        const std::size_t kind = paid_[index];
        const SheetKind& sheet = problem_.kinds[kind];
        const double affordable = (below_ - cost) / sheet.cost;
        int most = static_cast<int>(std::min(1000.0, affordable));
        most = sheet.quantity ? std::min(most, *sheet.quantity) : most;
        for (int count = most; count >= 0; --count) {
            const double with = cost + count * sheet.cost;
            if (with < below_ * (1.0 - 1e-9)) {
                mix_[kind] = count;
                walk(index + 1, with, area + count * sheet.area);
            }
        }
        mix_[kind] = 0;
    }

    const SheetProblem& problem_;
    double below_;
    double area_;
    std::span<const Mix> failed_;
    std::vector<std::size_t> paid_;
    double free_area_ = 0.0;
    Mix mix_;
    int steps_ = 0;
    double best_area_ = 0.0;
    std::optional<Mix> best_;
};

}  // namespace

std::vector<std::vector<SheetRun>> first_offers(const SheetProblem& problem) {
    const std::vector<std::size_t> order = by_rate(problem);
    std::vector<std::size_t> endless;
    for (const std::size_t kind : order) {
        if (!problem.kinds[kind].quantity) {
            endless.push_back(kind);
        }
    }
    const auto run_of = [&](std::size_t kind) {
        return SheetRun{kind, problem.kinds[kind].quantity};
    };
    std::vector<std::vector<SheetRun>> offers;
    if (endless.empty()) {
        offers.emplace_back();
        for (const std::size_t kind : order) {
            offers.back().push_back(run_of(kind));
        }
        return offers;
    }
    const auto is_cheap = [&](std::size_t kind) {
        return problem.kinds[kind].quantity &&
               rate(problem.kinds[kind]) <= rate(problem.kinds[endless.front()]);
    };
    const auto offer = [&](std::size_t first, bool cheap_ones_before) {
        std::vector<SheetRun> runs;
        std::vector<SheetRun> behind;
        for (const std::size_t kind : order) {
            if (kind != first) {
                (cheap_ones_before && is_cheap(kind) ? runs : behind).push_back(run_of(kind));
            }
        }
        runs.push_back(run_of(first));
        runs.insert(runs.end(), behind.begin(), behind.end());
        offers.push_back(std::move(runs));
    };
    const bool any_cheap = std::any_of(order.begin(), order.end(), is_cheap);
    for (const std::size_t first : endless) {
        offer(first, true);
    }
    if (any_cheap) {
        offer(endless.front(), false);
    }
    return offers;
}

std::optional<Mix> roomiest_cheaper_mix(const SheetProblem& problem,
                                        std::span<const std::size_t> kinds,
                                        double area,
                                        std::span<const Mix> failed) {
    double cost = 0.0;
    for (const std::size_t kind : kinds) {
        cost += problem.kinds[kind].cost;
    }
    return MixWalk(problem, cost, area, failed).best();
}

std::vector<SheetRun> runs_of(const SheetProblem& problem, const Mix& mix) {
    std::vector<SheetRun> runs;
    for (const std::size_t kind : by_rate(problem)) {
        if (mix[kind] > 0) {
            runs.push_back({kind, mix[kind]});
        }
    }
    return runs;
}

}  // namespace leafcutter::fab
