// The leaves of whole foliations, as they are drawn: closed, at their level, one for each level,
// and none crosses another of its family.

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "geometry/closest_point.h"
#include "geometry/leaves.h"
#include "geometry/samples.h"
#include "tests/geometry/map_start.h"

namespace leafcutter::geometry {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using testing::at;

// Looks points of a cylinder up in its chart.
class ChartLookup {
public:
    explicit ChartLookup(const Cylinder& chart) : chart_(chart), closest_(chart.mesh) {}

    ClosestPoint::Hit find(const Vector3d& point) const { return closest_.query(point); }

    // The chart of one triangle, at a point of it. (Both sides of a critical leaf may belong to one
    // cylinder: its points have two places in the chart.)
    Vector2d gf_in(int triangle, const Vector3d& point) const {
        const auto [a, b, c] = corners(triangle);
        Eigen::Matrix<double, 3, 2> sides;
        sides << b - a, c - a;
        const Vector2d share = sides.colPivHouseholderQr().solve(point - a);
        const auto& gf = chart_.corner_gf[at(triangle)];
        return gf[0] + share[0] * (gf[1] - gf[0]) + share[1] * (gf[2] - gf[0]);
    }
    std::array<Vector3d, 3> corners(int triangle) const {
        const auto& t = chart_.mesh.triangles[at(triangle)];
        return {chart_.mesh.positions[at(t[0])], chart_.mesh.positions[at(t[1])],
                chart_.mesh.positions[at(t[2])]};
    }

private:
    const Cylinder& chart_;
    ClosestPoint closest_;
};

// By how much a point misses the level of its leaf, in units of the chart's height or width. Both
// ends of a cylinder may lie on one critical leaf: where that is found, either will do.
double miss(const Cylinder& chart, const Leaf& leaf, const Vector2d& gf) {
    if (leaf.of_conjugate) {
        const double columns = (gf.x() - leaf.level) / chart.width;
        return std::abs(columns - std::round(columns));
    }
    const double rows = (gf.y() - leaf.level) / chart.height;
    const bool at_end = leaf.level == 0.0 || leaf.level == chart.height;
    return std::abs(at_end ? rows - std::round(rows) : rows);
}

using Segment = std::pair<Vector3d, Vector3d>;

// True if the insides of two segments of one plane cross.
bool cross(const Segment& a, const Segment& b, const Vector3d& normal) {
    const auto side = [&](const Segment& line, const Vector3d& point) {
        return normal.dot((line.second - line.first).cross(point - line.first));
    };
    const double size = (a.second - a.first).norm() * (b.second - b.first).norm();
    const double none = 1e-9 * size;
    const auto parted = [&](double x, double y) {
        return (x > none && y < -none) || (x < -none && y > none);
    };
    return parted(side(a, b.first), side(a, b.second)) &&
           parted(side(b, a.first), side(b, a.second));
}

double length_of(const Leaf& leaf) {
    double sum = leaf.closed ? (leaf.points.front() - leaf.points.back()).norm() : 0.0;
    for (std::size_t i = 1; i < leaf.points.size(); ++i) {
        sum += (leaf.points[i] - leaf.points[i - 1]).norm();
    }
    return sum;
}

struct Family {
    // Segments by the triangle of the chart that they lie in.
    std::map<int, std::vector<Segment>> segments;
    std::map<double, int> leaves_at_level;
};

// Every point and every middle of two points lies on the surface at the leaf's level.
void expect_at_level(const Cylinder& chart,
                     const ChartLookup& lookup,
                     const Leaf& leaf,
                     Family& family) {
    ASSERT_GE(leaf.points.size(), leaf.closed ? 3U : 2U);
    const std::size_t count = leaf.points.size();
    for (std::size_t i = 0; i < count - (leaf.closed ? 0 : 1); ++i) {
        const Segment segment{leaf.points[i], leaf.points[(i + 1) % count]};
        const Vector3d middle = 0.5 * (segment.first + segment.second);
        const ClosestPoint::Hit hit = lookup.find(middle);
        ASSERT_LT(hit.distance, 1e-9);
        for (const Vector3d& point : {segment.first, middle, segment.second}) {
            ASSERT_LT(miss(chart, leaf, lookup.gf_in(hit.triangle, point)), 1e-9);
        }
        family.segments[hit.triangle].push_back(segment);
    }
}

void expect_uncrossed(const ChartLookup& lookup, const Family& family) {
    for (const auto& [triangle, segments] : family.segments) {
        const auto [a, b, c] = lookup.corners(triangle);
        const Vector3d normal = (b - a).cross(c - a).normalized();
        for (std::size_t i = 0; i < segments.size(); ++i) {
            for (std::size_t k = 0; k < i; ++k) {
                ASSERT_FALSE(cross(segments[i], segments[k], normal)) << "in triangle " << triangle;
            }
        }
    }
}

void expect_good_leaves(const TriangleMesh& surface) {
    const Foliation foliation = compute_foliation(testing::to_mesh(surface));
    GridOptions options;
    options.all = {.rows = 14, .cols = 16};
    options.junctions = Junctions::Independent;
    const std::vector<Leaf> leaves = sample_leaves(foliation, build_quad_mesh(foliation, options));
    for (std::size_t k = 0; k < foliation.cylinders.size(); ++k) {
        SCOPED_TRACE(k);
        const Cylinder& chart = foliation.cylinders[k];
        const ChartLookup lookup(chart);
        std::array<Family, 2> families;
        for (const Leaf& leaf : leaves) {
            if (leaf.cylinder != static_cast<int>(k)) {
                continue;
            }
            Family& family = families[leaf.of_conjugate ? 1 : 0];
            ++family.leaves_at_level[leaf.level];
            EXPECT_EQ(leaf.closed, !leaf.of_conjugate);
            EXPECT_GT(length_of(leaf), 0.0);
            expect_at_level(chart, lookup, leaf, family);
            if (leaf.of_conjugate) {  // From end to end.
                // By the triangle inside: both ends of a chart may lie on one curve in space.
                const auto f_at = [&](const Vector3d& end, const Vector3d& next) {
                    return lookup.gf_in(lookup.find(0.5 * (end + next)).triangle, end).y();
                };
                const std::vector<Vector3d>& points = leaf.points;
                const double first = f_at(points.front(), points[1]);
                const double last = f_at(points.back(), points[points.size() - 2]);
                EXPECT_NEAR(std::abs(last - first) / chart.height, 1.0, 1e-9);
            }
        }
        EXPECT_EQ(families[0].leaves_at_level.size(), 15U);
        EXPECT_EQ(families[1].leaves_at_level.size(), 16U);
        for (const Family& family : families) {
            for (const auto& [level, count] : family.leaves_at_level) {
                EXPECT_EQ(count, 1) << "level " << level;
            }
            expect_uncrossed(lookup, family);
        }
    }
}

TEST(LeafFamilies, OfAnEightAreLoopsThatNeverCross) {
    expect_good_leaves(make_sample("eight", 6000));
}

TEST(LeafFamilies, OfADoubleTorusAreLoopsThatNeverCross) {
    expect_good_leaves(make_sample("double-torus", 6000));
}

TEST(LeafFamilies, OfAHoledSphereAreLoopsThatNeverCross) {
    expect_good_leaves(testing::make_holed_sphere(5, 6000));
}

TEST(LeafFamilies, CrossingsWouldBeSeen) {
    const Vector3d up = Vector3d::UnitZ();
    const Segment along{{0, 0, 0}, {1, 0, 0}};
    EXPECT_TRUE(cross(along, {{0.5, -1, 0}, {0.5, 1, 0}}, up));
    EXPECT_FALSE(cross(along, {{0, 0.1, 0}, {1, 0.1, 0}}, up));
    EXPECT_FALSE(cross(along, {{0.5, 0, 0}, {0.5, 1, 0}}, up));  // Touches only.
}

}  // namespace
}  // namespace leafcutter::geometry
