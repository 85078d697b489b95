// A second judge of layouts, which shares nothing with the nesting: every pair of edges, in whole
// nanometres and 128-bit products, by brute force. Lengths are millimetres.

#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

namespace leafcutter::oracle {

__extension__ using Wide = __int128;

struct Nano {
    std::int64_t x = 0;
    std::int64_t y = 0;
};
using Loop = std::vector<Nano>;

inline Loop to_nano(const std::vector<Eigen::Vector2d>& ring) {
    Loop loop;
    for (const Eigen::Vector2d& p : ring) {
        loop.push_back({std::llround(p.x() * 1e6), std::llround(p.y() * 1e6)});
    }
    return loop;
}

inline Wide cross(const Nano& o, const Nano& a, const Nano& b) {
    return Wide{a.x - o.x} * (b.y - o.y) - Wide{a.y - o.y} * (b.x - o.x);
}

inline int sign(Wide value) {
    return value > 0 ? 1 : (value < 0 ? -1 : 0);
}

inline bool on_edge(const Nano& p, const Nano& a, const Nano& b) {
    return cross(a, b, p) == 0 && std::min(a.x, b.x) <= p.x && p.x <= std::max(a.x, b.x) &&
           std::min(a.y, b.y) <= p.y && p.y <= std::max(a.y, b.y);
}

inline bool edges_meet(const Nano& a, const Nano& b, const Nano& c, const Nano& d) {
    if (on_edge(c, a, b) || on_edge(d, a, b) || on_edge(a, c, d) || on_edge(b, c, d)) {
        return true;
    }
    return sign(cross(a, b, c)) * sign(cross(a, b, d)) < 0 &&
           sign(cross(c, d, a)) * sign(cross(c, d, b)) < 0;
}

// Square of the distance of a point from an edge, in nm².
inline long double square_to_edge(const Nano& p, const Nano& a, const Nano& b) {
    const Wide ux = b.x - a.x;
    const Wide uy = b.y - a.y;
    const Wide along = ux * (p.x - a.x) + uy * (p.y - a.y);
    const Wide length = ux * ux + uy * uy;
    const auto square = [](Wide x, Wide y) { return static_cast<long double>(x * x + y * y); };
    if (along <= 0) {
        return square(p.x - a.x, p.y - a.y);
    }
    if (along >= length) {
        return square(p.x - b.x, p.y - b.y);
    }
    const auto area = static_cast<long double>(ux * (p.y - a.y) - uy * (p.x - a.x));
    return area * area / static_cast<long double>(length);
}

inline bool holds(const Loop& loop, const Nano& p) {
    int winding = 0;
    for (std::size_t i = 0; i < loop.size(); ++i) {
        const Nano& a = loop[i];
        const Nano& b = loop[(i + 1) % loop.size()];
        if (a.y <= p.y && b.y > p.y) {
            winding += cross(a, b, p) > 0 ? 1 : 0;
        } else if (a.y > p.y && b.y <= p.y) {
            winding -= cross(a, b, p) < 0 ? 1 : 0;
        }
    }
    return winding != 0;
}

// Millimetres between two outlines' edges; 0 where they meet.
inline double distance_mm(const Loop& one, const Loop& two) {
    long double least = std::numeric_limits<long double>::infinity();
    for (std::size_t i = 0; i < one.size(); ++i) {
        const Nano& a = one[i];
        const Nano& b = one[(i + 1) % one.size()];
        for (std::size_t j = 0; j < two.size(); ++j) {
            const Nano& c = two[j];
            const Nano& d = two[(j + 1) % two.size()];
            if (edges_meet(a, b, c, d)) {
                return 0.0;
            }
            least = std::min({least, square_to_edge(a, c, d), square_to_edge(b, c, d),
                              square_to_edge(c, a, b), square_to_edge(d, a, b)});
        }
    }
    return static_cast<double>(std::sqrt(least)) * 1e-6;
}

// What is wrong with two areas that must stay apart; empty: nothing.
inline bool apart(const Loop& one, const Loop& two, double gap_mm) {
    return distance_mm(one, two) >= gap_mm && !holds(one, two.front()) && !holds(two, one.front());
}

}  // namespace leafcutter::oracle
