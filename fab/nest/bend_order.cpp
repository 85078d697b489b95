#include "fab/nest/bend_order.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "geometry/plane.h"

namespace leafcutter::fab {

using geometry::angle_between;

BandBend bend_of(const NestPart& part) {
    if (part.middle.size() < 3) {
        return {};
    }
    const auto turn = [&](std::size_t from, std::size_t to) {
        const Eigen::Vector2d& a = part.middle[from].along;
        const Eigen::Vector2d& b = part.middle[to].along;
        return angle_between(a, b);
    };
    const std::size_t last = part.middle.size() - 1;
    const double first_half = turn(0, last / 2);
    const double second_half = turn(last / 2, last);
    const double both = std::abs(first_half) + std::abs(second_half);
    const bool to_both_sides = first_half * second_half < 0.0;
    return {to_both_sides && first_half < 0.0,
            (to_both_sides ? -both : both) / part.middle[last].from_start};
}

std::vector<std::size_t> by_bend(const BoardPlan& plan, std::size_t groups) {
    std::vector<BandBend> bend;
    bend.reserve(plan.part_of.size());
    for (const std::size_t part : plan.part_of) {
        bend.push_back(bend_of(plan.parts[part]));
    }
    std::vector<std::size_t> order(bend.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return bend[a] < bend[b]; });
    const auto start_of = [&](std::size_t group) {
        return order.begin() + static_cast<std::ptrdiff_t>(group * order.size() / groups);
    };
    for (std::size_t group = 0; group < groups; ++group) {
        std::stable_sort(start_of(group), start_of(group + 1), [&](std::size_t a, std::size_t b) {
            return plan.part(a).diameter > plan.part(b).diameter;
        });
    }
    return order;
}

}  // namespace leafcutter::fab
