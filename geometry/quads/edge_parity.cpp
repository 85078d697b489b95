#include "geometry/quads/edge_parity.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>

#include "geometry/disjoint_sets.h"

namespace leafcutter::geometry {
namespace {

constexpr std::size_t kMostNodes = 18;
// Of a sum of costs: less is rounding.
constexpr double kBetter = 1e-12;

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

class Chooser {
public:
    Chooser(int nodes, std::span<const ParityEdge> edges)
        : edges_(edges), around_(at(nodes)), label_(at(nodes), 0) {
        for (std::size_t e = 0; e < edges.size(); ++e) {
            if (edges[e].from != edges[e].to) {
                around_[at(edges[e].from)].push_back(e);
                around_[at(edges[e].to)].push_back(e);
            }
        }
    }

    std::vector<int> run() {
        follow_dearest();
        for (const std::vector<int>& part : parts()) {
            if (part.size() <= kMostNodes) {
                try_all(part);
            } else {
                flip_while_better(part);
            }
        }
        std::vector<int> parities;
        for (const ParityEdge& edge : edges_) {
            parities.push_back(label_[at(edge.from)] ^ label_[at(edge.to)]);
        }
        return parities;
    }

private:
    // Gives the edges of a spanning forest the parity they like, those that care most first.
    void follow_dearest() {
        std::vector<std::size_t> order(edges_.size());
        std::iota(order.begin(), order.end(), std::size_t{0});
        const auto care = [this](std::size_t e) {
            return std::abs(edges_[e].cost[0] - edges_[e].cost[1]);
        };
        std::stable_sort(order.begin(), order.end(),
                         [&](std::size_t a, std::size_t b) { return care(a) > care(b); });
        DisjointSets sets(label_.size());
        for (const std::size_t e : order) {
            const ParityEdge& edge = edges_[e];
            const auto from = static_cast<std::uint32_t>(edge.from);
            const auto to = static_cast<std::uint32_t>(edge.to);
            const int liked = edge.cost[1] < edge.cost[0] ? 1 : 0;
            const bool differs = (label_[from] ^ label_[to]) != liked;
            const std::uint32_t moved = sets.find(to);
            if (sets.find(from) == moved) {
                continue;
            }
            for (std::uint32_t v = 0; differs && v < label_.size(); ++v) {
                label_[v] ^= sets.find(v) == moved ? 1 : 0;
            }
            sets.unite(from, to);
        }
    }

    std::vector<std::vector<int>> parts() const {
        DisjointSets sets(label_.size());
        for (const ParityEdge& edge : edges_) {
            sets.unite(static_cast<std::uint32_t>(edge.from), static_cast<std::uint32_t>(edge.to));
        }
        std::vector<std::vector<int>> parts(label_.size());
        for (std::uint32_t v = 0; v < label_.size(); ++v) {
            parts[sets.find(v)].push_back(static_cast<int>(v));
        }
        return parts;
    }

    // What it would cost to change a label.
    double price(int node) const {
        double price = 0.0;
        for (const std::size_t e : around_[at(node)]) {
            const std::size_t parity = at(label_[at(edges_[e].from)] ^ label_[at(edges_[e].to)]);
            price += edges_[e].cost[1 - parity] - edges_[e].cost[parity];
        }
        return price;
    }

    // In the order of Gray's code, one label after the other.
    void try_all(const std::vector<int>& part) {
        std::vector<int> best;
        double least = -kBetter * scale(part);
        double cost = 0.0;
        for (std::uint32_t way = 1; part.size() > 1 && way < (1U << (part.size() - 1)); ++way) {
            const int node = part[static_cast<std::size_t>(std::countr_zero(way))];
            cost += price(node);
            label_[at(node)] ^= 1;
            if (cost < least) {
                least = cost;
                best = label_;
            }
        }
        // The last way of all differs from the first in one label.
        if (part.size() > 1) {
            label_[at(part[part.size() - 2])] ^= 1;
        }
        if (!best.empty()) {
            label_ = std::move(best);
        }
    }

    void flip_while_better(const std::vector<int>& part) {
        const double least = -kBetter * scale(part);
        for (bool better = true; better;) {
            better = false;
            for (const int node : part) {
                const double alone = price(node);
                label_[at(node)] ^= 1;
                if (alone < least || flip_neighbour(node, least - alone)) {
                    better = true;
                } else {
                    label_[at(node)] ^= 1;
                }
            }
        }
    }

    bool flip_neighbour(int node, double limit) {
        for (const std::size_t e : around_[at(node)]) {
            const int other = edges_[e].from == node ? edges_[e].to : edges_[e].from;
            if (price(other) < limit) {
                label_[at(other)] ^= 1;
                return true;
            }
        }
        return false;
    }

    double scale(const std::vector<int>& part) const {
        double sum = 0.0;
        for (const int node : part) {
            for (const std::size_t e : around_[at(node)]) {
                sum += std::abs(edges_[e].cost[0] - edges_[e].cost[1]);
            }
        }
        return sum;
    }

    std::span<const ParityEdge> edges_;
    std::vector<std::vector<std::size_t>> around_;  // Edges at each node, loops left out.
    std::vector<int> label_;
};

}  // namespace

std::vector<int> cheapest_parities(int nodes, std::span<const ParityEdge> edges) {
    return Chooser(nodes, edges).run();
}

}  // namespace leafcutter::geometry
