#include "fab/nest/large_swap.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace leafcutter::fab {

namespace {

// Items by hull, largest first, until they make up three quarters of the sum.
std::vector<std::size_t> large_items(const BoardPlan& plan) {
    std::vector<std::size_t> order(plan.part_of.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return plan.part(a).hull_area > plan.part(b).hull_area;
    });
    double whole = 0.0;
    for (const std::size_t item : order) {
        whole += plan.part(item).hull_area;
    }
    double sum = 0.0;
    std::size_t count = 0;
    while (count < order.size() && sum < 0.75 * whole) {
        sum += plan.part(order[count++]).hull_area;
    }
    order.resize(count);
    return order;
}

bool alike(const NestPart& a, const NestPart& b) {
    return std::abs(a.area - b.area) <= 0.01 * std::max(a.area, b.area) &&
           std::abs(a.diameter - b.diameter) <= 0.01 * std::max(a.diameter, b.diameter);
}

// Gives `position` the rotation of another part, or the nearest that it may have.
void turn_like(const NestPart& part, double angle_deg, Position& position) {
    if (part.turns_freely()) {
        position.turn = 0;
        position.angle_deg = part.allowed_deg.nearest(angle_deg);
        return;
    }
    double least = 1e9;
    for (std::size_t i = 0; i < part.allowed_deg.size(); ++i) {
        const double off = std::abs(std::remainder(part.allowed_deg[i] - angle_deg, 360.0));
        if (off < least) {
            least = off;
            position.turn = static_cast<int>(i);
            position.angle_deg = part.allowed_deg[i];
        }
    }
}

}  // namespace

LargeSwap::LargeSwap(const BoardPlan& plan) : plan_(plan), large_(large_items(plan)) {}

void LargeSwap::apply(std::vector<Position>& positions, Random& random) const {
    const std::size_t first = large_[random.below(large_.size())];
    std::size_t second = random.below(positions.size());
    for (int tries = 0; tries < 20; ++tries) {
        const std::size_t other = large_[random.below(large_.size())];
        if (other != first && !alike(plan_.part(first), plan_.part(other))) {
            second = other;
            break;
        }
    }
    if (second == first) {
        return;
    }
    std::swap(positions[first], positions[second]);
    turn_like(plan_.part(first), positions[first].angle_deg, positions[first]);
    turn_like(plan_.part(second), positions[second].angle_deg, positions[second]);
    if (plan_.part(first).diameter > 1.5 * plan_.part(second).diameter) {
        carry(positions, first, second);
    } else if (plan_.part(second).diameter > 1.5 * plan_.part(first).diameter) {
        carry(positions, second, first);
    }
}

// Small parts under `large` go where `small` came from: where it lies was large's place.
void LargeSwap::carry(std::vector<Position>& positions,
                      std::size_t large,
                      std::size_t small) const {
    const Position from = positions[large];
    const Position to = positions[small];
    const double reach = plan_.part(large).diameter;
    for (std::size_t item = 0; item < positions.size(); ++item) {
        Position& at = positions[item];
        const bool moves = item != large && item != small && plan_.part(item).diameter < reach;
        if (moves && at.bin == from.bin &&
            std::hypot(at.x - from.x, at.y - from.y) < 0.25 * reach) {
            at.bin = to.bin;
            at.x += to.x - from.x;
            at.y += to.y - from.y;
        }
    }
}

}  // namespace leafcutter::fab
