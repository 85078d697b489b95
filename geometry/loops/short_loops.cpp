#include "geometry/loops/short_loops.h"

#include <algorithm>
#include <cstddef>
#include <queue>
#include <utility>

namespace leafcutter::geometry {
namespace {

// A covering surface may have any number of sheets within reach; beyond this many places a search
// ends with what it has.
constexpr std::size_t kMostStates = 400000;

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

bool is_simple(std::vector<int> vertices) {
    std::sort(vertices.begin(), vertices.end());
    return vertices.size() >= 3 &&
           std::adjacent_find(vertices.begin(), vertices.end()) == vertices.end();
}

}  // namespace

LoopSearch::LoopSearch(const VertexRings& rings,
                       const ClassedEdges& edges,
                       IntegerMatrix annihilator)
    : rings_(rings), edges_(edges), annihilator_(std::move(annihilator)) {}

int LoopSearch::number_of_sum(const HomologyClass& sum) {
    const auto [place, fresh] = numbers_.emplace(sum, static_cast<int>(sums_.size()));
    if (fresh) {
        sums_.push_back(sum);
        HomologyClass sheet(static_cast<std::size_t>(annihilator_.cols()), 0);
        for (std::size_t j = 0; j < sheet.size(); ++j) {
            for (std::size_t i = 0; i < sum.size(); ++i) {
                sheet[j] += sum[i] * annihilator_(static_cast<Eigen::Index>(i),
                                                  static_cast<Eigen::Index>(j));
            }
        }
        sheet_of_sum_.push_back(
            sheets_.emplace(std::move(sheet), static_cast<int>(sheets_.size())).first->second);
    }
    return place->second;
}

int LoopSearch::sum_after(int sum, const RingSlot& slot) {
    const HomologyClass& value = edges_.value[at(slot.edge)];
    if (value.empty()) {
        return sum;
    }
    HomologyClass after = sums_[at(sum)];
    for (std::size_t k = 0; k < after.size(); ++k) {
        after[k] += slot.forward ? value[k] : -value[k];
    }
    return number_of_sum(after);
}

HomologyClass LoopSearch::difference(int a, int b) const {
    HomologyClass out = sums_[at(a)];
    for (std::size_t k = 0; k < out.size(); ++k) {
        out[k] -= sums_[at(b)][k];
    }
    return out;
}

int LoopSearch::state_at(int vertex, int sum) {
    const auto key = (static_cast<std::uint64_t>(sheet_of_sum_[at(sum)]) << 32U) |
                     static_cast<std::uint32_t>(vertex);
    const auto [place, fresh] = state_of_place_.emplace(key, static_cast<int>(states_.size()));
    if (fresh) {
        states_.push_back({vertex, sum, -1, -1.0, false});
    }
    return place->second;
}

// The loop of the tree's ways to both states and the edge between them, without the common start.
std::vector<int> LoopSearch::close(int a, int b) const {
    const auto to_root = [&](int state) {
        std::vector<int> way;
        for (; state >= 0; state = states_[at(state)].parent) {
            way.push_back(state);
        }
        return way;
    };
    std::vector<int> there = to_root(a);
    std::vector<int> back = to_root(b);
    while (there.size() > 1 && back.size() > 1 &&
           there[there.size() - 2] == back[back.size() - 2]) {
        there.pop_back();
        back.pop_back();
    }
    back.pop_back();
    std::vector<int> vertices;
    for (auto s = there.rbegin(); s != there.rend(); ++s) {
        vertices.push_back(states_[at(*s)].vertex);
    }
    for (const int s : back) {
        vertices.push_back(states_[at(s)].vertex);
    }
    return vertices;
}

std::optional<ClassedLoop> LoopSearch::loop_through(int root,
                                                    const std::vector<char>& blocked,
                                                    const Wanted& wanted,
                                                    const Context& context) {
    using Entry = std::pair<double, int>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
    states_.clear();
    state_of_place_.clear();
    const int start = state_at(root, number_of_sum(HomologyClass(edges_.rank, 0)));
    states_[at(start)].distance = 0.0;
    queue.emplace(0.0, start);
    double best = wanted.shorter_than;
    std::optional<ClassedLoop> found;
    while (!queue.empty() && 2.0 * queue.top().first < best && states_.size() < kMostStates) {
        const auto [distance, here] = queue.top();
        queue.pop();
        if (states_[at(here)].settled) {
            continue;
        }
        context.check();
        states_[at(here)].settled = true;
        const State from = states_[at(here)];
        for (int k = rings_.begin[at(from.vertex)]; k < rings_.begin[at(from.vertex) + 1]; ++k) {
            const RingSlot& slot = rings_.slots[at(k)];
            if (blocked[at(slot.neighbour)] != 0) {
                continue;
            }
            const int sum = sum_after(from.sum, slot);
            const int there = state_at(slot.neighbour, sum);
            State& to = states_[at(there)];
            const double length = distance + edges_.length[at(slot.edge)];
            if (!to.settled) {
                if (to.distance < 0.0 || length < to.distance) {
                    to.distance = length;
                    to.parent = here;
                    to.sum = sum;
                    queue.emplace(length, there);
                }
            } else if (to.sum != sum && length + to.distance < best) {
                HomologyClass homology = difference(sum, to.sum);
                if (!wanted.homology(homology)) {
                    continue;
                }
                std::vector<int> loop = close(here, there);
                if (is_simple(loop)) {
                    best = length + to.distance;
                    found = ClassedLoop{std::move(loop), std::move(homology), best};
                }
            }
        }
    }
    return found;
}

}  // namespace leafcutter::geometry
