// Joints, tabs and widths of pieces.

#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fab/strips/junctions.h"
#include "fab/strips/link.h"
#include "fab/strips/overlap.h"
#include "fab/strips/strips.h"
#include "fab/strips/unfold.h"
#include "fab/weave/weave.h"
#include "geometry/error.h"
#include "geometry/foliation.h"
#include "geometry/samples.h"
#include "geometry/surface_measures.h"
#include "tests/geometry/surfaces.h"
#include "tests/support/quad_grids.h"

namespace leafcutter::fab {
namespace {

using Eigen::Vector2d;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr double kPi = std::numbers::pi;

struct Made {
    std::vector<Strip> strips;
    std::vector<Piece> pieces;
    std::vector<std::string> warnings;
    Crossings crossings;

    const Piece& piece(const std::string& id) const {
        return *std::find_if(pieces.begin(), pieces.end(),
                             [&](const Piece& piece) { return piece.id == id; });
    }
};

struct Wishes {
    FitParams fit;
    PieceLimits limits{.usable_sheet = {590.0, 390.0}};
    const geometry::Foliation* glued = nullptr;
};

Made make(const geometry::QuadMesh& mesh, const Wishes& wishes) {
    Made made;
    const auto& [fit, limits, glued] = wishes;
    made.strips = make_strips(mesh, fit.columns, through_limits(fit, limits));
    refuse_hopeless_strips(made.strips, mesh, {limits, limits});
    if (glued != nullptr) {
        glue_ends(mesh, *glued, made.strips);
    }
    made.crossings = crossings_of(made.strips, weave_cells(mesh, {}));
    JointMap joints(mesh);
    for (std::size_t i = 0; i < made.strips.size(); ++i) {
        const PieceRules rules{fit, limits, made.crossings[i], &joints};
        for (Piece& piece : make_pieces(made.strips[i], mesh, rules, made.warnings)) {
            made.pieces.push_back(std::move(piece));
        }
    }
    link_pieces(made.strips, {limits, limits}, made.pieces, made.warnings);
    return made;
}

// Edges of a ring that cross, by trying all pairs.
bool crosses_itself(const Ring& ring) {
    const auto turn = [](const Vector2d& a, const Vector2d& b, const Vector2d& c) {
        return (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x();
    };
    const std::size_t n = ring.size();
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = i + 2; j < n; ++j) {
            const Vector2d &p = ring[i], &q = ring[(i + 1) % n];
            const Vector2d &r = ring[j], &s = ring[(j + 1) % n];
            if ((j + 1) % n != i && turn(p, q, r) * turn(p, q, s) < 0.0 &&
                turn(r, s, p) * turn(r, s, q) < 0.0) {
                return true;
            }
        }
    }
    return false;
}

// Every cell in one piece, no outline over itself, every edge as long as in space.
void expect_true_to_the_mesh(const geometry::QuadMesh& mesh, const Made& made) {
    std::map<std::string, const Strip*> strips;
    for (const Strip& strip : made.strips) {
        strips[strip.id] = &strip;
    }
    std::set<std::pair<std::string, int>> cells;
    for (const Piece& piece : made.pieces) {
        EXPECT_FALSE(crosses_itself(piece.outline)) << piece.id;
        EXPECT_TRUE(is_simple(piece.outline)) << piece.id;
        const Strip& strip = *strips.at(piece.strip);
        const std::vector<WalkedCell> walked = walk_cells(mesh, strip);
        const auto at = [&](int v) { return mesh.vertices[static_cast<std::size_t>(v)]; };
        for (std::size_t i = 0; i < static_cast<std::size_t>(piece.cell_count); ++i) {
            const std::size_t place =
                (static_cast<std::size_t>(piece.first_cell) + i) % strip.quads.size();
            EXPECT_TRUE(cells.emplace(strip.id, static_cast<int>(place)).second) << piece.id;
            const WalkedCell& cell = walked[place];
            const auto same = [&](const Vector2d& p, const Vector2d& q, int u, int v) {
                EXPECT_NEAR((p - q).norm(), (at(u) - at(v)).norm(), 1e-7) << piece.id;
            };
            same(piece.left[i], piece.right[i], cell.l0, cell.r0);
            same(piece.left[i + 1], piece.right[i + 1], cell.l1, cell.r1);
            same(piece.left[i], piece.left[i + 1], cell.l0, cell.l1);
            same(piece.right[i], piece.right[i + 1], cell.r0, cell.r1);
        }
    }
    EXPECT_EQ(cells.size(), 2 * mesh.quads.size());
}

// A strip of two cylinders, one on top of the other, bent by `bend` degrees at the leaf between.
geometry::QuadMesh two_storeys(const test::GridSize& size, double cell_mm, double bend_deg = 0.0) {
    const double bend = bend_deg * kPi / 180.0;
    geometry::QuadMesh mesh =
        test::quad_grid(size, geometry::ChartShape::Rectangle, [&](double g, double f) {
            const double along = (f - 0.5) * size.rows * cell_mm;
            const double across = g * size.cols * cell_mm;
            return along < 0.0 ? Eigen::Vector3d(across, along, 0.0)
                               : Eigen::Vector3d(across - along * std::sin(bend),
                                                 along * std::cos(bend), 0.0);
        });
    for (geometry::QuadAddress& address : mesh.addresses) {
        if (address.row >= size.rows / 2) {
            address.cylinder = 1;
            address.row -= size.rows / 2;
        }
    }
    mesh.grids.push_back(mesh.grids.front());
    return mesh;
}

std::vector<const Strip*> of_family(const Made& made, Family family) {
    std::vector<const Strip*> strips;
    for (const Strip& strip : made.strips) {
        if (strip.family == family) {
            strips.push_back(&strip);
        }
    }
    return strips;
}

TEST(Joints, LieUnderTheCrossingStrips) {
    Wishes wishes;
    wishes.fit.max_piece_mm = 110.0;
    for (const auto& mesh :
         {test::torus_grid({48, 16}, 80.0, 25.0), test::cylinder_grid({12, 36}, 50.0, 100.0)}) {
        const Made made = make(mesh, wishes);
        int joints = 0;
        int seen = 0;
        for (std::size_t i = 0; i < made.strips.size(); ++i) {
            for (const std::string& id : made.strips[i].pieces) {
                const int cell = made.piece(id).first_cell;
                if (made.strips[i].closed || cell > 0) {
                    ++joints;
                    seen += made.crossings[i][static_cast<std::size_t>(cell)].on_top ? 1 : 0;
                }
            }
        }
        EXPECT_GT(joints, 40);
        EXPECT_LT(seen, 0.1 * joints) << "of " << joints;
        expect_true_to_the_mesh(mesh, made);
    }
}

TEST(Joints, OfNeighboursDontLineUp) {
    const int cols = 36;
    const Made made = make(test::cylinder_grid({12, cols}, 50.0, 100.0), {});
    const std::vector<const Strip*> rings = of_family(made, Family::Weft);
    for (std::size_t i = 1; i < rings.size(); ++i) {
        const int one = made.piece(rings[i - 1]->pieces.front()).first_cell;
        const int other = made.piece(rings[i]->pieces.front()).first_cell;
        const int apart = std::abs(one - other);
        EXPECT_GE(std::min(apart, cols - apart), 4) << rings[i]->id;
    }
}

// A cone whose rings turn evenly but for one sharp corner.
TEST(Joints, KeepAwayFromKinks) {
    const auto mesh =
        test::quad_grid({2, 40}, geometry::ChartShape::Annulus, [](double g, double f) {
            const double angle = 2.0 * kPi * g;
            const double r = 60.0 * (g < 0.02 ? 1.25 : 1.0) * (1.0 - 0.3 * f);
            return Eigen::Vector3d(r * std::cos(angle), r * std::sin(angle), 20.0 * f);
        });
    const Made made = make(mesh, {});
    for (const Strip* ring : of_family(made, Family::Weft)) {
        const int cell = made.piece(ring->pieces.front()).first_cell;
        EXPECT_GT(std::min(cell, 40 - cell), 1) << ring->id;
    }
}

TEST(LinkPieces, NamesWhatEveryTabIsJoinedTo) {
    Wishes wishes;
    wishes.fit.max_piece_mm = 120.0;
    const Made rings = make(test::cylinder_grid({4, 36}, 60.0, 60.0), wishes);
    for (const Strip* ring : of_family(rings, Family::Weft)) {
        ASSERT_GE(ring->pieces.size(), 4U);
        for (std::size_t i = 0; i < ring->pieces.size(); ++i) {
            EXPECT_EQ(rings.piece(ring->pieces[i]).end_tab.onto,
                      ring->pieces[(i + 1) % ring->pieces.size()]);
        }
    }
    const Made storeys = make(two_storeys({20, 4}, 10.0), {});
    const std::vector<const Strip*> columns = of_family(storeys, Family::Warp);
    ASSERT_EQ(columns.size(), 8U);
    for (std::size_t i = 0; i < 4; ++i) {
        const Tab& tab = storeys.piece(columns[i]->pieces.front()).end_tab;
        EXPECT_NEAR(tab.length_mm, 8.0, 1e-9);
        EXPECT_EQ(tab.onto, columns[i]->next + ".1");
        EXPECT_EQ(storeys.piece(tab.onto).end_tab.length_mm, 0.0) << "a tab over the rim";
    }
}

TEST(ThroughColumns, GoOnWhileTheyStayShort) {
    Wishes wishes;
    wishes.fit.columns = ColumnRuns::Through;
    const auto mesh = two_storeys({20, 4}, 10.0);
    const Made longer = make(mesh, wishes);
    ASSERT_EQ(of_family(longer, Family::Warp).size(), 4U);
    for (const Strip* column : of_family(longer, Family::Warp)) {
        EXPECT_EQ(column->quads.size(), 20U);
        EXPECT_EQ(column->cylinders, (std::vector<int>{0, 1}));
        EXPECT_EQ(column->pieces.size(), 1U);
    }
    expect_true_to_the_mesh(mesh, longer);
    wishes.fit.max_piece_mm = 150.0;
    const Made shorter = make(mesh, wishes);
    ASSERT_EQ(of_family(shorter, Family::Warp).size(), 8U);
    EXPECT_FALSE(of_family(shorter, Family::Warp).front()->next.empty());
    expect_true_to_the_mesh(mesh, shorter);
}

TEST(ThroughColumns, EndAtALeafWhereTheyTurnTooFar) {
    // Columns that wind round a hole, one cylinder for each eighth of the way.
    geometry::QuadMesh mesh =
        test::quad_grid({64, 2}, geometry::ChartShape::Rectangle, [](double g, double f) {
            const double angle = 1.9 * kPi * f;
            return Eigen::Vector3d((60.0 + 20.0 * g) * std::cos(angle),
                                   -(60.0 + 20.0 * g) * std::sin(angle), 0.0);
        });
    for (geometry::QuadAddress& address : mesh.addresses) {
        address.cylinder = address.row / 8;
        address.row %= 8;
    }
    mesh.grids.assign(8, mesh.grids.front());
    Wishes wishes;
    wishes.fit.columns = ColumnRuns::Through;
    const Made made = make(mesh, wishes);
    // 342 degrees in all, 270 at most: two strips each, evenly long.
    ASSERT_EQ(of_family(made, Family::Warp).size(), 4U);
    for (const Strip* column : of_family(made, Family::Warp)) {
        EXPECT_EQ(column->quads.size(), 32U);
    }
    expect_true_to_the_mesh(mesh, made);
}

TEST(ThroughColumns, EndWhereTheyTurnMost) {
    geometry::QuadMesh mesh = two_storeys({40, 3}, 10.0, 40.0);
    // A second leaf where nothing turns.
    for (geometry::QuadAddress& address : mesh.addresses) {
        if (address.cylinder == 1 && address.row >= 6) {
            address.cylinder = 2;
            address.row -= 6;
        }
    }
    mesh.grids.push_back(mesh.grids.front());
    Wishes wishes;
    wishes.fit.columns = ColumnRuns::Through;
    wishes.fit.max_piece_mm = 340.0;
    const Made made = make(mesh, wishes);
    for (const Strip* column : of_family(made, Family::Warp)) {
        EXPECT_EQ(column->quads.size(), 20U) << "not parted at the kink";
    }
}

// Width of a ring's arrow at its head, and of the slit that it goes through.
TEST(Arrows, HoldInTheirSlits) {
    Wishes wishes;
    wishes.fit.joint = Joint::Slot;
    const auto mesh = test::cylinder_grid({5, 36}, 60.0, 50.0);
    const Made made = make(mesh, wishes);
    expect_true_to_the_mesh(mesh, made);
    for (const Strip* ring : of_family(made, Family::Weft)) {
        const Piece& piece = made.piece(ring->pieces.front());
        ASSERT_EQ(piece.cuts.size(), 1U);
        const Polyline& slit = piece.cuts.front();
        EXPECT_TRUE(RingInterior(piece.outline).contains(slit));
        const double open = (slit.front() - slit.back()).norm() + wishes.limits.kerf_mm;
        EXPECT_NEAR(open, piece.end_tab.slit_width_mm, 1e-9);
        // Across the tab: the neck where the slit lies, the head behind it.
        const Vector2d end = (piece.cut_left.back() + piece.cut_right.back()) / 2.0;
        const Vector2d side = (piece.cut_left.back() - piece.cut_right.back()).normalized();
        const Vector2d on(side.y(), -side.x());
        double neck = 1e9;
        double head = 0.0;
        for (const Vector2d& p : piece.outline) {
            const double s = (p - end).dot(on);
            if (s > 0.1) {
                const double half = std::abs((p - end).dot(side));
                neck = std::min(neck, s < piece.end_tab.slit_at_mm + 0.5 ? 2.0 * half : neck);
                head = std::max(head, s > piece.end_tab.slit_at_mm + 0.5 ? 2.0 * half : 0.0);
            }
        }
        EXPECT_LT(neck, open - 0.3) << "the neck sticks";
        EXPECT_GT(head, open + 0.7) << "the head slips out";
        EXPECT_LT(head, (piece.cut_left.back() - piece.cut_right.back()).norm()) << "it shows";
    }
}

TEST(Arrows, GiveWayToGlueOnNarrowStrips) {
    Wishes wishes;
    wishes.fit.joint = Joint::Slot;
    const Made made = make(test::cylinder_grid({5, 120}, 60.0, 15.0), wishes);
    EXPECT_THAT(made.warnings, Contains(HasSubstr("glue its tabs")));
    for (const Piece& piece : made.pieces) {
        EXPECT_TRUE(piece.cuts.empty());
        EXPECT_EQ(piece.end_tab.slit_width_mm, 0.0);
    }
}

TEST(Tabs, OfAWholeCellAreAsLongAsTheCellBehind) {
    Wishes wishes;
    wishes.fit.joint = Joint::Cell;
    wishes.fit.crimp = false;
    const Made made = make(two_storeys({20, 4}, 13.0), wishes);
    for (const Strip* column : of_family(made, Family::Warp)) {
        if (!column->next.empty()) {
            EXPECT_NEAR(made.piece(column->pieces.back()).end_tab.length_mm, 13.0, 1e-9);
        }
    }
}

TEST(Tabs, AreLongerOnPiecesThatAreTooShort) {
    Wishes wishes;
    wishes.limits.min_length_mm = 50.0;
    const auto mesh = test::torus_grid({30, 8}, 50.0, 3.5);
    const Made made = make(mesh, wishes);
    for (const Piece& piece : made.pieces) {
        double length = piece.start_tab.length_mm + piece.end_tab.length_mm;
        for (std::size_t i = 1; i < piece.cut_left.size(); ++i) {
            length += (piece.cut_left[i] + piece.cut_right[i] - piece.cut_left[i - 1] -
                       piece.cut_right[i - 1])
                          .norm() /
                      2.0;
        }
        EXPECT_GE(length, 35.0) << piece.id;
        EXPECT_FALSE(piece.end_tab.onto.empty()) << piece.id;
    }
    expect_true_to_the_mesh(mesh, made);
}

// Columns from 12 mm to a hair: the outline keeps its least width, the unfolding its truth.
TEST(Widths, AreNeverLessThanTheMaterialTakes) {
    const auto mesh =
        test::quad_grid({12, 6}, geometry::ChartShape::Rectangle, [](double g, double f) {
            const double narrow = 1.0 - 0.97 * std::exp(-40.0 * (f - 0.5) * (f - 0.5));
            return Eigen::Vector3d(60.0 * (g - 0.5) * narrow, 120.0 * f, 0.0);
        });
    Wishes wishes;
    wishes.limits.min_width_mm = 2.0;
    wishes.fit.clearance_mm = 0.3;
    const Made made = make(mesh, wishes);
    EXPECT_THAT(made.warnings, Contains(HasSubstr("widened to 2 mm")));
    expect_true_to_the_mesh(mesh, made);
    for (const Piece& piece : made.pieces) {
        for (std::size_t i = 0; i < piece.cut_left.size(); ++i) {
            EXPECT_GE((piece.cut_left[i] - piece.cut_right[i]).norm(), 2.0 - 1e-9) << piece.id;
        }
    }
}

TEST(Widths, ThatNoMaterialTakesAreRefusedByName) {
    Wishes wishes;
    wishes.limits.min_width_mm = 3.0;
    auto mesh = test::flat_grid({4, 6}, 10.0);
    // The first row is half a millimetre high.
    for (Eigen::Vector3d& p : mesh.vertices) {
        p.y() = p.y() > 5.0 ? p.y() - 9.5 : p.y();
    }
    try {
        make(mesh, wishes);
        FAIL() << "half a millimetre of felt";
    } catch (const geometry::Error& error) {
        EXPECT_EQ(error.code(), "strip-too-narrow");
        EXPECT_THAT(error.what(), HasSubstr("W1 (0.50 mm"));
        EXPECT_THAT(error.what(), HasSubstr("grid.strip_width_mm"));
    }
}

// Every arc of the critical graph has tabs on one of its two sides; the rims of the surface none.
TEST(Junctions, AreGluedFromOneSideOnly) {
    const geometry::Foliation foliation = geometry::compute_foliation(
        leafcutter::testing::to_mesh(geometry::make_sample("eight", 3000)));
    double area = 0.0;
    for (const geometry::Cylinder& cylinder : foliation.cylinders) {
        area += geometry::surface_area(cylinder.mesh);
    }
    geometry::GridOptions grid;
    grid.junctions = geometry::Junctions::Independent;
    grid.strip_width_mm = std::sqrt(area / 900.0);
    const geometry::QuadMesh mesh = geometry::build_quad_mesh(foliation, grid, {});
    std::vector<Strip> strips = make_strips(mesh, ColumnRuns::PerCylinder);
    glue_ends(mesh, foliation, strips);
    double glued = 0.0;
    double bare = 0.0;
    for (const Strip& strip : strips) {
        if (strip.family == Family::Weft) {
            EXPECT_FALSE(strip.glued_start.has_tab || strip.glued_end.has_tab);
            continue;
        }
        const std::vector<WalkedCell> cells = walk_cells(mesh, strip);
        const auto width = [&](int left, int right) {
            return (mesh.vertices[static_cast<std::size_t>(left)] -
                    mesh.vertices[static_cast<std::size_t>(right)])
                .norm();
        };
        (strip.glued_start.has_tab ? glued : bare) += width(cells.front().l0, cells.front().r0);
        (strip.glued_end.has_tab ? glued : bare) += width(cells.back().l1, cells.back().r1);
    }
    EXPECT_GT(glued, 0.0);
    EXPECT_NEAR(glued / bare, 1.0, 0.1);
}

}  // namespace
}  // namespace leafcutter::fab
