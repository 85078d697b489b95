#include "geometry/quads/shared_vertices.h"

#include <cstdint>
#include <utility>

#include <fmt/format.h>

#include "geometry/disjoint_sets.h"
#include "geometry/error.h"

namespace leafcutter::geometry {
namespace {

using Eigen::Vector3d;

constexpr int kRegular = 4;

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

int floor_mod(int value, int modulus) {
    const int rest = value % modulus;
    return rest < 0 ? rest + modulus : rest;
}

}  // namespace

SharedVertices::SharedVertices(const Foliation& foliation,
                               const ArcNetwork& network,
                               const JunctionCounts& counts)
    : network_(network), counts_(counts) {
    number_all(foliation);
    join_ends();
}

std::vector<int> SharedVertices::valences(const Foliation& foliation) const {
    std::vector<int> valences(positions_.size(), kRegular);
    for (const auto& [point, first] : singular_) {
        valences[at(number_[at(first)])] +=
            2 * foliation.critical_points[at(point)].prongs - kRegular;
    }
    return valences;
}

int SharedVertices::vertex(int cylinder, std::size_t side, int col) const {
    return number_[at(first_number(cylinder, side, col))];
}

void SharedVertices::number_all(const Foliation& foliation) {
    for (std::size_t a = 0; a < network_.arcs.size(); ++a) {
        const CriticalArc& arc = network_.arcs[a];
        add_singular(arc.points.front(), foliation);
        add_singular(arc.points.back(), foliation);
        first_.push_back(static_cast<int>(positions_.size()));
        const int cells = counts_.arc_cells[a];
        for (int k = 1; k < cells; ++k) {
            positions_.push_back(point_on(arc, foliation, static_cast<double>(k) / cells));
        }
    }
}

void SharedVertices::add_singular(int point, const Foliation& foliation) {
    if (singular_.emplace(point, static_cast<int>(positions_.size())).second) {
        positions_.push_back(foliation.critical_points[at(point)].position);
    }
}

// Of vertices that come together the middle is kept.
void SharedVertices::join_ends() {
    DisjointSets same(positions_.size());
    for (const int c : network_.cylinders) {
        for (int col = 0; counts_.rows[at(c)] == 0 && col < counts_.cols[at(c)]; ++col) {
            same.unite(static_cast<std::uint32_t>(first_number(c, 0, col)),
                       static_cast<std::uint32_t>(first_number(c, 1, col)));
        }
    }
    std::vector<Vector3d> joined;
    std::vector<int> members;
    for (std::size_t v = 0; v < positions_.size(); ++v) {
        const std::uint32_t first = same.find(static_cast<std::uint32_t>(v));
        if (first == v) {
            number_.push_back(static_cast<int>(joined.size()));
            joined.push_back(positions_[v]);
            members.push_back(1);
            continue;
        }
        number_.push_back(number_[first]);
        joined[at(number_[v])] += positions_[v];
        ++members[at(number_[v])];
    }
    for (std::size_t v = 0; v < joined.size(); ++v) {
        joined[v] /= members[v];
    }
    positions_ = std::move(joined);
}

// As numbered before ends are joined.
int SharedVertices::first_number(int cylinder, std::size_t side, int col) const {
    const int twist = side == 1 ? counts_.twist[at(cylinder)] : 0;
    int place = floor_mod(col - twist, counts_.cols[at(cylinder)]);
    for (const ArcUse& use : network_.ends[at(cylinder)][side].uses) {
        const int cells = counts_.arc_cells[at(use.arc)];
        if (place < cells) {
            return on_arc(use.arc, use.forward ? place : cells - place);
        }
        place -= cells;
    }
    throw Error(ErrorKind::SelfCheck, "quads-topology",
                fmt::format("quads: an end of cylinder {} is too short", cylinder));
}

int SharedVertices::on_arc(int arc, int place) const {
    const std::vector<int>& points = network_.arcs[at(arc)].points;
    if (place == 0) {
        return singular_.at(points.front());
    }
    if (place == counts_.arc_cells[at(arc)]) {
        return singular_.at(points.back());
    }
    return first_[at(arc)] + place - 1;
}

}  // namespace leafcutter::geometry
