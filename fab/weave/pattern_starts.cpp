#include "fab/weave/pattern_starts.h"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <limits>
#include <optional>
#include <tuple>
#include <utility>

namespace leafcutter::fab {

namespace {

constexpr std::size_t kMostEntries = 1U << 22U;

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

// Costs of some regions' starts: those of the first vary slowest.
struct Table {
    std::vector<int> regions;  // Ascending.
    std::vector<double> cost;
};

// A region that is gone, and its best start for each choice of those it met.
struct Eliminated {
    int region = 0;
    std::vector<int> met;  // Ascending.
    std::vector<int> best;
};

class Elimination {
public:
    Elimination(int regions, int starts, const std::vector<StartCost>& costs)
        : starts_(at(starts)), gone_(at(regions), 0) {
        for (const StartCost& pair : costs) {
            tables_.push_back(as_table(pair));
        }
    }

    // None if a table would become too large.
    std::optional<PatternStarts> run() {
        for (std::size_t i = 0; i < gone_.size(); ++i) {
            if (!eliminate(next_region())) {
                return std::nullopt;
            }
        }
        PatternStarts result;
        result.start.assign(gone_.size(), 0);
        for (std::size_t i = order_.size(); i-- > 0;) {
            const Eliminated& step = order_[i];
            result.start[at(step.region)] = step.best[place(step.met, result.start)];
        }
        for (const Table& table : tables_) {
            result.cost += table.cost.front();
        }
        return result;
    }

private:
    Table as_table(const StartCost& pair) const {
        if (pair.one <= pair.other) {
            return {{pair.one, pair.other}, pair.cost};
        }
        Table table{{pair.other, pair.one}, std::vector<double>(pair.cost.size())};
        for (std::size_t i = 0; i < starts_; ++i) {
            for (std::size_t j = 0; j < starts_; ++j) {
                table.cost[j * starts_ + i] = pair.cost[i * starts_ + j];
            }
        }
        return table;
    }

    // Where the starts of these regions stand in a table of them.
    std::size_t place(const std::vector<int>& regions, const std::vector<int>& start) const {
        std::size_t index = 0;
        for (const int region : regions) {
            index = index * starts_ + at(start[at(region)]);
        }
        return index;
    }

    std::vector<int> met_by(int region) const {
        std::vector<int> met;
        for (const Table& table : tables_) {
            if (std::binary_search(table.regions.begin(), table.regions.end(), region)) {
                met.insert(met.end(), table.regions.begin(), table.regions.end());
            }
        }
        std::sort(met.begin(), met.end());
        met.erase(std::unique(met.begin(), met.end()), met.end());
        met.erase(std::remove(met.begin(), met.end(), region), met.end());
        return met;
    }

    // The one that meets the fewest others.
    int next_region() const {
        int next = -1;
        std::size_t fewest = std::numeric_limits<std::size_t>::max();
        for (std::size_t region = 0; region < gone_.size(); ++region) {
            if (gone_[region] != 0) {
                continue;
            }
            const std::size_t met = met_by(static_cast<int>(region)).size();
            if (met < fewest) {
                fewest = met;
                next = static_cast<int>(region);
            }
        }
        return next;
    }

    bool eliminate(int region) {
        Table joined{met_by(region), {}};
        std::size_t entries = 1;
        for (std::size_t i = 0; i < joined.regions.size(); ++i) {
            entries *= starts_;
            if (entries * starts_ > kMostEntries) {
                return false;
            }
        }
        const auto own =
            std::stable_partition(tables_.begin(), tables_.end(), [region](const Table& table) {
                return !std::binary_search(table.regions.begin(), table.regions.end(), region);
            });
        const std::vector<Table> mine(std::make_move_iterator(own),
                                      std::make_move_iterator(tables_.end()));
        tables_.erase(own, tables_.end());
        Eliminated step{region, joined.regions, std::vector<int>(entries)};
        joined.cost.resize(entries);
        std::vector<int> start(gone_.size(), 0);
        for (std::size_t entry = 0; entry < entries; ++entry) {
            std::size_t rest = entry;
            for (std::size_t i = joined.regions.size(); i-- > 0; rest /= starts_) {
                start[at(joined.regions[i])] = static_cast<int>(rest % starts_);
            }
            std::tie(joined.cost[entry], step.best[entry]) = best_of(mine, region, start);
        }
        gone_[at(region)] = 1;
        tables_.push_back(std::move(joined));
        order_.push_back(std::move(step));
        return true;
    }

    std::pair<double, int> best_of(const std::vector<Table>& tables,
                                   int region,
                                   std::vector<int>& start) const {
        std::pair<double, int> best{std::numeric_limits<double>::infinity(), 0};
        for (int own = 0; own < static_cast<int>(starts_); ++own) {
            start[at(region)] = own;
            double cost = 0.0;
            for (const Table& table : tables) {
                cost += table.cost[place(table.regions, start)];
            }
            if (cost < best.first) {
                best = {cost, own};
            }
        }
        return best;
    }

    std::size_t starts_;
    std::vector<Table> tables_;
    std::vector<Eliminated> order_;
    std::vector<char> gone_;
};

// One region after the other takes its best start, until none gains.
PatternStarts improve(int regions, int starts, const std::vector<StartCost>& costs) {
    PatternStarts result;
    result.start.assign(at(regions), 0);
    result.proven = false;
    const auto total = [&] {
        double sum = 0.0;
        for (const StartCost& pair : costs) {
            sum += pair.cost[at(result.start[at(pair.one)]) * at(starts) +
                             at(result.start[at(pair.other)])];
        }
        return sum;
    };
    result.cost = total();
    for (bool better = true; better;) {
        better = false;
        for (int& own : result.start) {
            int best = own;
            for (int start = 0; start < starts; ++start) {
                own = start;
                const double cost = total();
                if (cost < result.cost) {
                    result.cost = cost;
                    best = start;
                    better = true;
                }
            }
            own = best;
        }
    }
    return result;
}

}  // namespace

PatternStarts choose_starts(int regions, int starts, const std::vector<StartCost>& costs) {
    std::optional<PatternStarts> exact = Elimination(regions, starts, costs).run();
    return exact ? std::move(*exact) : improve(regions, starts, costs);
}

}  // namespace leafcutter::fab
