#include <gtest/gtest.h>

#include "fab/strips/strips.h"
#include "fab/strips/unfold.h"
#include "tests/support/quad_grids.h"

namespace leafcutter::fab {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

double area(const Ring& ring) {
    double sum = 0.0;
    for (std::size_t i = 0; i < ring.size(); ++i) {
        const Vector2d& p = ring[i];
        const Vector2d& q = ring[(i + 1) % ring.size()];
        sum += p.x() * q.y() - p.y() * q.x();
    }
    return sum / 2.0;
}

// Largest relative difference between lengths in space and in the plane: edges and hinge.
double worst_length_error(const geometry::QuadMesh& mesh, const Strip& strip) {
    const auto cells = walk_cells(mesh, strip);
    const int count = static_cast<int>(cells.size());
    const Unfolded flat = unfold(mesh, cells, {0, count});
    const auto at = [&](int vertex) { return mesh.vertices[static_cast<std::size_t>(vertex)]; };
    double worst = 0.0;
    for (std::size_t i = 0; i < cells.size(); ++i) {
        const WalkedCell& cell = cells[i];
        const double size = std::max((at(cell.l0) - at(cell.r1)).norm(), 1e-9);
        const auto compare = [&](const Vector2d& p, const Vector2d& q, int u, int v) {
            worst = std::max(worst, std::abs((p - q).norm() - (at(u) - at(v)).norm()) / size);
        };
        compare(flat.left[i], flat.right[i], cell.l0, cell.r0);
        compare(flat.left[i + 1], flat.right[i + 1], cell.l1, cell.r1);
        compare(flat.left[i], flat.left[i + 1], cell.l0, cell.l1);
        compare(flat.right[i], flat.right[i + 1], cell.r0, cell.r1);
        const bool rising = flat.bend[i] == cell.rising;
        if (rising || flat.bend[i] == Bend::None) {
            compare(flat.right[i], flat.left[i + 1], cell.r0, cell.l1);
        }
        if (!rising || flat.bend[i] == Bend::None) {
            compare(flat.left[i], flat.right[i + 1], cell.l0, cell.r1);
        }
    }
    return worst;
}

TEST(Unfold, KeepsEveryEdgeAndHingeOfBumpyStrips) {
    for (unsigned seed = 1; seed <= 5; ++seed) {
        const auto mesh = test::bumpy_grid({12, 30}, 10.0, seed);
        for (const Strip& strip : make_strips(mesh, ColumnRuns::PerCylinder)) {
            EXPECT_LT(worst_length_error(mesh, strip), 1e-9) << strip.id << " seed " << seed;
        }
    }
}

TEST(Unfold, KeepsEveryEdgeAndHingeOfATorus) {
    const auto mesh = test::torus_grid({24, 10}, 60.0, 20.0);
    for (const Strip& strip : make_strips(mesh, ColumnRuns::PerCylinder)) {
        EXPECT_TRUE(strip.closed);
        EXPECT_LT(worst_length_error(mesh, strip), 1e-9) << strip.id;
    }
}

TEST(Unfold, LaysPlanarCellsWithoutAFold) {
    const auto mesh = test::flat_grid({3, 5}, 10.0);
    for (const Strip& strip : make_strips(mesh, ColumnRuns::PerCylinder)) {
        const auto cells = walk_cells(mesh, strip);
        const Unfolded flat = unfold(mesh, cells, {0, static_cast<int>(cells.size())});
        for (const Bend bend : flat.bend) {
            EXPECT_EQ(bend, Bend::None);
        }
        EXPECT_NEAR(flat.left.back().x(), 10.0 * static_cast<double>(cells.size()), 1e-9);
        EXPECT_NEAR(flat.left.back().y(), 5.0, 1e-9);
    }
}

TEST(Unfold, FoldsAConcaveCellOnTheDiagonalInside) {
    geometry::QuadMesh mesh = test::flat_grid({1, 1}, 10.0);
    mesh.vertices[0] = Vector3d(8.0, 8.0, 0.0);  // Corner a, pushed beyond the diagonal b–d.
    Strip strip;
    strip.quads = {0};
    const auto cells = walk_cells(mesh, strip);
    const Unfolded flat = unfold(mesh, cells, {0, 1});
    const Ring ring{flat.right[0], flat.right[1], flat.left[1], flat.left[0]};
    EXPECT_NEAR(area(ring), 20.0, 1e-9);
    EXPECT_EQ(flat.bend[0], Bend::None);
}

TEST(Unfold, KeepsTheAreaOfTheFoldedCells) {
    const auto mesh = test::bumpy_grid({6, 20}, 10.0, 7);
    for (const Strip& strip : make_strips(mesh, ColumnRuns::PerCylinder)) {
        const auto cells = walk_cells(mesh, strip);
        const Unfolded flat = unfold(mesh, cells, {0, static_cast<int>(cells.size())});
        for (std::size_t i = 0; i < cells.size(); ++i) {
            const Ring ring{flat.right[i], flat.right[i + 1], flat.left[i + 1], flat.left[i]};
            EXPECT_GT(area(ring), 0.0) << strip.id << " cell " << i;
        }
    }
}

TEST(WalkCells, TurnsACellThatIsMetBackwards) {
    geometry::QuadMesh mesh = test::flat_grid({1, 3}, 10.0);
    auto& middle = mesh.quads[1];
    middle = {middle[2], middle[3], middle[0], middle[1]};
    Strip strip;
    strip.quads = {0, 1, 2};
    const auto cells = walk_cells(mesh, strip);
    EXPECT_EQ(cells[0].l1, cells[1].l0);
    EXPECT_EQ(cells[1].r1, cells[2].r0);
    EXPECT_LT(worst_length_error(mesh, strip), 1e-9);
}

}  // namespace
}  // namespace leafcutter::fab
