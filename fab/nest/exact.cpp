#include "fab/nest/exact.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "geometry/error.h"

namespace leafcutter::fab {

namespace {

__extension__ using Wide = __int128;

struct WholeEdge {
    WholePoint from;
    WholePoint to;
    WholePoint low;
    WholePoint high;
};

struct WholeBox {
    WholePoint low{std::numeric_limits<std::int64_t>::max(),
                   std::numeric_limits<std::int64_t>::max()};
    WholePoint high{std::numeric_limits<std::int64_t>::min(),
                    std::numeric_limits<std::int64_t>::min()};
};

[[noreturn]] void fail(const std::string& message) {
    throw geometry::Error(geometry::ErrorKind::SelfCheck, "nest-proof", "nest: " + message);
}

std::int64_t cross(const WholePoint& o, const WholePoint& a, const WholePoint& b) {
    return (a.x - o.x) * (b.y - o.y) - (a.y - o.y) * (b.x - o.x);
}

int sign(std::int64_t value) {
    return value > 0 ? 1 : (value < 0 ? -1 : 0);
}

template <typename A, typename B>
bool boxes_near(const A& a, const B& b, std::int64_t reach) {
    return a.low.x - reach <= b.high.x && b.low.x - reach <= a.high.x &&
           a.low.y - reach <= b.high.y && b.low.y - reach <= a.high.y;
}

// Whether two edges have a point in common.
bool meet(const WholeEdge& a, const WholeEdge& b) {
    return boxes_near(a, b, 0) &&
           sign(cross(a.from, a.to, b.from)) * sign(cross(a.from, a.to, b.to)) <= 0 &&
           sign(cross(b.from, b.to, a.from)) * sign(cross(b.from, b.to, a.to)) <= 0;
}

// A squared distance as a fraction.
struct Square {
    Wide over = 0;
    Wide under = 1;

    bool less_than(Wide square) const { return over < square * under; }
    double value() const { return static_cast<double>(over) / static_cast<double>(under); }
};

Square point_to_edge(const WholePoint& p, const WholeEdge& e) {
    const std::int64_t ux = e.to.x - e.from.x;
    const std::int64_t uy = e.to.y - e.from.y;
    const std::int64_t vx = p.x - e.from.x;
    const std::int64_t vy = p.y - e.from.y;
    const std::int64_t along = ux * vx + uy * vy;
    const std::int64_t length = ux * ux + uy * uy;
    if (along <= 0) {
        return {vx * vx + vy * vy, 1};
    }
    if (along >= length) {
        const std::int64_t wx = p.x - e.to.x;
        const std::int64_t wy = p.y - e.to.y;
        return {wx * wx + wy * wy, 1};
    }
    const Wide area = ux * vy - uy * vx;
    return {area * area, length};
}

std::vector<WholeEdge> edges_of(const WholeRing& ring) {
    std::vector<WholeEdge> edges;
    edges.reserve(ring.size());
    for (std::size_t i = 0; i < ring.size(); ++i) {
        const WholePoint& a = ring[i];
        const WholePoint& b = ring[(i + 1) % ring.size()];
        edges.push_back({a,
                         b,
                         {std::min(a.x, b.x), std::min(a.y, b.y)},
                         {std::max(a.x, b.x), std::max(a.y, b.y)}});
    }
    return edges;
}

WholeBox box_of(const WholeRing& ring) {
    WholeBox box;
    for (const WholePoint& p : ring) {
        box.low = {std::min(box.low.x, p.x), std::min(box.low.y, p.y)};
        box.high = {std::max(box.high.x, p.x), std::max(box.high.y, p.y)};
    }
    return box;
}

// For a point that is not on the ring: whether it is inside.
bool holds(const WholeRing& ring, const WholePoint& p) {
    bool inside = false;
    for (std::size_t i = 0; i < ring.size(); ++i) {
        const WholePoint& a = ring[i];
        const WholePoint& b = ring[(i + 1) % ring.size()];
        if ((a.y > p.y) == (b.y > p.y)) {
            continue;
        }
        const std::int64_t side = cross(a, b, p);
        inside = (b.y > a.y) == (side > 0) ? !inside : inside;
    }
    return inside;
}

struct Prepared {
    WholeBox box;
    std::vector<WholeEdge> edges;
};

// The least squared distance of two edges nearer than `reach`; infinite if there are none. Fails as
// soon as two are nearer than `gap`.
double least_square(
    const Prepared& a, const Prepared& b, std::int64_t reach, std::int64_t gap, bool& broken) {
    double least = std::numeric_limits<double>::infinity();
    const Wide gap_square = Wide{gap} * gap;
    std::vector<const WholeEdge*> close;
    for (const WholeEdge& edge : b.edges) {
        if (boxes_near(edge, a.box, reach)) {
            close.push_back(&edge);
        }
    }
    for (const WholeEdge& edge : a.edges) {
        if (close.empty() || !boxes_near(edge, b.box, reach)) {
            continue;
        }
        for (const WholeEdge* other : close) {
            if (!boxes_near(edge, *other, reach)) {
                continue;
            }
            const bool crossing = meet(edge, *other);
            for (const Square& square :
                 {point_to_edge(edge.from, *other), point_to_edge(edge.to, *other),
                  point_to_edge(other->from, edge), point_to_edge(other->to, edge)}) {
                broken = broken || crossing || square.less_than(gap_square);
                least = std::min(least, crossing ? 0.0 : square.value());
            }
        }
    }
    return least;
}

double smallest_distance(std::span<const PlacedRing> rings,
                         const std::vector<Prepared>& prepared,
                         std::int64_t reach,
                         std::int64_t gap) {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < rings.size(); ++i) {
        for (std::size_t j = 0; j < i; ++j) {
            if (!boxes_near(prepared[i].box, prepared[j].box, reach)) {
                continue;
            }
            bool broken = false;
            const double square = least_square(prepared[i], prepared[j], reach, gap, broken);
            broken = broken || holds(rings[i].ring, rings[j].ring.front()) ||
                     holds(rings[j].ring, rings[i].ring.front());
            if (broken) {
                fail(
                    fmt::format("{} and {} overlap or are too near", rings[j].name, rings[i].name));
            }
            least = std::min(least, square);
        }
    }
    return std::sqrt(least);
}

}  // namespace

double exact_unit(double extent) {
    double unit = 1e-6;
    while (extent / unit > 0x1p29) {
        unit *= 2.0;
    }
    while (extent / unit < 0x1p27 && extent > 0.0) {
        unit /= 2.0;
    }
    return unit;
}

WholeRing to_whole(const Ring& ring, double unit) {
    WholeRing out;
    out.reserve(ring.size());
    for (const Eigen::Vector2d& point : ring) {
        out.push_back({std::llround(point.x() / unit), std::llround(point.y() / unit)});
    }
    return out;
}

double prove_apart(std::span<const PlacedRing> rings, std::int64_t gap) {
    std::vector<Prepared> prepared;
    prepared.reserve(rings.size());
    WholeBox whole;
    for (const PlacedRing& placed : rings) {
        prepared.push_back({box_of(placed.ring), edges_of(placed.ring)});
        const WholeBox& box = prepared.back().box;
        whole.low = {std::min(whole.low.x, box.low.x), std::min(whole.low.y, box.low.y)};
        whole.high = {std::max(whole.high.x, box.high.x), std::max(whole.high.y, box.high.y)};
    }
    if (rings.size() < 2) {
        return std::numeric_limits<double>::infinity();
    }
    // A short reach finds the smallest distance at once where parts are crowded.
    const std::int64_t diagonal = whole.high.x - whole.low.x + whole.high.y - whole.low.y + 1;
    for (std::int64_t reach = std::max<std::int64_t>(gap + gap / 4, diagonal / 4096) + 1;;
         reach *= 16) {
        const double least = smallest_distance(rings, prepared, std::min(reach, diagonal), gap);
        if (least <= static_cast<double>(reach) || reach >= diagonal) {
            return least;
        }
    }
}

void prove_within(std::span<const PlacedRing> rings, WholePoint low, WholePoint high) {
    for (const PlacedRing& placed : rings) {
        const WholeBox box = box_of(placed.ring);
        if (box.low.x < low.x || box.low.y < low.y || box.high.x > high.x || box.high.y > high.y) {
            fail(fmt::format("{} leaves the sheet or its margin", placed.name));
        }
    }
}

void prove_clear(std::span<const PlacedRing> rings, const PlacedRing& obstacle, std::int64_t gap) {
    const Prepared fixed{box_of(obstacle.ring), edges_of(obstacle.ring)};
    for (const PlacedRing& placed : rings) {
        const Prepared part{box_of(placed.ring), edges_of(placed.ring)};
        bool broken = false;
        least_square(part, fixed, gap, gap, broken);
        if (broken || holds(obstacle.ring, placed.ring.front()) ||
            holds(placed.ring, obstacle.ring.front())) {
            fail(fmt::format("{} overlaps {} or is too near", placed.name, obstacle.name));
        }
    }
}

void prove_inside(std::span<const PlacedRing> rings, const WholeRing& outline, std::int64_t gap) {
    const Prepared frame{box_of(outline), edges_of(outline)};
    for (const PlacedRing& placed : rings) {
        const Prepared part{box_of(placed.ring), edges_of(placed.ring)};
        bool broken = false;
        least_square(part, frame, gap, gap, broken);
        if (broken || !holds(outline, placed.ring.front())) {
            fail(fmt::format("{} leaves its sheet or its margin", placed.name));
        }
    }
}

}  // namespace leafcutter::fab
