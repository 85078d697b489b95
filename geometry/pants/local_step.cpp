#include "geometry/pants/local_step.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace leafcutter::geometry {
namespace {

// How far before a node a blocked vertex stands, by the weight of its edge.
constexpr double kBeforeNode = 1e-7;
// A vertex pushed through a node stays before the next one.
constexpr double kLongestPush = 0.9;
// More nodes than a vertex passes in one step on any sane map.
constexpr int kMostHops = 64;

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

// Dart `k` of a word read from its end if not `forward`.
Dart dart_of(const Word& word, std::size_t k, bool forward) {
    return forward ? word[k] : reversed(word[word.size() - 1 - k]);
}

}  // namespace

LocalStep::LocalStep(GraphMap& map, const VertexRings& rings, std::span<const double> weights)
    : map_(map), rings_(rings), weights_(weights) {
    journal_.gauge.assign(map.t.size(), 1);
}

const Word& LocalStep::word_at(int slot) const {
    return map_.words[at(rings_.slots[at(slot)].edge)];
}

void LocalStep::look(int v) {
    seen_.clear();
    const double weight = map_.weight(map_.graph_edge[at(v)]);
    for (int k = rings_.begin[at(v)]; k < rings_.begin[at(v) + 1]; ++k) {
        const RingSlot& slot = rings_.slots[at(k)];
        const Word& word = map_.words[at(slot.edge)];
        Seen seen;
        seen.slot = k;
        seen.darts = word.size();
        seen.weight = weights_[at(slot.edge)];
        if (word.empty()) {
            seen.place = map_.t[at(slot.neighbour)];
        } else {
            seen.first = dart_of(word, 0, slot.forward);
            seen.second = dart_of(word, 1, slot.forward);
            const Dart back = reversed(dart_of(word, word.size() - 1, slot.forward));
            const double beyond = map_.inner_length(word) + map_.remaining(slot.neighbour, back);
            seen.place = runs_forward(seen.first) ? weight + beyond : -beyond;
        }
        seen_.push_back(seen);
    }
}

// Two neighbours beyond the node are in different edges of the tree exactly if the path from one to
// the other is what is left of their words beyond it, put together.
bool LocalStep::same_leg(const Seen& a, const Seen& b, const RingSlot& slot) const {
    return slot.link >= 0 && map_.words[at(slot.link)].size() + 2 != a.darts + b.darts;
}

// Numbers the legs beyond the end of `dart` and returns the number of separate runs of neighbours
// there.
int LocalStep::part_legs(Dart dart) {
    const std::size_t count = seen_.size();
    for (Seen& seen : seen_) {
        seen.leg = -1;
    }
    const auto crosses = [&](std::size_t k) { return seen_[k % count].first == dart; };
    std::size_t start = 0;
    while (start < count && crosses(start)) {
        ++start;
    }
    const bool all = start == count;
    start = all ? 0 : start;
    legs_ = 0;
    int runs = all ? 1 : 0;
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t k = (start + i) % count;
        if (!crosses(k)) {
            continue;
        }
        const std::size_t before = (k + count - 1) % count;
        const bool continues = i > 0 && crosses(before);
        runs += !continues && !all ? 1 : 0;
        const RingSlot& slot = rings_.slots[at(seen_[before].slot)];
        seen_[k].leg =
            continues && same_leg(seen_[before], seen_[k], slot) ? seen_[before].leg : legs_++;
    }
    if (all && legs_ > 1) {
        join_last_leg();
    }
    return runs;
}

// Where all neighbours are beyond the node, the last leg may go on in the first.
void LocalStep::join_last_leg() {
    const RingSlot& slot = rings_.slots[at(seen_.back().slot)];
    if (!same_leg(seen_.back(), seen_.front(), slot)) {
        return;
    }
    const int merged = seen_.back().leg;
    for (Seen& seen : seen_) {
        seen.leg = seen.leg == merged ? 0 : seen.leg;
    }
}

void LocalStep::hop(int v, Hop through) {
    const auto [dart, leg] = through;
    Dart onto = -1;
    for (const Seen& seen : seen_) {
        if (seen.leg == leg) {
            onto = seen.second;
        }
    }
    for (const Seen& seen : seen_) {
        const RingSlot& slot = rings_.slots[at(seen.slot)];
        Word& stored = map_.words[at(slot.edge)];
        if (journal_.on) {
            journal_.words.emplace_back(slot.edge, stored);
        }
        Word word = slot.forward ? std::move(stored) : reversed(stored);
        if (word.empty()) {
            word = {reversed(onto), reversed(dart)};
        } else if (word.front() != dart) {
            word.insert(word.begin(), reversed(onto));
        } else if (seen.leg != leg) {
            word.front() = reversed(onto);
        } else {
            word.erase(word.begin());
            if (word.size() == 1) {
                word.clear();
            }
        }
        stored = slot.forward ? std::move(word) : reversed(word);
    }
    if (runs_forward(onto) != runs_forward(dart)) {
        journal_.gauge[at(v)] = static_cast<signed char>(-journal_.gauge[at(v)]);
    }
    map_.graph_edge[at(v)] = edge_of(onto);
    map_.t[at(v)] = runs_forward(onto) ? 0.0 : map_.weight(edge_of(onto));
}

Standing LocalStep::centre(int v) {
    for (int hops = 0; hops < kMostHops; ++hops) {
        look(v);
        double total = 0.0;
        double moment = 0.0;
        for (const Seen& seen : seen_) {
            total += seen.weight;
            moment += seen.weight * seen.place;
        }
        const double weight = map_.weight(map_.graph_edge[at(v)]);
        const double place = moment / total;
        if (place >= 0.0 && place <= weight) {
            map_.t[at(v)] = place;
            return Standing::Free;
        }
        const bool forward = place > weight;
        const Dart dart = 2 * map_.graph_edge[at(v)] + (forward ? 0 : 1);
        const double node = forward ? weight : 0.0;
        const int runs = part_legs(dart);
        map_.t[at(v)] = node;
        if (runs == 0) {
            return Standing::Free;  // An end node: nothing lies beyond.
        }
        if (runs > 1) {
            map_.t[at(v)] = forward ? weight * (1.0 - kBeforeNode) : weight * kBeforeNode;
            return Standing::Blocked;
        }
        double all = 0.0;
        std::vector<double> pull(at(legs_), 0.0);
        for (const Seen& seen : seen_) {
            const double share = seen.weight * std::abs(seen.place - node);
            all += share;
            if (seen.leg >= 0) {
                pull[at(seen.leg)] += 2.0 * share;
            }
        }
        const auto strongest = std::max_element(pull.begin(), pull.end());
        if (*strongest <= all) {
            return Standing::Stuck;
        }
        hop(v, {.dart = dart, .leg = static_cast<int>(strongest - pull.begin())});
    }
    return Standing::Stuck;
}

int LocalStep::push_through(int v, Dart dart, double overshoot) {
    look(v);
    const int runs = part_legs(dart);
    if (runs != 1) {
        return runs;
    }
    std::vector<double> weight(at(legs_), 0.0);
    for (const Seen& seen : seen_) {
        if (seen.leg >= 0) {
            weight[at(seen.leg)] += seen.weight;
        }
    }
    const auto heaviest = std::max_element(weight.begin(), weight.end()) - weight.begin();
    hop(v, {.dart = dart, .leg = static_cast<int>(heaviest)});
    const double length = map_.weight(map_.graph_edge[at(v)]);
    const double deep = std::min(overshoot, kLongestPush * length);
    map_.t[at(v)] = map_.t[at(v)] > 0.5 * length ? length - deep : deep;
    return runs;
}

}  // namespace leafcutter::geometry
