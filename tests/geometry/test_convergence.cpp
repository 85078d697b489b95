// Second order everywhere: on tori against closed forms, on a subdivided eight against the finest.

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "geometry/foliation.h"
#include "geometry/samples.h"
#include "tests/geometry/chart_checks.h"
#include "tests/geometry/surfaces.h"
#include "tests/support/loop_subdivision.h"

namespace leafcutter::geometry {
namespace {

using testing::at;

// Halving the edges must lower errors by 2 to this power.
constexpr double kLeastOrder = 1.7;

// The order at which the errors of a sequence of halved edges fall, by the first and the last.
double order_of(const std::vector<double>& errors) {
    return std::log2(errors.front() / errors.back()) / static_cast<double>(errors.size() - 1);
}

// For tests/plots/convergence.py.
void record(const std::string& name, const std::vector<double>& errors) {
    ::testing::Test::RecordProperty(name, fmt::format("{}", fmt::join(errors, " ")));
}

// --- tori ---------------------------------------------------------------------------------------

constexpr double kTube = 0.35;
const double kRoot = std::sqrt(1.0 - kTube * kTube);

// Where a point of the tube lies in conformal coordinates, [-pi, pi] over the whole tube, from the
// outermost circle: the integral of r / (1 + r cos t) in closed form, in units of r / kRoot.
double conformal_angle(double tube_angle) {
    return 2.0 * std::atan(std::sqrt((1.0 - kTube) / (1.0 + kTube)) * std::tan(0.5 * tube_angle));
}

Cylinder torus_chart(int across, TorusRings rings) {
    FoliationOptions options;
    options.torus_rings = rings;
    options.refinement = Refinement::Off;
    const TriangleMesh mesh = testing::make_torus(across, 3 * across, kTube);
    return compute_foliation(testing::to_mesh(mesh), options).cylinders[0];
}

TEST(Convergence, OfEnergyAndModulusOnToriIsOfSecondOrder) {
    std::vector<double> modulus;
    std::vector<double> energy;
    for (const int across : {10, 20, 40}) {
        const Cylinder chart = torus_chart(across, TorusRings::Short);
        const double exact = kTube / kRoot;  // Circumference over length.
        modulus.push_back(std::abs(chart.width / chart.height / exact - 1.0));
        // f rises evenly along: E = 1/2 (height / length)^2 x conformal area of the torus.
        energy.push_back(
            std::abs(2.0 * chart.energy / (chart.height * chart.height) / exact - 1.0));
    }
    record("modulus", modulus);
    record("energy", energy);
    EXPECT_GT(order_of(modulus), kLeastOrder);
    EXPECT_GT(order_of(energy), kLeastOrder);
    EXPECT_LT(modulus.back(), 0.01);
    EXPECT_LT(energy.back(), 0.01);
}

// Leaves around the axis: their level is a closed form of the tube's angle.
double worst_leaf_error(int across) {
    const Cylinder chart = torus_chart(across, TorusRings::Long);
    const std::vector<Eigen::Vector2d> gf = testing::vertex_gf(chart);
    double worst = 0.0;
    std::optional<double> outermost;
    double direction = 0.0;
    std::vector<std::pair<double, double>> place_and_level;
    for (std::size_t v = 0; v < gf.size(); ++v) {
        const Eigen::Vector3d& p = chart.mesh.positions[v];
        const double angle = std::atan2(p.z(), std::hypot(p.x(), p.y()) - 1.0);
        const double place = conformal_angle(angle) / (2.0 * std::numbers::pi);
        const double level = gf[v].y() / chart.height;
        place_and_level.emplace_back(place, level);
        if (std::abs(angle) < 1e-9 && !outermost) {
            outermost = level;
        }
    }
    for (const double sign : {1.0, -1.0}) {
        double largest = 0.0;
        for (const auto& [place, level] : place_and_level) {
            const double gap = level - outermost.value_or(0.0) - sign * place;
            largest = std::max(largest, std::abs(gap - std::round(gap)));
        }
        if (direction == 0.0 || largest < worst) {
            direction = sign;
            worst = largest;
        }
    }
    return worst;
}

TEST(Convergence, OfLeavesOnToriIsOfSecondOrder) {
    const std::vector<double> errors{worst_leaf_error(10), worst_leaf_error(20),
                                     worst_leaf_error(40)};
    record("leaves", errors);
    EXPECT_GT(order_of(errors), kLeastOrder);
    EXPECT_LT(errors.back(), 2e-3);
}

// --- an eight, subdivided -----------------------------------------------------------------------

// Where the leaf at `level` of a chart crosses the plane z = 0.
void add_crossings(const Cylinder& chart, double level, std::vector<Eigen::Vector3d>& found) {
    const auto part = [](const Eigen::Vector3d& p, const Eigen::Vector3d& q, double a, double b) {
        return Eigen::Vector3d((p * b - q * a) / (b - a));
    };
    for (std::size_t t = 0; t < chart.mesh.triangles.size(); ++t) {
        std::vector<Eigen::Vector3d> ends;
        for (std::size_t k = 0; k < 3; ++k) {
            const double a = chart.corner_gf[t][k].y() - level;
            const double b = chart.corner_gf[t][(k + 1) % 3].y() - level;
            if ((a < 0.0) != (b < 0.0)) {
                ends.push_back(part(chart.mesh.positions[at(chart.mesh.triangles[t][k])],
                                    chart.mesh.positions[at(chart.mesh.triangles[t][(k + 1) % 3])],
                                    a, b));
            }
        }
        if (ends.size() == 2 && (ends[0].z() < 0.0) != (ends[1].z() < 0.0)) {
            found.push_back(part(ends[0], ends[1], ends[0].z(), ends[1].z()));
        }
    }
}

struct EightFigures {
    double twice_energy = 0.0;
    std::array<double, 3> modulus{};  // Least first.
    // Four leaves of each cylinder, the same ones whichever way it runs.
    std::vector<Eigen::Vector3d> leaves;
};

EightFigures eight_figures(const TriangleMesh& mesh) {
    FoliationOptions options;
    options.mode = FoliationMode::Pants;
    options.function = SweepFunction::X;
    options.weights = std::vector<double>{1.0, 1.0, 1.0};
    options.puncture = PunctureChoice::None;
    const Foliation foliation = compute_foliation(testing::to_mesh(mesh), options);
    EightFigures figures;
    figures.twice_energy = 2.0 * foliation.energy;
    EXPECT_EQ(foliation.cylinders.size(), 3U);
    for (std::size_t k = 0; k < std::min<std::size_t>(3, foliation.cylinders.size()); ++k) {
        const Cylinder& chart = foliation.cylinders[k];
        figures.modulus[k] = chart.width / chart.height;
        for (const double level : {0.2, 0.4, 0.6, 0.8}) {
            add_crossings(chart, level * chart.height, figures.leaves);
        }
    }
    std::sort(figures.modulus.begin(), figures.modulus.end());
    return figures;
}

// Root mean square distance of the leaves of one from those of the other.
double leaves_apart(const EightFigures& a, const EightFigures& b) {
    double sum = 0.0;
    for (const Eigen::Vector3d& p : a.leaves) {
        double nearest = 1e300;
        for (const Eigen::Vector3d& q : b.leaves) {
            nearest = std::min(nearest, (p - q).squaredNorm());
        }
        sum += nearest;
    }
    return std::sqrt(sum / static_cast<double>(a.leaves.size()));
}

TEST(Convergence, OfASubdividedEightIsOfSecondOrder) {
    TriangleMesh mesh = make_sample("eight", 1600);
    std::vector<EightFigures> levels;
    for (int level = 0; level < 4; ++level) {
        levels.push_back(eight_figures(mesh));
        ASSERT_EQ(levels.back().leaves.size(), 24U);  // Each leaf crosses twice.
        mesh = testing::subdivide_loop(mesh);
    }
    // Differences of neighbours fall as errors do.
    const auto order = [&](const std::string& name, const auto& difference) {
        std::vector<double> steps;
        for (std::size_t k = 0; k + 1 < levels.size(); ++k) {
            steps.push_back(difference(levels[k + 1], levels[k]));
        }
        record(name, steps);
        return order_of(steps);
    };
    using Figures = EightFigures;
    EXPECT_GT(
        order("energy", [](const Figures& a,
                           const Figures& b) { return std::abs(a.twice_energy - b.twice_energy); }),
        kLeastOrder);
    for (const std::size_t k : {0U, 1U, 2U}) {
        EXPECT_GT(order("modulus_" + std::to_string(k),
                        [k](const Figures& a, const Figures& b) {
                            return std::abs(a.modulus[k] - b.modulus[k]);
                        }),
                  kLeastOrder)
            << k;
    }
    EXPECT_GT(order("leaves", leaves_apart), kLeastOrder);
}

}  // namespace
}  // namespace leafcutter::geometry
