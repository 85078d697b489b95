#include "geometry/pants/draw_onto.h"

#include <algorithm>
#include <cstddef>
#include <span>

#include "geometry/error.h"

namespace leafcutter::geometry {
namespace {

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

class Drawing {
public:
    Drawing(GraphMap& map, const VertexRings& rings, int v) : map_(map), v_(v) {
        const auto begin = at(rings.begin[at(v)]);
        slots_ = {rings.slots.data() + begin, at(rings.begin[at(v) + 1]) - begin};
        for (const RingSlot& slot : slots_) {
            const Word& word = map.words[at(slot.edge)];
            seen_.push_back(slot.forward ? word : reversed(word));
        }
    }

    std::size_t slot_of(int neighbour) const {
        return static_cast<std::size_t>(
            std::find_if(slots_.begin(), slots_.end(),
                         [&](const RingSlot& slot) { return slot.neighbour == neighbour; }) -
            slots_.begin());
    }
    std::size_t slots() const { return slots_.size(); }
    const Word& seen(std::size_t k) const { return seen_[k]; }

    // Through the node that the way to slot `target` passes first, into its leg beyond.
    void pass_node(std::size_t target) {
        const Dart through = seen_[target][0];
        const Dart leg = seen_[target][1];
        const std::vector<char> with_us = leg_mates(target);
        for (std::size_t k = 0; k < seen_.size(); ++k) {
            Word& word = seen_[k];
            if (word.empty()) {
                word = {reversed(leg), reversed(through)};
            } else if (word.front() != through) {
                word.insert(word.begin(), reversed(leg));
            } else if (with_us[k] != 0) {
                word.erase(word.begin());
                if (word.size() == 1) {
                    word.clear();
                }
            } else {
                word.front() = reversed(leg);
            }
        }
        map_.graph_edge[at(v_)] = edge_of(leg);
    }

    void store() {
        for (std::size_t k = 0; k < seen_.size(); ++k) {
            map_.words[at(slots_[k].edge)] = slots_[k].forward ? seen_[k] : reversed(seen_[k]);
        }
    }

private:
    // Slots that see the same edge of the tree beyond the node as `target` does: its run of slots
    // whose links stay there.
    std::vector<char> leg_mates(std::size_t target) const {
        std::vector<char> mates(seen_.size(), 0);
        mates[target] = 1;
        const std::size_t count = seen_.size();
        for (std::size_t k = target; joined(k, (k + 1) % count);) {
            k = (k + 1) % count;
            if (mates[k] != 0) {
                return mates;
            }
            mates[k] = 1;
        }
        for (std::size_t k = target; joined((k + count - 1) % count, k);) {
            k = (k + count - 1) % count;
            if (mates[k] != 0) {
                return mates;
            }
            mates[k] = 1;
        }
        return mates;
    }

    // Slots k and `next`, the one after it, see the same leg.
    bool joined(std::size_t k, std::size_t next) const {
        const Word& a = seen_[k];
        const Word& b = seen_[next];
        if (slots_[k].link < 0 || a.empty() || b.empty() || a[0] != b[0] || a[1] != b[1]) {
            return false;
        }
        // The way between them turns back at the node only if they part there.
        const std::size_t parted = a.size() + b.size() - 2;
        return map_.words[at(slots_[k].link)].size() != parted;
    }

    GraphMap& map_;
    int v_;
    std::span<const RingSlot> slots_;
    std::vector<Word> seen_;  // Per slot: the word from v.
};

}  // namespace

void draw_onto(GraphMap& map, const VertexRings& rings, int v, int neighbour) {
    Drawing drawing(map, rings, v);
    const std::size_t target = drawing.slot_of(neighbour);
    if (target == drawing.slots()) {
        throw Error(ErrorKind::SelfCheck, "broken-tree", "pants: no edge to draw a vertex along");
    }
    for (std::size_t steps = drawing.seen(target).size(); !drawing.seen(target).empty(); --steps) {
        if (steps == 0) {
            throw Error(ErrorKind::SelfCheck, "broken-tree", "pants: a way in the tree has no end");
        }
        drawing.pass_node(target);
    }
    drawing.store();
    map.t[at(v)] = map.t[at(neighbour)];
}

}  // namespace leafcutter::geometry
