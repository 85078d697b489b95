#include "fab/weave/lay_order.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <tuple>
#include <utility>

#include "fab/weave/lay_front.h"

namespace leafcutter::fab {

namespace {

constexpr int kNever = std::numeric_limits<int>::max();
// Cells looked at while beginnings are tried, in all; one beginning looks at about eight times as
// many as there are.
constexpr std::size_t kMostLooks = 40'000'000;
constexpr std::size_t kLooksPerCell = 8;

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

class LaySearch {
public:
    LaySearch(const LayProblem& problem, std::span<const int> members, Family base)
        : problem_(problem),
          members_(members),
          base_(base),
          front_(problem, members, base),
          steps_(problem.strips.size()),
          state_(problem.strips.size(), State::Base) {
        for (const int strip : members) {
            if (problem.strips[at(strip)].family != base) {
                woven_.push_back(strip);
                add_steps(strip);
            }
        }
    }

    LayOrder run() {
        const std::size_t tries =
            std::clamp(kMostLooks / (kLooksPerCell * std::max<std::size_t>(cells_, 1)),
                       std::size_t{1}, std::max<std::size_t>(woven_.size(), 1));
        Trial best;
        best.threaded = kNever;
        for (std::size_t i = 0; i < tries && best.threaded > 0; ++i) {
            Trial trial = grow(woven_.empty() ? -1 : woven_[i * woven_.size() / tries]);
            if (trial.threaded < best.threaded) {
                best = std::move(trial);
            }
        }
        return finished(best);
    }

private:
    enum class State { Base, Waiting, AtFront, Laid };

    struct Trial {
        std::vector<std::pair<int, bool>> order;  // Strip, backwards.
        int threaded = 0;
    };

    struct Choice {
        int threaded = 0;
        int gaps = 0;
        bool apart = false;  // Not beside what was woven in last.
        int strip = -1;
        bool backwards = false;

        auto rank() const { return std::tie(threaded, gaps, apart, strip); }
    };

    void add_steps(int strip) {
        const std::vector<Crossing>& crossings = problem_.crossings[at(strip)];
        const int count = static_cast<int>(crossings.size());
        const int first =
            problem_.strips[at(strip)].closed ? problem_.joints[at(strip)].front() : 0;
        for (int i = 0; i < count; ++i) {
            const int cell = (first + i) % count;
            const Crossing& crossing = crossings[at(cell)];
            steps_[at(strip)].push_back({cell, crossing.strip, crossing.cell, !crossing.on_top});
        }
        cells_ += crossings.size();
    }

    Trial grow(int first) {
        Trial trial;
        front_.clear();
        for (const int strip : woven_) {
            state_[at(strip)] = State::Waiting;
        }
        at_front_.clear();
        int last = -1;
        for (std::size_t done = 0; done < woven_.size(); ++done) {
            if (done == 0) {
                at_front_.push_back(first);
            } else if (at_front_.empty()) {
                at_front_.push_back(*std::find_if(woven_.begin(), woven_.end(), [&](int strip) {
                    return state_[at(strip)] == State::Waiting;
                }));
            }
            const Choice choice = best_at_front(last);
            last = choice.strip;
            lay(choice);
            trial.order.emplace_back(choice.strip, choice.backwards);
            trial.threaded += choice.threaded;
        }
        return trial;
    }

    Choice best_at_front(int last) {
        Choice best;
        for (const int strip : at_front_) {
            const Choice choice = choice_of(strip, last);
            if (best.strip < 0 || choice.rank() < best.rank()) {
                best = choice;
            }
        }
        return best;
    }

    Choice choice_of(int strip, int last) {
        const std::vector<LayStep>& steps = steps_[at(strip)];
        Choice choice{.threaded = front_.threaded(steps, false),
                      .gaps = 0,
                      .apart = true,
                      .strip = strip,
                      .backwards = false};
        if (choice.threaded > 0) {
            const int other = front_.threaded(steps, true);
            choice.backwards = other < choice.threaded;
            choice.threaded = std::min(other, choice.threaded);
        }
        for (const LayStep& step : steps) {
            choice.gaps += front_.leaves_gap(step) ? 1 : 0;
            choice.apart = choice.apart && !lies_beside(step, last);
        }
        return choice;
    }

    int strip_at(int base_strip, int cell) const {
        return problem_.crossings[at(base_strip)][at(cell)].strip;
    }

    bool lies_beside(const LayStep& step, int last) const {
        const auto beside = front_.cells_beside(step);
        return std::any_of(beside.begin(), beside.end(), [&](int cell) {
            return cell >= 0 && strip_at(step.strip, cell) == last;
        });
    }

    void lay(const Choice& choice) {
        const std::vector<LayStep>& steps = steps_[at(choice.strip)];
        front_.lay(steps, choice.backwards);
        state_[at(choice.strip)] = State::Laid;
        at_front_.erase(std::find(at_front_.begin(), at_front_.end(), choice.strip));
        for (const LayStep& step : steps) {
            for (const int cell : front_.cells_beside(step)) {
                const int beside = cell < 0 ? choice.strip : strip_at(step.strip, cell);
                if (state_[at(beside)] == State::Waiting) {
                    state_[at(beside)] = State::AtFront;
                    at_front_.push_back(beside);
                }
            }
        }
    }

    // Joints that needn't stay open are left out, and what has to be threaded is found again.
    LayOrder finished(const Trial& trial) {
        LayOrder order;
        order.base = base_;
        order.open_joints.resize(problem_.strips.size());
        times_.assign(problem_.strips.size(), {});
        for (const int strip : members_) {
            times_[at(strip)].resize(problem_.strips[at(strip)].quads.size());
        }
        int now = 0;
        for (const auto& [strip, backwards] : trial.order) {
            const std::vector<LayStep>& steps = steps_[at(strip)];
            for (std::size_t i = 0; i < steps.size(); ++i) {
                const LayStep& step = steps[backwards ? steps.size() - 1 - i : i];
                times_[at(step.strip)][at(step.cell)] = now++;
                order.folds += step.under ? 1 : 0;
            }
        }
        std::vector<std::vector<char>> is_held(problem_.strips.size());
        for (const int strip : members_) {
            if (problem_.strips[at(strip)].family == base_) {
                order.open_joints[at(strip)] = fewest_open(strip);
                is_held[at(strip)] = held_cells(strip, order.open_joints[at(strip)]);
            }
        }
        for (const auto& [strip, backwards] : trial.order) {
            WovenIn woven{strip, {}, {}};
            const std::vector<LayStep>& steps = steps_[at(strip)];
            for (std::size_t i = 0; i < steps.size(); ++i) {
                const LayStep& step = steps[backwards ? steps.size() - 1 - i : i];
                woven.cells.push_back(step.own);
                if (is_held[at(step.strip)][at(step.cell)] != 0) {
                    woven.held.push_back(step.own);
                }
            }
            order.threaded_crossings += static_cast<int>(woven.held.size());
            order.longest_thread =
                std::max(order.longest_thread, static_cast<int>(woven.held.size()));
            order.woven.push_back(std::move(woven));
        }
        return order;
    }

    std::vector<int> fewest_open(int index) const {
        const bool closed = problem_.strips[at(index)].closed;
        std::vector<int> open = problem_.joints[at(index)];
        const auto held = [&](const std::vector<int>& joints) {
            const auto cells = held_cells(index, joints);
            return std::count(cells.begin(), cells.end(), 1);
        };
        const auto least = held(open);
        for (std::size_t i = 0; i < open.size() && open.size() > (closed ? 1U : 0U);) {
            std::vector<int> fewer = open;
            fewer.erase(fewer.begin() + static_cast<std::ptrdiff_t>(i));
            if (held(fewer) <= least) {
                open = std::move(fewer);
            } else {
                ++i;
            }
        }
        return open;
    }

    // Per cell of a base strip whether what is laid under it there comes between earlier ones that
    // hold it down on both sides.
    std::vector<char> held_cells(int index, const std::vector<int>& joints) const {
        const std::vector<Crossing>& crossings = problem_.crossings[at(index)];
        const std::vector<int>& times = times_[at(index)];
        std::vector<char> held(times.size(), 0);
        for (const auto& segment : segments_of(problem_.strips[at(index)], joints)) {
            const auto mark = [&](auto first, auto last, char bit) {
                int earliest = kNever;
                for (auto cell = first; cell != last; ++cell) {
                    if (!crossings[at(*cell)].on_top) {
                        earliest = std::min(earliest, times[at(*cell)]);
                    } else if (earliest < times[at(*cell)]) {
                        held[at(*cell)] = static_cast<char>(held[at(*cell)] | bit);
                    }
                }
            };
            mark(segment.begin(), segment.end(), 1);
            mark(segment.rbegin(), segment.rend(), 2);
        }
        std::transform(held.begin(), held.end(), held.begin(),
                       [](char bits) { return static_cast<char>(bits == 3 ? 1 : 0); });
        return held;
    }

    const LayProblem& problem_;
    std::span<const int> members_;
    Family base_;
    LayFront front_;
    std::vector<std::vector<LayStep>> steps_;  // Per strip that is woven in.
    std::vector<State> state_;
    std::vector<int> woven_;  // Strips to be woven in, ascending.
    std::vector<int> at_front_;
    std::size_t cells_ = 0;
    std::vector<std::vector<int>> times_;  // Per strip and cell: when that crossing is made.
};

}  // namespace

LayOrder find_lay_order(const LayProblem& problem, std::span<const int> members, Family base) {
    return LaySearch(problem, members, base).run();
}

}  // namespace leafcutter::fab
