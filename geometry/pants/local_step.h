// The exact minimiser of one vertex with its neighbours held: the weighted geodesic centre of
// Algorithm 1 in the dual tree. Moves words along when the vertex passes a node.

#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "geometry/pants/tree_word.h"
#include "geometry/pants/vertex_rings.h"

namespace leafcutter::geometry {

enum class Standing : char {
    Free,
    Stuck,    // Exactly at a node, which is its centre.
    Blocked,  // Just before a node it would pass, but moving on would pinch off an island.
};

// What steps did to a map, so that they can be taken back.
struct StepJournal {
    bool on = false;
    std::vector<std::pair<int, Word>> words;  // Mesh edges with the words they had, oldest first.

    // Per vertex 1 or -1: changes sign whenever the vertex passes from an edge of the tree to one
    // that runs the other way as seen from it. Conjugation with it carries the frozen system of one
    // combinatorics nearly into that of another.
    std::vector<signed char> gauge;
};

class LocalStep {
public:
    // All three are changed or read through the lifetime of this.
    LocalStep(GraphMap& map, const VertexRings& rings, std::span<const double> weights);

    StepJournal& journal() { return journal_; }

    // Puts vertex `v` at its centre.
    Standing centre(int v);

    // Moves `v` past the end of `dart`, `overshoot` deep into the leg of largest weight.
    // Returns the number of separate sectors of neighbours beyond that node; only moves if it is 1.
    int push_through(int v, Dart dart, double overshoot);

private:
    struct Seen {  // A neighbour as seen from the vertex at hand.
        int slot = 0;
        double weight = 0.0;
        std::size_t darts = 0;  // Of its word.
        Dart first = -1;        // First and second of them, -1 without.
        Dart second = -1;
        double place = 0.0;  // On the vertex's own edge line, unfolded.
        int leg = -1;        // Class of neighbours beyond the node, or -1.
    };

    void look(int v);
    int part_legs(Dart dart);
    void join_last_leg();
    bool same_leg(const Seen& a, const Seen& b, const RingSlot& slot) const;
    struct Hop {
        Dart dart = -1;  // Past the end of this one
        int leg = -1;    // and into this leg.
    };
    void hop(int v, Hop through);
    const Word& word_at(int slot) const;

    GraphMap& map_;
    const VertexRings& rings_;
    std::span<const double> weights_;
    std::vector<Seen> seen_;
    int legs_ = 0;
    StepJournal journal_;
};

}  // namespace leafcutter::geometry
