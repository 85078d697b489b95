#include "fab/cut/facing_edges.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>

#include "geometry/plane.h"

namespace leafcutter::fab {

using geometry::turn_of;

namespace {

using Eigen::Vector2d;

constexpr double kCellMm = 10.0;

class NearEdges {
public:
    NearEdges(std::span<const Ring> rings, const FacingOptions& options)
        : rings_(rings), options_(options) {
        for (std::size_t c = 0; c < rings.size(); ++c) {
            for (std::size_t i = 0; i < rings[c].size(); ++i) {
                visit_cells({c, i}, [&](std::uint64_t cell) { cells_[cell].push_back({c, i}); });
            }
        }
    }

    // Calls found(a, b) once for every pair.
    template <typename Found>
    void each_pair(const Found& found) const {
        for (std::size_t c = 0; c < rings_.size(); ++c) {
            for (std::size_t i = 0; i < rings_[c].size(); ++i) {
                std::vector<std::pair<std::size_t, std::size_t>> partners;
                visit_cells({c, i}, [&](std::uint64_t cell) {
                    for (const RingSpot& other : cells_.at(cell)) {
                        if (other.contour > c) {
                            partners.emplace_back(other.contour, other.index);
                        }
                    }
                });
                std::sort(partners.begin(), partners.end());
                partners.erase(std::unique(partners.begin(), partners.end()), partners.end());
                for (const auto& [contour, index] : partners) {
                    if (face({c, i}, {contour, index})) {
                        found(RingSpot{c, i}, RingSpot{contour, index});
                    }
                }
            }
        }
    }

private:
    const Vector2d& from(const RingSpot& edge) const { return rings_[edge.contour][edge.index]; }
    const Vector2d& to(const RingSpot& edge) const {
        return rings_[edge.contour][(edge.index + 1) % rings_[edge.contour].size()];
    }

    template <typename Visit>
    void visit_cells(const RingSpot& edge, const Visit& visit) const {
        const Vector2d low = (from(edge).cwiseMin(to(edge)).array() - options_.apart_mm) / kCellMm;
        const Vector2d high = (from(edge).cwiseMax(to(edge)).array() + options_.apart_mm) / kCellMm;
        for (auto x = std::llround(std::floor(low.x())); static_cast<double>(x) <= high.x(); ++x) {
            for (auto y = std::llround(std::floor(low.y())); static_cast<double>(y) <= high.y();
                 ++y) {
                visit((static_cast<std::uint64_t>(x) << 32U) ^
                      (static_cast<std::uint64_t>(y) & 0xffffffffU));
            }
        }
    }

    bool face(const RingSpot& a, const RingSpot& b) const {
        const Vector2d along = (to(a) - from(a)).normalized();
        if (along.dot(to(b) - from(b)) >= 0.0) {
            return false;
        }
        const double length = (to(a) - from(a)).norm();
        const double t0 = along.dot(to(b) - from(a));
        const double t1 = along.dot(from(b) - from(a));
        const double low = std::max(0.0, t0);
        const double high = std::min(length, t1);
        if (high - low < options_.least_mm) {
            return false;
        }
        const double d0 = turn_of(along, to(b) - from(a));
        const double slope = (turn_of(along, from(b) - from(a)) - d0) / (t1 - t0);
        return std::abs(d0 + slope * (low - t0)) <= options_.apart_mm &&
               std::abs(d0 + slope * (high - t0)) <= options_.apart_mm;
    }

    std::span<const Ring> rings_;
    FacingOptions options_;
    std::unordered_map<std::uint64_t, std::vector<RingSpot>> cells_;
};

}  // namespace

std::vector<std::pair<RingSpot, RingSpot>> facing_edges(std::span<const Ring> rings,
                                                        const FacingOptions& options) {
    std::vector<std::pair<RingSpot, RingSpot>> pairs;
    NearEdges(rings, options).each_pair([&](const RingSpot& a, const RingSpot& b) {
        pairs.emplace_back(a, b);
    });
    return pairs;
}

}  // namespace leafcutter::fab
