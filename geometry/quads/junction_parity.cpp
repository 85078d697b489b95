#include "geometry/quads/junction_parity.h"

#include <cstdint>

#include "geometry/error.h"

namespace leafcutter::geometry {
namespace {

// Up to as many nodes all ways to colour them are tried; beyond, single changes as long as they
// gain.
constexpr int kMostNodesToTry = 16;

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

// One side of an arc: the end it belongs to, and the colour of the cell at the arc's start if the
// end's first cell has colour 0.
struct ArcSide {
    std::size_t cylinder = 0;
    std::size_t end = 0;
    int colour = 0;
};

std::vector<std::vector<ArcSide>> sides_of_arcs(const ArcNetwork& network,
                                                const std::vector<int>& arc_cells) {
    std::vector<std::vector<ArcSide>> sides(network.arcs.size());
    for (const int c : network.cylinders) {
        for (std::size_t end = 0; end < 2; ++end) {
            int offset = 0;
            for (const ArcUse& use : network.ends[at(c)][end].uses) {
                const int cells = arc_cells[at(use.arc)];
                const int first = use.forward ? offset : offset + cells - 1;
                sides[at(use.arc)].push_back({at(c), end, first % 2});
                offset += cells;
            }
        }
    }
    return sides;
}

// The parity that a cylinder's rows must have, if its nodes have these colours.
int wanted_parity(const std::array<int, 2>& colours, int bits, int twist) {
    return (colours[0] + colours[1] + bits + 1 + (twist % 2 + 2)) % 2;
}

class NodeChooser {
public:
    NodeChooser(const ArcNetwork& network,
                const EndColours& colours,
                const std::vector<int>& twists,
                const std::vector<ParityCost>& costs)
        : network_(network), colours_(colours), twists_(twists), costs_(costs) {}

    std::vector<std::optional<int>> run() {
        std::vector<char> best(at(network_.nodes), 0);
        double least = cost_of(best);
        if (network_.nodes <= kMostNodesToTry) {
            for (std::uint32_t ways = 1; ways < (1U << (network_.nodes - 1)); ++ways) {
                std::vector<char> bits(at(network_.nodes), 0);
                for (int node = 1; node < network_.nodes; ++node) {
                    bits[at(node)] = static_cast<char>((ways >> (node - 1)) & 1U);
                }
                take_if_better(bits, best, least);
            }
        } else {
            flip_while_better(best, least);
        }
        std::vector<std::optional<int>> parities(network_.ends.size());
        for (const int c : network_.cylinders) {
            parities[at(c)] = parity_of(at(c), best);
        }
        return parities;
    }

private:
    std::optional<int> parity_of(std::size_t cylinder, const std::vector<char>& bits) const {
        const auto [lower, upper] = network_.node[cylinder];
        if (lower < 0 || upper < 0) {
            return std::nullopt;
        }
        return wanted_parity(colours_[cylinder], bits[at(lower)] + bits[at(upper)],
                             twists_[cylinder]);
    }

    double cost_of(const std::vector<char>& bits) const {
        double cost = 0.0;
        for (const int c : network_.cylinders) {
            if (const std::optional<int> parity = parity_of(at(c), bits)) {
                cost += costs_[at(c)][at(*parity)];
            }
        }
        return cost;
    }

    bool take_if_better(const std::vector<char>& bits,
                        std::vector<char>& best,
                        double& least) const {
        const double cost = cost_of(bits);
        if (!(cost < least)) {
            return false;
        }
        best = bits;
        least = cost;
        return true;
    }

    void flip_while_better(std::vector<char>& best, double& least) const {
        for (bool better = true; better;) {
            better = false;
            for (int node = 1; node < network_.nodes; ++node) {
                std::vector<char> bits = best;
                bits[at(node)] ^= 1;
                better = take_if_better(bits, best, least) || better;
            }
        }
    }

    const ArcNetwork& network_;
    const EndColours& colours_;
    const std::vector<int>& twists_;
    const std::vector<ParityCost>& costs_;
};

// From ends whose colour is known to those they meet; false if there is none.
bool spread_colours(const std::vector<std::vector<ArcSide>>& sides, EndColours& known) {
    bool changed = false;
    for (const std::vector<ArcSide>& both : sides) {
        for (std::size_t k = 0; k < 2; ++k) {
            const int from = known[both[k].cylinder][both[k].end];
            int& other = known[both[1 - k].cylinder][both[1 - k].end];
            if (from >= 0 && other < 0) {
                other = (from + both[0].colour + both[1].colour + 1) % 2;
                changed = true;
            }
        }
    }
    return changed;
}

}  // namespace

EndColours colour_ends(const ArcNetwork& network, const std::vector<int>& arc_cells) {
    const auto sides = sides_of_arcs(network, arc_cells);
    EndColours known(network.ends.size(), {-1, -1});
    const auto colour_of = [&known](const ArcSide& side) { return known[side.cylinder][side.end]; };
    for (const int c : network.cylinders) {
        for (int& colour : known[at(c)]) {
            if (colour < 0) {
                colour = 0;
                while (spread_colours(sides, known)) {
                }
            }
        }
    }
    for (const std::vector<ArcSide>& both : sides) {
        if ((colour_of(both[0]) + colour_of(both[1]) + both[0].colour + both[1].colour) % 2 != 1) {
            throw Error(ErrorKind::SelfCheck, "junction-colours",
                        "quads: cells don't alternate round a node of the critical graph");
        }
    }
    for (std::array<int, 2>& colours : known) {
        for (int& colour : colours) {
            colour = colour < 0 ? 0 : colour;
        }
    }
    return known;
}

std::vector<std::optional<int>> choose_row_parities(const ArcNetwork& network,
                                                    const EndColours& colours,
                                                    const std::vector<int>& twists,
                                                    const std::vector<ParityCost>& costs) {
    return NodeChooser(network, colours, twists, costs).run();
}

}  // namespace leafcutter::geometry
