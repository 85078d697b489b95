#include "geometry/loops/short_loops.h"

#include <algorithm>
#include <cstddef>
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
    std::reverse(there.begin(), there.end());
    there.insert(there.end(), back.begin(), back.end());
    for (int& state : there) {
        state = states_[at(state)].vertex;
    }
    return there;
}

std::optional<ClassedLoop> LoopSearch::loop_through(int root,
                                                    const std::vector<char>& blocked,
                                                    const Wanted& wanted,
                                                    const Context& context) {
    queue_ = {};
    states_.clear();
    state_of_place_.clear();
    const int start = state_at(root, number_of_sum(HomologyClass(edges_.rank, 0)));
    states_[at(start)].distance = 0.0;
    queue_.emplace(0.0, start);
    std::optional<ClassedLoop> found;
    const auto best = [&] { return found ? found->length : wanted.shorter_than; };
    while (!queue_.empty() && 2.0 * queue_.top().first < best() && states_.size() < kMostStates) {
        const int here = queue_.top().second;
        queue_.pop();
        if (states_[at(here)].settled) {
            continue;
        }
        context.check();
        states_[at(here)].settled = true;
        const int v = states_[at(here)].vertex;
        for (int k = rings_.begin[at(v)]; k < rings_.begin[at(v) + 1]; ++k) {
            const RingSlot& slot = rings_.slots[at(k)];
            if (blocked[at(slot.neighbour)] == 0) {
                go_along(here, slot, {wanted.homology, best()}, found);
            }
        }
    }
    return found;
}

// Reaches the next place, or closes a loop there.
void LoopSearch::go_along(int here,
                          const RingSlot& slot,
                          const Wanted& wanted,
                          std::optional<ClassedLoop>& found) {
    const int sum = sum_after(states_[at(here)].sum, slot);
    const int there = state_at(slot.neighbour, sum);
    State& to = states_[at(there)];
    const double length = states_[at(here)].distance + edges_.length[at(slot.edge)];
    if (!to.settled) {
        if (to.distance < 0.0 || length < to.distance) {
            to.distance = length;
            to.parent = here;
            to.sum = sum;
            queue_.emplace(length, there);
        }
        return;
    }
    if (to.sum == sum || length + to.distance >= wanted.shorter_than) {
        return;
    }
    HomologyClass homology = difference(sum, to.sum);
    if (!wanted.homology(homology)) {
        return;
    }
    std::vector<int> loop = close(here, there);
    if (is_simple(loop)) {
        found = ClassedLoop{std::move(loop), std::move(homology), length + to.distance};
    }
}

}  // namespace leafcutter::geometry
