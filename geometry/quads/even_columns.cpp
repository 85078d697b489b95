#include "geometry/quads/even_columns.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "geometry/error.h"
#include "geometry/parallel.h"
#include "geometry/quads/spacing.h"

namespace leafcutter::geometry {
namespace {

// How far from even in g to even on the surface: ever further, until angles suffer.
constexpr std::array<double, 9> kShares{0.1, 0.15, 0.2, 0.25, 0.3, 0.4, 0.6, 0.8, 1.0};
constexpr int kLevels = 256;
// The mean angle may be worse by this part.
constexpr double kMostWorse = 0.03;

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

// A monotone change of g round a ring: piecewise linear, and periodic but for its rise.
class ColumnScale {
public:
    ColumnScale(const Cylinder& chart, double share)
        : width_(chart.width), from_(LevelScale(chart, Axis::G, 0.0).levels(kLevels)) {
        for (std::size_t i = 0; i < from_.size(); ++i) {
            const double even = width_ * static_cast<double>(i) / kLevels;
            to_.push_back((1.0 - share) * from_[i] + share * even);
        }
    }

    double operator()(double g) const {
        const double turns = std::floor(g / width_);
        const double own = g - turns * width_;
        const auto above = std::upper_bound(from_.begin() + 1, from_.end() - 1, own);
        const auto k = static_cast<std::size_t>(above - from_.begin());
        const double step = from_[k] - from_[k - 1];
        const double part = step > 0.0 ? (own - from_[k - 1]) / step : 0.0;
        return turns * width_ + to_[k - 1] + part * (to_[k] - to_[k - 1]);
    }

private:
    double width_;
    std::vector<double> from_;
    std::vector<double> to_;
};

Foliation rescaled(const Foliation& foliation, double share, const Context& context) {
    Foliation result = foliation;
    for_each_task(result.cylinders.size(), context, [&](std::size_t i, const Context&) {
        Cylinder& chart = result.cylinders[i];
        if (chart.shape != ChartShape::Annulus) {
            return;
        }
        const ColumnScale scale(foliation.cylinders[i], share);
        for (auto& corners : chart.corner_gf) {
            for (Eigen::Vector2d& gf : corners) {
                gf.x() = scale(gf.x());
            }
        }
    });
    return result;
}

struct Judgement {
    double variation = 0.0;
    double angle = 0.0;  // Mean deviation of corners from a right angle, radians.
};

Judgement judge(const JoinedMesh& mesh) {
    double sum = 0.0;
    double squares = 0.0;
    double angles = 0.0;
    double count = 0.0;
    for (const JoinedCylinder& part : mesh.parts) {
        for (const double area : part.surface_area) {
            sum += area;
            squares += area * area;
            count += 1.0;
        }
        for (const std::array<int, 4>& quad : part.quads) {
            for (std::size_t k = 0; k < 4; ++k) {
                const Eigen::Vector3d& here = mesh.vertices[at(quad[k])];
                const Eigen::Vector3d u = mesh.vertices[at(quad[(k + 1) % 4])] - here;
                const Eigen::Vector3d v = mesh.vertices[at(quad[(k + 3) % 4])] - here;
                const double cosine = u.dot(v) / std::max(u.norm() * v.norm(), 1e-300);
                angles += std::abs(std::asin(std::clamp(cosine, -1.0, 1.0)));
            }
        }
    }
    const double mean = sum / std::max(count, 1.0);
    return {std::sqrt(std::max(0.0, squares / count - mean * mean)) / mean, angles / (4.0 * count)};
}

}  // namespace

JoinedMesh join_evenly(const Foliation& foliation,
                       const GridOptions& options,
                       const Context& context) {
    JoinedMesh best = join_cylinders(foliation, options, context);
    if (best.cylinders.empty()) {
        return best;
    }
    Judgement least = judge(best);
    const double worst_angle = (1.0 + kMostWorse) * least.angle;
    const std::size_t folded = best.folded;
    for (const double share : kShares) {
        try {
            JoinedMesh next = join_cylinders(rescaled(foliation, share, context), options, context);
            const Judgement found = judge(next);
            if (found.angle > worst_angle) {
                break;
            }
            if (found.variation < least.variation && next.folded <= folded) {
                best = std::move(next);
                least = found;
            }
        } catch (const Error&) {
            continue;  // Even in g it works.
        }
    }
    return best;
}

}  // namespace leafcutter::geometry
