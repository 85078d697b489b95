// The loops over lanes are written for the vectoriser, as those of pair_loss.cpp.

#include "fab/nest/nearest_edge.h"

#include <algorithm>
#include <array>
#include <utility>

#include "fab/nest/lanes.h"

namespace leafcutter::fab {

namespace {

using Eigen::Vector2d;

constexpr std::size_t kLanes = TurnedPart::kLanes;
using Lanes = std::array<float, kLanes>;
using Point = std::array<float, 2>;

// Squared distances from the edges of one block.
LEAFCUTTER_INLINE Lanes edge_squares(const TurnedPart& part,
                                     std::size_t block,
                                     const Point& point) {
    const auto [x, y] = point;
    const float* x0 = part.x0.data() + block * kLanes;
    const float* y0 = part.y0.data() + block * kLanes;
    const float* x1 = part.x1.data() + block * kLanes;
    const float* y1 = part.y1.data() + block * kLanes;
    Lanes out{};
    LEAFCUTTER_LANES
    for (std::size_t k = 0; k < kLanes; ++k) {
        const float ux = x1[k] - x0[k];
        const float uy = y1[k] - y0[k];
        const float wx = x - x0[k];
        const float wy = y - y0[k];
        const float along = (wx * ux + wy * uy) / (ux * ux + uy * uy + 1e-20F);
        const float t = std::min(1.0F, std::max(0.0F, along));
        const float ex = wx - t * ux;
        const float ey = wy - t * uy;
        out[k] = ex * ex + ey * ey;
    }
    return out;
}

LEAFCUTTER_INLINE float least_of(const Lanes& lanes) {
    float least = lanes[0];
    LEAFCUTTER_LANES
    for (std::size_t k = 1; k < kLanes; ++k) {
        least = std::min(least, lanes[k]);
    }
    return least;
}

struct Bounds {
    float low_x, low_y, high_x, high_y;
};

LEAFCUTTER_INLINE bool meets(const TurnedPart& part, std::size_t block, const Bounds& box) {
    return part.block_x0[block] <= box.high_x && part.block_x1[block] >= box.low_x &&
           part.block_y0[block] <= box.high_y && part.block_y1[block] >= box.low_y;
}

// An edge and its squared distance.
struct Nearest {
    std::size_t edge = 0;
    float square = 0.0F;
};

// Takes the block's nearest edge if it is nearer.
LEAFCUTTER_INLINE void take_nearer(const TurnedPart& part,
                                   std::size_t block,
                                   const Point& point,
                                   Nearest& nearest) {
    const Lanes squares = edge_squares(part, block, point);
    const float least = least_of(squares);
    if (least < nearest.square) {
        std::size_t lane = 0;
        while (squares[lane] > least) {
            ++lane;
        }
        nearest = {block * kLanes + lane, least};
    }
}

// `shift_and_reach`: by which the vertices move, and what counts as near.
LEAFCUTTER_INLINE void list_near(const TurnedPart& from,
                                 const TurnedPart& part,
                                 const std::array<float, 3>& shift_and_reach,
                                 std::vector<VertexBlock>& out) {
    const auto [dx, dy, reach] = shift_and_reach;
    for (std::size_t i = 0; i < from.blocks; ++i) {
        const Bounds box{from.block_x0[i] + dx - reach, from.block_y0[i] + dy - reach,
                         from.block_x1[i] + dx + reach, from.block_y1[i] + dy + reach};
        if (box.low_x > part.high_x || box.high_x < part.low_x || box.low_y > part.high_y ||
            box.high_y < part.low_y) {
            continue;
        }
        const std::size_t last = std::min(from.edges, (i + 1) * kLanes);
        for (std::size_t block = 0; block < part.blocks; ++block) {
            if (!meets(part, block, box)) {
                continue;
            }
            for (std::size_t v = i * kLanes; v < last; ++v) {
                const float x = from.x0[v] + dx;
                const float y = from.y0[v] + dy;
                if (meets(part, block, {x - reach, y - reach, x + reach, y + reach}) &&
                    least_of(edge_squares(part, block, {x, y})) < reach * reach) {
                    out.push_back(
                        {static_cast<std::uint32_t>(v), static_cast<std::uint32_t>(block)});
                }
            }
        }
    }
}

using Pairs = std::vector<std::pair<std::size_t, std::size_t>>;

// Each vertex of `among` with the edge nearest to it.
LEAFCUTTER_INLINE void pair_up(const TurnedPart& from,
                               const TurnedPart& part,
                               const std::array<float, 3>& shift_and_reach,
                               const std::vector<VertexBlock>& among,
                               Pairs& out) {
    const auto [dx, dy, reach] = shift_and_reach;
    for (std::size_t k = 0; k < among.size();) {
        const std::size_t v = among[k].vertex;
        const Point point{from.x0[v] + dx, from.y0[v] + dy};
        Nearest nearest{part.edges, reach * reach};
        for (; k < among.size() && among[k].vertex == v; ++k) {
            take_nearer(part, among[k].block, point, nearest);
        }
        if (nearest.edge < part.edges) {
            out.emplace_back(v, nearest.edge);
        }
    }
}

// The two above, compiled for one kind of processor.
struct Kernels {
    void (*list_near)(const TurnedPart&,
                      const TurnedPart&,
                      const std::array<float, 3>&,
                      std::vector<VertexBlock>&);
    void (*pair_up)(const TurnedPart&,
                    const TurnedPart&,
                    const std::array<float, 3>&,
                    const std::vector<VertexBlock>&,
                    Pairs&);
};

void list_near_plain(const TurnedPart& from,
                     const TurnedPart& part,
                     const std::array<float, 3>& shift_and_reach,
                     std::vector<VertexBlock>& out) {
    list_near(from, part, shift_and_reach, out);
}

void pair_up_plain(const TurnedPart& from,
                   const TurnedPart& part,
                   const std::array<float, 3>& shift_and_reach,
                   const std::vector<VertexBlock>& among,
                   Pairs& out) {
    pair_up(from, part, shift_and_reach, among, out);
}

#if defined(__x86_64__) && defined(__GNUC__)
__attribute__((target("avx2"))) void list_near_avx2(const TurnedPart& from,
                                                    const TurnedPart& part,
                                                    const std::array<float, 3>& shift_and_reach,
                                                    std::vector<VertexBlock>& out) {
    list_near(from, part, shift_and_reach, out);
}

__attribute__((target("avx2"))) void pair_up_avx2(const TurnedPart& from,
                                                  const TurnedPart& part,
                                                  const std::array<float, 3>& shift_and_reach,
                                                  const std::vector<VertexBlock>& among,
                                                  Pairs& out) {
    pair_up(from, part, shift_and_reach, among, out);
}

Kernels fastest() {
    return __builtin_cpu_supports("avx2") != 0 ? Kernels{list_near_avx2, pair_up_avx2}
                                               : Kernels{list_near_plain, pair_up_plain};
}
#else
Kernels fastest() {
    return {list_near_plain, pair_up_plain};
}
#endif

const Kernels& kernels() {
    static const Kernels fast = fastest();
    return fast;
}

std::array<float, 3> as_floats(const Approach& approach) {
    return {static_cast<float>(approach.shift.x()), static_cast<float>(approach.shift.y()),
            static_cast<float>(approach.reach)};
}

// Outlines run counterclockwise.
Vector2d outwards(const TurnedPart& part, std::size_t edge) {
    const Vector2d along(static_cast<double>(part.x1[edge]) - static_cast<double>(part.x0[edge]),
                         static_cast<double>(part.y1[edge]) - static_cast<double>(part.y0[edge]));
    return Vector2d(along.y(), -along.x()).normalized();
}

Foot foot_on(const TurnedPart& part, std::size_t edge, const Vector2d& from) {
    const Vector2d start(part.x0[edge], part.y0[edge]);
    const Vector2d along = Vector2d(part.x1[edge], part.y1[edge]) - start;
    // Vertices that lie very close together may be one as floats.
    const double square = along.squaredNorm();
    const double at = square > 0.0 ? std::clamp((from - start).dot(along) / square, 0.0, 1.0) : 0.0;
    Vector2d out = outwards(part, edge);
    if (at <= 0.0) {
        out += outwards(part, edge == 0 ? part.edges - 1 : edge - 1);
    } else if (at >= 1.0) {
        out += outwards(part, edge + 1 == part.edges ? 0 : edge + 1);
    }
    Foot foot;
    foot.point = start + at * along;
    const Vector2d off = from - foot.point;
    const double sign = off.dot(out) >= 0.0 ? 1.0 : -1.0;
    foot.distance = sign * off.norm();
    // At a corner the direction is that of the way there, unless that is too short to have one.
    const bool corner = (at <= 0.0 || at >= 1.0) && off.norm() > 1e-6;
    foot.normal = corner ? Vector2d(sign * off.normalized()) : out.normalized();
    return foot;
}

}  // namespace

std::optional<Foot> foot_of(const TurnedPart& part, const Vector2d& from, double reach) {
    const auto x = static_cast<float>(from.x());
    const auto y = static_cast<float>(from.y());
    const auto near = static_cast<float>(reach);
    Nearest nearest{part.edges, near * near};
    for (std::size_t block = 0; block < part.blocks; ++block) {
        if (meets(part, block, {x - near, y - near, x + near, y + near})) {
            take_nearer(part, block, {x, y}, nearest);
        }
    }
    if (nearest.edge == part.edges) {
        return std::nullopt;
    }
    return foot_on(part, nearest.edge, from);
}

void near_blocks(const Approach& approach, std::vector<VertexBlock>& out) {
    out.clear();
    kernels().list_near(approach.from, approach.part, as_floats(approach), out);
    std::sort(out.begin(), out.end(), [](const VertexBlock& a, const VertexBlock& b) {
        return a.vertex != b.vertex ? a.vertex < b.vertex : a.block < b.block;
    });
}

void feet_among(const Approach& approach,
                const std::vector<VertexBlock>& among,
                std::vector<VertexFoot>& out) {
    static thread_local Pairs pairs;
    pairs.clear();
    out.clear();
    const TurnedPart& from = approach.from;
    kernels().pair_up(from, approach.part, as_floats(approach), among, pairs);
    for (const auto& [vertex, edge] : pairs) {
        const Vector2d at = Vector2d(from.x0[vertex], from.y0[vertex]) + approach.shift;
        out.push_back({vertex, foot_on(approach.part, edge, at)});
    }
}

}  // namespace leafcutter::fab
