// The loops over lanes are written for the vectoriser, as those of pair_loss.cpp.

#include "fab/nest/nearest_edge.h"

#include <algorithm>
#include <array>

#include "fab/nest/lanes.h"

namespace leafcutter::fab {

namespace {

using Eigen::Vector2d;

constexpr std::size_t kLanes = TurnedPart::kLanes;
using Lanes = std::array<float, kLanes>;

// Squared distances from the edges of one block.
LEAFCUTTER_INLINE Lanes edge_squares(const TurnedPart& part, std::size_t first, float x, float y) {
    const float* x0 = part.x0.data() + first;
    const float* y0 = part.y0.data() + first;
    const float* x1 = part.x1.data() + first;
    const float* y1 = part.y1.data() + first;
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

// Squared distances from the boxes of kLanes blocks.
LEAFCUTTER_INLINE Lanes box_squares(const TurnedPart& part, std::size_t first, float x, float y) {
    const float* x0 = part.block_x0.data() + first;
    const float* y0 = part.block_y0.data() + first;
    const float* x1 = part.block_x1.data() + first;
    const float* y1 = part.block_y1.data() + first;
    Lanes out{};
    LEAFCUTTER_LANES
    for (std::size_t k = 0; k < kLanes; ++k) {
        const float off_x = std::max(std::max(x0[k] - x, x - x1[k]), 0.0F);
        const float off_y = std::max(std::max(y0[k] - y, y - y1[k]), 0.0F);
        out[k] = off_x * off_x + off_y * off_y;
    }
    return out;
}

// The edge whose squared distance is least and below `best`; part.edges if there is none.
LEAFCUTTER_INLINE std::size_t search(const TurnedPart& part, float x, float y, float best) {
    std::size_t nearest = part.edges;
    for (std::size_t first = 0; first < part.blocks; first += kLanes) {
        const Lanes boxes = box_squares(part, first, x, y);
        for (std::size_t b = 0; b < kLanes && first + b < part.blocks; ++b) {
            if (boxes[b] >= best) {
                continue;
            }
            const std::size_t edge = (first + b) * kLanes;
            const Lanes squares = edge_squares(part, edge, x, y);
            for (std::size_t k = 0; k < kLanes && edge + k < part.edges; ++k) {
                nearest = squares[k] < best ? edge + k : nearest;
                best = std::min(best, squares[k]);
            }
        }
    }
    return nearest;
}

using Search = std::size_t (*)(const TurnedPart&, float, float, float);

std::size_t search_plain(const TurnedPart& part, float x, float y, float best) {
    return search(part, x, y, best);
}

#if defined(__x86_64__) && defined(__GNUC__)
__attribute__((target("avx2"))) std::size_t search_avx2(const TurnedPart& part,
                                                        float x,
                                                        float y,
                                                        float best) {
    return search(part, x, y, best);
}

Search fastest() {
    return __builtin_cpu_supports("avx2") != 0 ? search_avx2 : search_plain;
}
#else
Search fastest() {
    return search_plain;
}
#endif

// Outlines run counterclockwise.
Vector2d outwards(const TurnedPart& part, std::size_t edge) {
    const Vector2d along(static_cast<double>(part.x1[edge]) - static_cast<double>(part.x0[edge]),
                         static_cast<double>(part.y1[edge]) - static_cast<double>(part.y0[edge]));
    return Vector2d(along.y(), -along.x()).normalized();
}

}  // namespace

std::optional<Foot> foot_of(const TurnedPart& part, const Vector2d& from, double reach) {
    static const Search nearest = fastest();
    const std::size_t edge =
        nearest(part, static_cast<float>(from.x()), static_cast<float>(from.y()),
                static_cast<float>(reach * reach));
    if (edge == part.edges) {
        return std::nullopt;
    }
    const Vector2d start(part.x0[edge], part.y0[edge]);
    const Vector2d along = Vector2d(part.x1[edge], part.y1[edge]) - start;
    const double at = std::clamp((from - start).dot(along) / along.squaredNorm(), 0.0, 1.0);
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

}  // namespace leafcutter::fab
