// Planar cells and square corners at once are more than a net on a surface can have: its leaves
// would have to be lines of curvature (Liu, Pottmann, Wallner, Yang, Wang, "Geometric modeling with
// conical meshes and developable surfaces", 2006). What gives way is a matter of weights: corners
// hardly, lengths of sides and places on the surface most (planar_cell.h, planar_anchors.h). The
// path goes through the best nets for a slowly rising weight of planarity, so that cells find
// places far off, which a stiff start would bar.

#include "geometry/quads/planarise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <numeric>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "geometry/closest_point.h"
#include "geometry/quads/planar_solver.h"
#include "geometry/quads/quality.h"

namespace leafcutter::geometry {

namespace {

using Eigen::Vector3d;
using Vertices = std::vector<Vector3d>;

constexpr double kFirstWeight = 0.3;
constexpr double kLastWeight = 100.0;
constexpr double kGrowth = 2.0;
constexpr double kLastGrowth = 1.2;
constexpr double kMostWeight = 3000.0;

constexpr int kMostSteps = 120;
constexpr double kSteady = 0.5;      // Cells: with longer steps the weight stays.
constexpr double kSteadyPart = 0.4;  // Of a step that must be taken for the weight to rise.
constexpr int kPatience = 5;         // Steps after which it rises all the same.
constexpr double kMargin = 0.95;     // Of the bound, for Full.

constexpr int kMostSettling = 8;   // Steps at one weight, for Gentle.
constexpr double kSettled = 0.05;  // Cells.
constexpr int kWeightHalvings = 3;
constexpr int kBlendHalvings = 30;

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

TriangleMesh joined_charts(const Foliation& foliation) {
    TriangleMesh all;
    for (const Cylinder& cylinder : foliation.cylinders) {
        const int base = static_cast<int>(all.positions.size());
        all.positions.insert(all.positions.end(), cylinder.mesh.positions.begin(),
                             cylinder.mesh.positions.end());
        for (const auto& [a, b, c] : cylinder.mesh.triangles) {
            all.triangles.push_back({a + base, b + base, c + base});
        }
    }
    return all;
}

// As Quality::angle_deviation_deg.avg.
double mean_angle_deviation_deg(const QuadMesh& mesh, const Vertices& vertices) {
    std::vector<double> sum(vertices.size(), 0.0);
    std::vector<int> corners(vertices.size(), 0);
    for (const auto& quad : mesh.quads) {
        for (std::size_t i = 0; i < 4; ++i) {
            const Vector3d& corner = vertices[at(quad[i])];
            const Vector3d u = vertices[at(quad[(i + 1) % 4])] - corner;
            const Vector3d w = vertices[at(quad[(i + 3) % 4])] - corner;
            const double lengths = std::max(u.norm() * w.norm(), 1e-300);
            const double angle = std::acos(std::clamp(u.dot(w) / lengths, -1.0, 1.0));
            sum[at(quad[i])] += std::abs(angle * 180.0 / std::numbers::pi - 90.0);
            ++corners[at(quad[i])];
        }
    }
    double total = 0.0;
    int count = 0;
    for (std::size_t v = 0; v < vertices.size(); ++v) {
        if (corners[v] > 0) {
            total += sum[v] / corners[v];
            ++count;
        }
    }
    return count > 0 ? total / count : 0.0;
}

PlanarisationPrice::Figures figures_of(const Quality& quality) {
    return {.planarity_max_percent = quality.planarity_percent.max,
            .planarity_avg_percent = quality.planarity_percent.avg,
            .angle_deviation_avg_deg = quality.angle_deviation_deg.avg,
            .surface_distance_max_percent = quality.surface_distance_percent.max,
            .surface_distance_avg_percent = quality.surface_distance_percent.avg,
            .area_distortion_avg_percent = quality.area_distortion_percent};
}

class Planariser {
public:
    Planariser(const QuadMesh& mesh, const TriangleMesh& surface, const Context& context)
        : mesh_(mesh), context_(context), solver_(mesh, surface, context) {}

    int iterations() const { return iterations_; }

    // The weight rises to its end, then the multipliers do the rest. Where some cells stay bent:
    // the net with the fewest.
    Vertices full() {
        Vertices best = mesh_.vertices;
        std::size_t least = solver_.cells_over(kMargin * kFullPlanarity);
        double weight = kFirstWeight;
        int waited = 0;
        while (iterations_ < kMostSteps && least > 0) {
            const PlanarSolver::Step step = advance(weight);
            const std::size_t over = solver_.cells_over(kMargin * kFullPlanarity);
            if (over < least && solver_.is_sound(solver_.state().vertices)) {
                least = over;
                best = solver_.state().vertices;
            }
            const bool steady = step.wanted <= kSteady && step.taken >= kSteadyPart;
            if (!steady && ++waited < kPatience) {
                continue;
            }
            waited = 0;
            const bool pressing = weight >= kLastWeight;
            if (pressing && step.taken > 0.0 && step.wanted <= kSettled) {
                solver_.raise_pulls(weight);
            }
            weight = std::min((pressing ? kLastGrowth : kGrowth) * weight, kMostWeight);
        }
        return best;
    }

    // The highest weight whose best net is square enough, by bisection; then what is left of the
    // angle on the way to the next one.
    Vertices gentle() {
        const double limit =
            mean_angle_deviation_deg(mesh_, mesh_.vertices) + kGentleAngleDeg - kAngleMarginDeg;
        const auto allowed = [&](const Vertices& vertices) {
            return mean_angle_deviation_deg(mesh_, vertices) <= limit && solver_.is_sound(vertices);
        };
        PlanarSolver::State good = solver_.state();
        Vertices bad;
        double low = 0.0;
        double high = 0.0;
        for (double weight = kFirstWeight; weight <= kLastWeight; weight *= kGrowth) {
            settle(weight);
            if (!allowed(solver_.state().vertices)) {
                bad = solver_.state().vertices;
                high = weight;
                break;
            }
            good = solver_.state();
            low = weight;
            if (solver_.bend().largest <= kMargin * kFullPlanarity) {
                return good.vertices;
            }
        }
        for (int i = 0; i < kWeightHalvings && low > 0.0 && high > 0.0; ++i) {
            const double middle = std::sqrt(low * high);
            solver_.set_state(good);
            settle(middle);
            if (allowed(solver_.state().vertices)) {
                good = solver_.state();
                low = middle;
            } else {
                bad = solver_.state().vertices;
                high = middle;
            }
        }
        return bad.empty() ? good.vertices : furthest_blend(good.vertices, bad, allowed);
    }

private:
    // So that rounding never shows more than was allowed.
    static constexpr double kAngleMarginDeg = 1e-6;

    PlanarSolver::Step advance(double weight) {
        context_.check();
        ++iterations_;
        return solver_.step(weight);
    }

    void settle(double weight) {
        for (int i = 0; i < kMostSettling; ++i) {
            const PlanarSolver::Step step = advance(weight);
            if (step.taken == 0.0 || step.wanted < kSettled) {
                return;
            }
        }
    }

    // From `good` towards `bad` as far as is allowed and makes cells flatter.
    template <typename Allowed>
    Vertices furthest_blend(const Vertices& good, const Vertices& bad, const Allowed& allowed) {
        const auto blend = [&](double part) {
            Vertices between(good.size());
            for (std::size_t v = 0; v < good.size(); ++v) {
                between[v] = good[v] + part * (bad[v] - good[v]);
            }
            return between;
        };
        double low = 0.0;
        double high = 1.0;
        for (int i = 0; i < kBlendHalvings; ++i) {
            const double middle = 0.5 * (low + high);
            (allowed(blend(middle)) ? low : high) = middle;
        }
        Vertices found = blend(low);
        return solver_.bend_of_cells(found).mean < solver_.bend_of_cells(good).mean ? found : good;
    }

    const QuadMesh& mesh_;
    const Context& context_;
    PlanarSolver solver_;
    int iterations_ = 0;
};

void move_vertices(QuadMesh& mesh, Vertices moved, PlanarisationPrice& price) {
    for (std::size_t v = 0; v < moved.size(); ++v) {
        const double moved_by = (moved[v] - mesh.vertices[v]).norm();
        price.largest_displacement_mm = std::max(price.largest_displacement_mm, moved_by);
        price.mean_displacement_mm += moved_by / static_cast<double>(moved.size());
    }
    mesh.vertices = std::move(moved);
}

// Cells stand for the surface they lie over, and for the limbs they capped before unless they grew
// into them; together for as much as before. What no cell lies over any more is on account of those
// that left it.
void move_regions(QuadMesh& mesh,
                  const std::vector<CellQuality>& before,
                  const std::vector<CellQuality>& after,
                  PlanarisationPrice& price) {
    const std::vector<double> old_regions = mesh.surface_area;
    double missing = 0.0;
    double shrunk = 0.0;
    for (std::size_t cell = 0; cell < mesh.quads.size(); ++cell) {
        const auto ratio = [&](double CellQuality::*area) {
            const double old_area = before[cell].*area;
            return old_area > 0.0 ? after[cell].*area / old_area : 1.0;
        };
        price.cell_area_change_avg_percent += 100.0 * std::abs(ratio(&CellQuality::area) - 1.0) /
                                              static_cast<double>(mesh.quads.size());
        const double part = ratio(&CellQuality::projected_area);
        double& region = mesh.surface_area[cell];
        region = part < 1.0 ? part * region : std::max(region, after[cell].projected_area);
        missing += old_regions[cell] - region;
        shrunk += std::max(old_regions[cell] - region, 0.0);
    }
    const double sum = std::accumulate(old_regions.begin(), old_regions.end(), 0.0);
    for (std::size_t cell = 0; cell < old_regions.size(); ++cell) {
        double& region = mesh.surface_area[cell];
        if (missing > 0.0) {
            region += missing / shrunk * std::max(old_regions[cell] - region, 0.0);
        } else {
            region *= sum > 0.0 ? sum / (sum - missing) : 1.0;
        }
    }
}

void warn_unless_reached(QuadMesh& mesh, const std::vector<CellQuality>& cells) {
    const PlanarisationPrice& price = *mesh.planarisation;
    if (price.reached) {
        return;
    }
    const auto bent = std::count_if(cells.begin(), cells.end(), [](const CellQuality& cell) {
        return cell.planarity_percent > 100.0 * kFullPlanarity;
    });
    mesh.warnings.push_back(fmt::format(
        "grid.planar: {} of {} cells are not planar to {:.3g} %, but to {:.3g} % at worst; the "
        "average angle deviation rose from {:.2f} to {:.2f} degrees, the average distance to the "
        "surface from {:.3f} to {:.3f} %, vertices moved by up to {:.3g} mm. Use narrower strips, "
        "or \"gentle\"",
        bent, cells.size(), 100.0 * kFullPlanarity, price.after.planarity_max_percent,
        price.before.angle_deviation_avg_deg, price.after.angle_deviation_avg_deg,
        price.before.surface_distance_avg_percent, price.after.surface_distance_avg_percent,
        price.largest_displacement_mm));
}

}  // namespace

void planarise(QuadMesh& mesh,
               const Foliation& foliation,
               Planarity wanted,
               const Context& context) {
    if (wanted == Planarity::Off || mesh.quads.empty()) {
        return;
    }
    const TriangleMesh surface = joined_charts(foliation);
    const ClosestPoint closest(surface);
    QualityReport report = measure_quality(mesh, closest, context);
    PlanarisationPrice price;
    price.wanted = wanted;
    price.before = figures_of(report.overall);
    price.after = price.before;
    if (price.before.planarity_max_percent > 100.0 * kFullPlanarity) {
        Planariser planariser(mesh, surface, context);
        Vertices moved = wanted == Planarity::Full ? planariser.full() : planariser.gentle();
        price.iterations = planariser.iterations();
        move_vertices(mesh, std::move(moved), price);
        QualityReport after = measure_quality(mesh, closest, context);
        price.after = figures_of(after.overall);
        move_regions(mesh, report.cells, after.cells, price);
        report = std::move(after);
    }
    price.reached =
        wanted == Planarity::Gentle || price.after.planarity_max_percent <= 100.0 * kFullPlanarity;
    mesh.planarisation = price;
    warn_unless_reached(mesh, report.cells);
}

}  // namespace leafcutter::geometry
