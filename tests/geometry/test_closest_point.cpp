#include <algorithm>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "geometry/closest_point.h"
#include "tests/geometry/charts.h"

namespace leafcutter::geometry {
namespace {

using Eigen::Vector3d;

TriangleMesh random_triangles(int count, unsigned seed) {
    std::mt19937 engine(seed);
    std::uniform_real_distribution<double> place(-1.0, 1.0);
    std::uniform_real_distribution<double> size(-0.1, 0.1);
    TriangleMesh mesh;
    for (int i = 0; i < count; ++i) {
        const Vector3d centre(place(engine), place(engine), place(engine));
        for (int k = 0; k < 3; ++k) {
            mesh.positions.push_back(centre + Vector3d(size(engine), size(engine), size(engine)));
        }
        mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    return mesh;
}

// Golden-section-free reference: the minimum over a triangle by descending into ever smaller parts.
double distance_by_subdivision(const Vector3d& p, Vector3d a, Vector3d b, Vector3d c) {
    for (int step = 0; step < 60; ++step) {
        const Vector3d ab = 0.5 * (a + b);
        const Vector3d bc = 0.5 * (b + c);
        const Vector3d ca = 0.5 * (c + a);
        const std::array<std::array<Vector3d, 3>, 4> parts{
            {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {bc, ca, ab}}};
        double best = std::numeric_limits<double>::infinity();
        std::array<Vector3d, 3> next{a, b, c};
        for (const auto& part : parts) {
            const double distance = ((part[0] + part[1] + part[2]) / 3.0 - p).norm();
            if (distance < best) {
                best = distance;
                next = part;
            }
        }
        a = next[0];
        b = next[1];
        c = next[2];
    }
    return (a - p).norm();
}

TEST(ClosestPoint, AgreesWithASearchOfEveryTriangle) {
    const TriangleMesh mesh = random_triangles(500, 7);
    const ClosestPoint surface(mesh);
    std::vector<ClosestPoint> single;
    for (const auto& triangle : mesh.triangles) {
        TriangleMesh one{.positions = mesh.positions, .triangles = {triangle}};
        single.emplace_back(one);
    }
    std::mt19937 engine(8);
    std::uniform_real_distribution<double> place(-1.5, 1.5);
    for (int i = 0; i < 200; ++i) {
        const Vector3d point(place(engine), place(engine), place(engine));
        double best = std::numeric_limits<double>::infinity();
        for (const ClosestPoint& one : single) {
            best = std::min(best, one.query(point).distance);
        }
        const auto hit = surface.query(point);
        EXPECT_DOUBLE_EQ(hit.distance, best);
        EXPECT_NEAR((hit.point - point).norm(), hit.distance, 1e-15);
        EXPECT_NEAR(single[static_cast<std::size_t>(hit.triangle)].query(hit.point).distance, 0.0,
                    1e-15);
    }
}

TEST(ClosestPoint, FindsTheNearestPointOfOneTriangleInEveryRegion) {
    TriangleMesh mesh{.positions = {{0, 0, 0}, {4, 0, 0}, {1, 3, 0}}, .triangles = {{0, 1, 2}}};
    const ClosestPoint surface(mesh);
    std::mt19937 engine(9);
    std::uniform_real_distribution<double> place(-6.0, 8.0);
    for (int i = 0; i < 300; ++i) {
        const Vector3d point(place(engine), place(engine), place(engine));
        const double found = surface.query(point).distance;
        const double other =
            distance_by_subdivision(point, mesh.positions[0], mesh.positions[1], mesh.positions[2]);
        EXPECT_LE(found, other + 1e-12);
    }
    EXPECT_NEAR(surface.query({1.5, 1.0, 2.0}).distance, 2.0, 1e-15);
    EXPECT_NEAR(surface.query({-3.0, -4.0, 0.0}).distance, 5.0, 1e-15);
    EXPECT_NEAR(surface.query({2.0, -1.0, 0.0}).distance, 1.0, 1e-15);
}

TEST(ClosestPoint, TreatsDegenerateTrianglesAsSegmentsAndPoints) {
    TriangleMesh mesh{.positions = {{0, 0, 0}, {2, 0, 0}, {1, 0, 0}, {0, 5, 0}},
                      .triangles = {{0, 1, 2}, {3, 3, 3}}};
    const ClosestPoint surface(mesh);
    EXPECT_NEAR(surface.query({1.5, 1.0, 0.0}).distance, 1.0, 1e-15);
    EXPECT_NEAR(surface.query({0.0, 6.0, 0.0}).distance, 1.0, 1e-15);
    EXPECT_EQ(surface.query({0.0, 6.0, 0.0}).triangle, 1);
}

TEST(ClosestPoint, GivesTheSamePointWhereverTheSearchStarts) {
    const TriangleMesh mesh = testing::round_torus(100.0, 25.0).cylinders[0].mesh;
    const ClosestPoint surface(mesh);
    std::mt19937 engine(10);
    std::uniform_real_distribution<double> place(-130.0, 130.0);
    for (int i = 0; i < 300; ++i) {
        const Vector3d point(place(engine), place(engine), 0.2 * place(engine));
        const int start = i * 37 % static_cast<int>(mesh.triangles.size());
        EXPECT_DOUBLE_EQ(surface.query(point, start).distance, surface.query(point).distance);
    }
}

TEST(ClosestPoint, KnowsTheAreaOfTheSurface) {
    const TriangleMesh mesh = testing::flat_rectangle(3.0, 2.0).cylinders[0].mesh;
    EXPECT_NEAR(ClosestPoint(mesh).total_area(), 6.0, 1e-12);
}

}  // namespace
}  // namespace leafcutter::geometry
