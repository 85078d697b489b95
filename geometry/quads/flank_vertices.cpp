#include "geometry/quads/flank_vertices.h"

#include <cstddef>

#include <fmt/format.h>

#include "geometry/error.h"

namespace leafcutter::geometry {
namespace {

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

[[noreturn]] void fail(const char* what) {
    throw Error(ErrorKind::SelfCheck, "quads-topology", fmt::format("quads: {}", what));
}

}  // namespace

FlankVertices::FlankVertices(const RectanglePlan& plan) : plan_(plan) {
    first_.assign(plan.network.sides.size(), -1);
    rows_.assign(plan.network.sides.size(), 0);
    for (const int c : plan.network.cylinders) {
        const std::vector<double> levels = plan.rows.levels(c);
        for (const Flank& flank : plan.network.flanks[at(c)]) {
            for (const SideUse& use : flank.uses) {
                add_side(c, use.side, levels);
            }
        }
    }
}

std::vector<int> FlankVertices::along(const Flank& flank) const {
    std::vector<int> vertices;
    for (const SideUse& use : flank.uses) {
        const CriticalSide& side = plan_.network.sides[at(use.side)];
        vertices.push_back(stops_.at(side.points.front()));
        for (int k = 1; k < rows_[at(use.side)]; ++k) {
            vertices.push_back(first_[at(use.side)] + k - 1);
        }
    }
    const CriticalSide& last = plan_.network.sides[at(flank.uses.back().side)];
    vertices.push_back(stops_.at(last.points.back()));
    return vertices;
}

void FlankVertices::add_side(int cylinder, int number, const std::vector<double>& levels) {
    const CriticalSide& side = plan_.network.sides[at(number)];
    const int low = plan_.network.zero_of(side.points.front());
    const int high = plan_.network.zero_of(side.points.back());
    const int below = low < 0 ? 0 : plan_.rows.rows_below(cylinder, low);
    const int rows = plan_.rows.rows_below(cylinder, high) - below;
    if (first_[at(number)] >= 0) {
        if (rows != rows_[at(number)]) {
            fail("the rows of neighbouring rectangles don't match");
        }
        return;
    }
    if (rows < 1) {
        fail("two zeros on one side share a row");
    }
    add_stop(side.points.front());
    add_stop(side.points.back());
    first_[at(number)] = static_cast<int>(positions_.size());
    rows_[at(number)] = rows;
    for (int k = 1; k < rows; ++k) {
        positions_.push_back(
            point_on(side, plan_.foliation, plan_.rows.unbent(side, levels[at(below + k)])));
    }
}

void FlankVertices::add_stop(int point) {
    if (stops_.emplace(point, static_cast<int>(positions_.size())).second) {
        positions_.push_back(plan_.foliation.critical_points[at(point)].position);
    }
}

}  // namespace leafcutter::geometry
