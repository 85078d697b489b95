// The loops over lanes are written for the vectoriser. Where the processor has AVX2, the same code
// is compiled once more for it; without fused operations both give equal bits.

#include "fab/nest/pair_loss.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "fab/nest/lanes.h"

namespace leafcutter::fab {

namespace {

constexpr std::size_t kLanes = TurnedPart::kLanes;

// Of bands: the width of the smooth tail, and the price of crossing, in widths.
constexpr float kBandTail = 0.1F;
constexpr float kCrossing = 0.5F;

LEAFCUTTER_INLINE bool any(const std::array<std::int32_t, kLanes>& lanes) {
    std::int32_t hit = 0;
    LEAFCUTTER_LANES
    for (std::size_t k = 0; k < kLanes; ++k) {
        hit |= lanes[k];
    }
    return hit != 0;
}

// Whether a group of circles of `a` may touch one of `b`; `reach` apart counts as near.
LEAFCUTTER_INLINE bool groups_near(const TurnedPart& a,
                                   std::size_t i,
                                   const TurnedPart& b,
                                   std::size_t j,
                                   const std::array<float, 3>& shift_and_reach) {
    const auto [dx, dy, reach] = shift_and_reach;
    return a.group_x0[i] + dx - reach <= b.group_x1[j] &&
           a.group_x1[i] + dx + reach >= b.group_x0[j] &&
           a.group_y0[i] + dy - reach <= b.group_y1[j] &&
           a.group_y1[i] + dy + reach >= b.group_y0[j];
}

// `circle`: centre and radius.
LEAFCUTTER_INLINE bool circle_touches(const TurnedPart& b,
                                      std::size_t first,
                                      const std::array<float, 3>& circle) {
    const auto [x, y, r] = circle;
    const float* bx = b.circle_x.data() + first;
    const float* by = b.circle_y.data() + first;
    const float* br = b.circle_r.data() + first;
    std::array<std::int32_t, kLanes> hit{};
    LEAFCUTTER_LANES
    for (std::size_t k = 0; k < kLanes; ++k) {
        const float ex = bx[k] - x;
        const float ey = by[k] - y;
        const float reach = br[k] + r;
        hit[k] = ex * ex + ey * ey < reach * reach ? 1 : 0;
    }
    return any(hit);
}

LEAFCUTTER_INLINE bool circles_touch(const TurnedPart& a, const TurnedPart& b, float dx, float dy) {
    const std::size_t a_groups = a.group_x0.size();
    const std::size_t b_groups = b.group_x0.size();
    for (std::size_t i = 0; i < a_groups; ++i) {
        for (std::size_t j = 0; j < b_groups; ++j) {
            if (!groups_near(a, i, b, j, {dx, dy, 0.0F})) {
                continue;
            }
            const std::size_t last = std::min(a.circles, (i + 1) * kLanes);
            for (std::size_t c = i * kLanes; c < last; ++c) {
                if (circle_touches(b, j * kLanes,
                                   {a.circle_x[c] + dx, a.circle_y[c] + dy, a.circle_r[c]})) {
                    return true;
                }
            }
        }
    }
    return false;
}

struct Edge {
    float x0, y0, x1, y1;
    float low_x, low_y, high_x, high_y;
};

// Whether the edge has a point in common with one of the kLanes edges from `first`.
LEAFCUTTER_INLINE bool edge_meets(const Edge& e, const TurnedPart& b, std::size_t first) {
    const float* px = b.x0.data() + first;
    const float* py = b.y0.data() + first;
    const float* qx = b.x1.data() + first;
    const float* qy = b.y1.data() + first;
    const float ux = e.x1 - e.x0;
    const float uy = e.y1 - e.y0;
    std::array<std::int32_t, kLanes> hit{};
    for (std::size_t k = 0; k < kLanes; ++k) {
        const float vx = qx[k] - px[k];
        const float vy = qy[k] - py[k];
        const float wx = px[k] - e.x0;
        const float wy = py[k] - e.y0;
        const float side_p = ux * wy - uy * wx;
        const float side_q = ux * (qy[k] - e.y0) - uy * (qx[k] - e.x0);
        const float side_0 = vx * wy - vy * wx;
        const float side_1 = vx * (py[k] - e.y1) - vy * (px[k] - e.x1);
        const std::int32_t crosses =
            (side_p * side_q <= 0.0F ? 1 : 0) & (side_0 * side_1 <= 0.0F ? 1 : 0);
        const std::int32_t near = (std::min(px[k], qx[k]) <= e.high_x ? 1 : 0) &
                                  (std::max(px[k], qx[k]) >= e.low_x ? 1 : 0) &
                                  (std::min(py[k], qy[k]) <= e.high_y ? 1 : 0) &
                                  (std::max(py[k], qy[k]) >= e.low_y ? 1 : 0);
        hit[k] = crosses & near;
    }
    return any(hit);
}

// Whether an edge of block `block` of `a` meets any of block `other` of `b`.
LEAFCUTTER_INLINE bool blocks_meet(const TurnedPart& a,
                                   std::size_t block,
                                   const TurnedPart& b,
                                   std::size_t other,
                                   const std::array<float, 2>& shift) {
    const std::size_t last = std::min(a.edges, (block + 1) * kLanes);
    const float low_x = b.block_x0[other];
    const float low_y = b.block_y0[other];
    const float high_x = b.block_x1[other];
    const float high_y = b.block_y1[other];
    for (std::size_t i = block * kLanes; i < last; ++i) {
        Edge e{};
        e.x0 = a.x0[i] + shift[0];
        e.y0 = a.y0[i] + shift[1];
        e.x1 = a.x1[i] + shift[0];
        e.y1 = a.y1[i] + shift[1];
        e.low_x = std::min(e.x0, e.x1);
        e.high_x = std::max(e.x0, e.x1);
        e.low_y = std::min(e.y0, e.y1);
        e.high_y = std::max(e.y0, e.y1);
        const bool near =
            e.low_x <= high_x && e.high_x >= low_x && e.low_y <= high_y && e.high_y >= low_y;
        if (near && edge_meets(e, b, other * kLanes)) {
            return true;
        }
    }
    return false;
}

// Whether an edge of block `block` of `a` meets one of the kLanes blocks of `b` from `first`.
LEAFCUTTER_INLINE bool block_meets(const TurnedPart& a,
                                   std::size_t block,
                                   const TurnedPart& b,
                                   std::size_t first,
                                   const std::array<float, 2>& shift) {
    const float* b_x0 = b.block_x0.data() + first;
    const float* b_y0 = b.block_y0.data() + first;
    const float* b_x1 = b.block_x1.data() + first;
    const float* b_y1 = b.block_y1.data() + first;
    const float low_x = a.block_x0[block] + shift[0];
    const float low_y = a.block_y0[block] + shift[1];
    const float high_x = a.block_x1[block] + shift[0];
    const float high_y = a.block_y1[block] + shift[1];
    std::array<std::int32_t, kLanes> near{};
    for (std::size_t k = 0; k < kLanes; ++k) {
        near[k] = (b_x0[k] <= high_x ? 1 : 0) & (b_x1[k] >= low_x ? 1 : 0) &
                  (b_y0[k] <= high_y ? 1 : 0) & (b_y1[k] >= low_y ? 1 : 0);
    }
    if (!any(near)) {
        return false;
    }
    for (std::size_t k = 0; k < kLanes && first + k < b.blocks; ++k) {
        if (near[k] != 0 && blocks_meet(a, block, b, first + k, shift)) {
            return true;
        }
    }
    return false;
}

LEAFCUTTER_INLINE bool edges_meet(const TurnedPart& a, const TurnedPart& b, float dx, float dy) {
    for (std::size_t block = 0; block < a.blocks; ++block) {
        const bool far = a.block_x0[block] + dx > b.high_x || a.block_x1[block] + dx < b.low_x ||
                         a.block_y0[block] + dy > b.high_y || a.block_y1[block] + dy < b.low_y;
        for (std::size_t first = 0; !far && first < b.blocks; first += kLanes) {
            if (block_meets(a, block, b, first, {dx, dy})) {
                return true;
            }
        }
    }
    return false;
}

LEAFCUTTER_INLINE float circle_loss(const TurnedPart& a, const TurnedPart& b, float dx, float dy) {
    const float eps = 0.01F * std::max(a.diameter, b.diameter);
    const float eps_square = eps * eps;
    const float* bx = b.circle_x.data();
    const float* by = b.circle_y.data();
    const float* br = b.circle_r.data();
    std::array<float, kLanes> sums{};
    for (std::size_t i = 0; i < a.circles; ++i) {
        const float x = a.circle_x[i] + dx;
        const float y = a.circle_y[i] + dy;
        const float r = a.circle_r[i];
        for (std::size_t j = 0; j < b.circles; j += kLanes) {
            for (std::size_t k = 0; k < kLanes; ++k) {
                const float ex = bx[j + k] - x;
                const float ey = by[j + k] - y;
                const float depth = br[j + k] + r - std::sqrt(ex * ex + ey * ey);
                const float tail = eps_square / (eps + eps - std::min(depth, eps));
                const float smooth = depth >= eps ? depth : tail;
                sums[k] += smooth * (br[j + k] < r ? br[j + k] : r);
            }
        }
    }
    float sum = 0.0F;
    for (std::size_t k = 0; k < kLanes; ++k) {
        sum += sums[k];
    }
    return std::sqrt(std::numbers::pi_v<float> * sum + eps_square) * a.hull_root * b.hull_root;
}

// Overlaps of two groups of circles of bands, by lane. (Sums of the caller's could be any of the
// numbers read here, for all the vectoriser knows.)
LEAFCUTTER_INLINE std::array<float, kLanes> band_groups(const TurnedPart& a,
                                                        const TurnedPart& b,
                                                        const std::array<std::size_t, 2>& groups,
                                                        const std::array<float, 2>& shift) {
    const auto [i, j] = groups;
    const float width = 0.5F * (a.width + b.width);
    const float eps = kBandTail * width;
    const float eps_square = eps * eps;
    const float per_width = kCrossing / width;
    const float* bx = b.circle_x.data() + j * kLanes;
    const float* by = b.circle_y.data() + j * kLanes;
    const float* br = b.circle_r.data() + j * kLanes;
    const float* bu = b.along_x.data() + j * kLanes;
    const float* bv = b.along_y.data() + j * kLanes;
    const float* be = b.to_end.data() + j * kLanes;
    const std::size_t last = std::min(a.circles, (i + 1) * kLanes);
    std::array<float, kLanes> sums{};
    for (std::size_t c = i * kLanes; c < last; ++c) {
        const float x = a.circle_x[c] + shift[0];
        const float y = a.circle_y[c] + shift[1];
        const float r = a.circle_r[c];
        const float u = a.along_x[c];
        const float v = a.along_y[c];
        const float to_end = a.to_end[c];
        for (std::size_t k = 0; k < kLanes; ++k) {
            const float ex = bx[k] - x;
            const float ey = by[k] - y;
            const float depth = br[k] + r - std::sqrt(ex * ex + ey * ey);
            const float tail = eps_square / (eps + eps - std::min(depth, eps));
            const float smooth = depth >= eps ? depth : tail;
            const float cosine = u * bu[k] + v * bv[k];
            const float end = be[k] < to_end ? be[k] : to_end;
            const float across = 1.0F + (1.0F - cosine * cosine) * end * per_width;
            sums[k] += smooth * across * (br[k] < r ? br[k] : r);
        }
    }
    return sums;
}

// Between bands: where they cross, what counts is how far the nearest end is, since one must slide
// off the other; where they lie side by side, how deep they overlap.
LEAFCUTTER_INLINE float band_loss(const TurnedPart& a, const TurnedPart& b, float dx, float dy) {
    const float width = 0.5F * (a.width + b.width);
    const float eps = kBandTail * width;
    std::array<float, kLanes> sums{};
    for (std::size_t i = 0; i < a.group_x0.size(); ++i) {
        for (std::size_t j = 0; j < b.group_x0.size(); ++j) {
            if (groups_near(a, i, b, j, {dx, dy, width})) {
                const std::array<float, kLanes> more = band_groups(a, b, {i, j}, {dx, dy});
                for (std::size_t k = 0; k < kLanes; ++k) {
                    sums[k] += more[k];
                }
            }
        }
    }
    float sum = 0.0F;
    for (std::size_t k = 0; k < kLanes; ++k) {
        sum += sums[k];
    }
    return std::sqrt(std::numbers::pi_v<float> * sum + eps * eps) * a.hull_root * b.hull_root;
}

// Whether the point lies inside, by the number of edges to its right.
bool holds_point(const TurnedPart& part, float x, float y) {
    bool inside = false;
    for (std::size_t i = 0; i < part.edges; ++i) {
        const float ay = part.y0[i];
        const float by = part.y1[i];
        if ((ay > y) != (by > y)) {
            const float at = part.x0[i] + (part.x1[i] - part.x0[i]) * ((y - ay) / (by - ay));
            inside = at > x ? !inside : inside;
        }
    }
    return inside;
}

// Without a crossing, one may still lie within the other.
bool nested(const TurnedPart& a, const TurnedPart& b, float dx, float dy) {
    const bool a_within = a.low_x + dx >= b.low_x && a.high_x + dx <= b.high_x &&
                          a.low_y + dy >= b.low_y && a.high_y + dy <= b.high_y;
    if (a_within) {
        return holds_point(b, a.x0[0] + dx, a.y0[0] + dy);
    }
    const bool b_within = b.low_x - dx >= a.low_x && b.high_x - dx <= a.high_x &&
                          b.low_y - dy >= a.low_y && b.high_y - dy <= a.high_y;
    return b_within && holds_point(a, b.x0[0] - dx, b.y0[0] - dy);
}

LEAFCUTTER_INLINE float loss_of(const TurnedPart& a, const TurnedPart& b, float dx, float dy) {
    if (circles_touch(a, b, dx, dy) || edges_meet(a, b, dx, dy) || nested(a, b, dx, dy)) {
        return a.band && b.band ? band_loss(a, b, dx, dy) : circle_loss(a, b, dx, dy);
    }
    return 0.0F;
}

using Loss = float (*)(const TurnedPart&, const TurnedPart&, float, float);

[[gnu::hot]] float loss_plain(const TurnedPart& a, const TurnedPart& b, float dx, float dy) {
    return loss_of(a, b, dx, dy);
}

#if defined(__x86_64__) && defined(__GNUC__)
__attribute__((hot, target("avx2"))) float loss_avx2(const TurnedPart& a,
                                                     const TurnedPart& b,
                                                     float dx,
                                                     float dy) {
    return loss_of(a, b, dx, dy);
}

Loss fastest() {
    return __builtin_cpu_supports("avx2") != 0 ? loss_avx2 : loss_plain;
}
#else
Loss fastest() {
    return loss_plain;
}
#endif

}  // namespace

float pair_loss(const TurnedPart& a, const TurnedPart& b, float dx, float dy) {
    static const Loss loss = fastest();
    return loss(a, b, dx, dy);
}

float sheet_loss(const TurnedPart& part, const Eigen::Vector2f& at, const Eigen::Vector2f& room) {
    const float width = room.x();
    const float height = room.y();
    const float low_x = part.low_x + at.x();
    const float low_y = part.low_y + at.y();
    const float high_x = part.high_x + at.x();
    const float high_y = part.high_y + at.y();
    if (low_x >= 0.0F && low_y >= 0.0F && high_x <= width && high_y <= height) {
        return 0.0F;
    }
    const float area = (high_x - low_x) * (high_y - low_y);
    const float in_x = std::min(high_x, width) - std::max(low_x, 0.0F);
    const float in_y = std::min(high_y, height) - std::max(low_y, 0.0F);
    float outside = 0.0F;
    if (in_x > 0.0F && in_y > 0.0F) {
        outside = area - in_x * in_y + 1e-4F * area;
    } else {
        const float off_x = (low_x + high_x - width) / 2.0F;
        const float off_y = (low_y + high_y - height) / 2.0F;
        outside = area + std::sqrt(off_x * off_x + off_y * off_y);
    }
    return 2.0F * std::sqrt(outside) * std::sqrt(part.hull_area);
}

}  // namespace leafcutter::fab
