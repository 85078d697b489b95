#include "fab/cut/stroke_lines.h"

#include <algorithm>
#include <map>
#include <numeric>

#include "geometry/plane.h"

namespace leafcutter::fab {

using geometry::turn_of;

namespace {

using Eigen::Vector2d;

constexpr double kTouchMm = 3e-3;  // Lines nearer than this touch.

double distance(const Vector2d& point, const StrokeLine& line) {
    const Vector2d d = line.to - line.from;
    const double t = std::clamp((point - line.from).dot(d) / d.squaredNorm(), 0.0, 1.0);
    return (point - line.from - t * d).norm();
}

bool cross(const StrokeLine& a, const StrokeLine& b) {
    const auto side = [](const StrokeLine& line, const Vector2d& point) {
        return turn_of(line.to - line.from, point - line.from) > 0.0;
    };
    return side(a, b.from) != side(a, b.to) && side(b, a.from) != side(b, a.to);
}

bool touch(const StrokeLine& a, const StrokeLine& b) {
    return std::min({distance(a.from, b), distance(a.to, b), distance(b.from, a),
                     distance(b.to, a)}) <= kTouchMm ||
           cross(a, b);
}

}  // namespace

std::vector<std::vector<std::size_t>> connected(const std::vector<StrokeLine>& lines) {
    const std::size_t count = lines.size();
    std::vector<std::size_t> root(count);
    std::iota(root.begin(), root.end(), std::size_t{0});
    const auto find = [&](std::size_t i) {
        while (root[i] != i) {
            i = root[i] = root[root[i]];
        }
        return i;
    };
    std::vector<std::size_t> order = root;
    const auto low = [&](std::size_t i) { return std::min(lines[i].from.x(), lines[i].to.x()); };
    const auto high = [&](std::size_t i) { return std::max(lines[i].from.x(), lines[i].to.x()); };
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return std::pair(low(a), a) < std::pair(low(b), b);
    });
    for (std::size_t i = 0; i < count; ++i) {
        const double reach = high(order[i]) + kTouchMm;
        for (std::size_t j = i + 1; j < count && low(order[j]) <= reach; ++j) {
            if (touch(lines[order[i]], lines[order[j]])) {
                const std::size_t a = find(order[i]);
                const std::size_t b = find(order[j]);
                root[std::max(a, b)] = std::min(a, b);
            }
        }
    }
    std::map<std::size_t, std::vector<std::size_t>> groups;
    for (std::size_t i = 0; i < count; ++i) {
        groups[find(i)].push_back(i);
    }
    std::vector<std::vector<std::size_t>> result;
    result.reserve(groups.size());
    for (auto& [first, members] : groups) {
        result.push_back(std::move(members));
    }
    return result;
}

}  // namespace leafcutter::fab
