// Shortest closed lines of edges whose homology class lies in a given subgroup.
//
// Searched for in the covering surface in which just the loops of that subgroup close: there they
// are the loops of a shortest-path tree and one more edge, which they need not be on the surface
// itself (the tunnel loop of a knotted tube winds round it many times).

#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <queue>
#include <unordered_map>
#include <utility>
#include <vector>

#include "geometry/context.h"
#include "geometry/loops/linking.h"
#include "geometry/pants/vertex_rings.h"

namespace leafcutter::geometry {

using HomologyClass = std::vector<int>;

struct ClassedLoop {
    std::vector<int> vertices;
    HomologyClass homology;
    double length = 0.0;
};

// Per edge, from its `from` to its `to`: its length and the values of all cochains of a basis.
struct ClassedEdges {
    std::vector<double> length;
    std::vector<HomologyClass> value;  // Empty where all are zero.
    std::size_t rank = 0;
};

class LoopSearch {
public:
    // The subgroup: classes x with x^T `annihilator` = 0. Both are borrowed.
    LoopSearch(const VertexRings& rings, const ClassedEdges& edges, IntegerMatrix annihilator);

    struct Wanted {
        std::function<bool(const HomologyClass&)> homology;  // Of classes of the subgroup, not 0.
        double shorter_than = 0.0;
    };

    // The shortest wanted simple loop of the subgroup through `root` that avoids `blocked`
    // vertices, or nearly.
    std::optional<ClassedLoop> loop_through(int root,
                                            const std::vector<char>& blocked,
                                            const Wanted& wanted,
                                            const Context& context);

private:
    struct State {  // A vertex of the covering surface.
        int vertex = 0;
        int sum = 0;  // Number of the values summed along the tree.
        int parent = -1;
        double distance = 0.0;
        bool settled = false;
    };

    int number_of_sum(const HomologyClass& sum);
    int sum_after(int sum, const RingSlot& slot);
    HomologyClass difference(int a, int b) const;
    int state_at(int vertex, int sum);
    std::vector<int> close(int a, int b) const;
    void go_along(int here,
                  const RingSlot& slot,
                  const Wanted& wanted,
                  std::optional<ClassedLoop>& found);

    const VertexRings& rings_;
    const ClassedEdges& edges_;
    IntegerMatrix annihilator_;
    std::map<HomologyClass, int> numbers_;
    std::vector<HomologyClass> sums_;
    std::map<HomologyClass, int> sheets_;
    std::vector<int> sheet_of_sum_;
    using Entry = std::pair<double, int>;  // Distance and state.
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue_;
    std::vector<State> states_;
    std::unordered_map<std::uint64_t, int> state_of_place_;
};

}  // namespace leafcutter::geometry
