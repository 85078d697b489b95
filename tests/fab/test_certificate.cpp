// The certificate on a woven tube, and on what somebody did to its programs.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "fab/cut/certificate.h"
#include "fab/cut/toolpath.h"
#include "fab/cut/virtual_weave.h"
#include "fab/export/formats.h"
#include "fab/strips/marks.h"
#include "fab/strips/strips.h"
#include "fab/weave/weave.h"
#include "tests/support/quad_grids.h"

namespace leafcutter::fab {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// A bulging, waisted tube that leans: no two rings alike, cells not planar.
geometry::QuadMesh leaning_vase() {
    return test::quad_grid({8, 12}, geometry::ChartShape::Annulus, [](double g, double f) {
        const double angle = 2.0 * std::numbers::pi * g;
        const double radius = 20.0 + 6.0 * std::sin(3.0 * f) + 1.5 * std::cos(angle) * f;
        return Vector3d(radius * std::cos(angle) + 9.0 * f, radius * std::sin(angle), 80.0 * f);
    });
}

// Pieces in a column, far enough apart, each turned by another angle.
Layout column_of(const std::vector<Piece>& pieces) {
    Sheet sheet;
    sheet.family = "both";
    sheet.size = {1000.0, 100'000.0};
    double y = 200.0;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        Placement placement;
        placement.piece = pieces[i].id;
        placement.x_mm = 500.0;
        placement.y_mm = y;
        placement.rotation_deg = 37.0 * static_cast<double>(i);
        sheet.placements.push_back(placement);
        y += 400.0;
    }
    Layout layout;
    layout.sheets.push_back(sheet);
    return layout;
}

std::string program_of(const JobResult& job) {
    const CutProgram program =
        plan_sheet(job.layout.sheets.front(), job.pieces, {job.weft, {}, job.params.cut});
    return write_gcode(program, MachineProfile{}, job.params.output.dialect);
}

JobResult woven(const FitParams& fit = {}) {
    JobResult job;
    job.params.fit = fit;
    job.quads = leaning_vase();
    job.weft = *find_material(built_in_materials(), "paper-160-yellow");
    job.warp = job.weft;
    job.strips = make_strips(job.quads, ColumnRuns::PerCylinder);
    job.weave = weave_cells(job.quads, job.params.weave);
    job.crossings = crossings_of(job.strips, job.weave);
    PieceLimits limits;
    limits.usable_sheet = {590.0, 390.0};
    std::vector<std::string> warnings;
    for (std::size_t i = 0; i < job.strips.size(); ++i) {
        for (Piece& piece : make_pieces(job.strips[i], job.quads,
                                        {job.params.fit, limits, job.crossings[i]}, warnings)) {
            job.pieces.push_back(std::move(piece));
        }
    }
    mark_pieces(job.pieces, job.strips, job.crossings, fit, warnings);
    job.layout = column_of(job.pieces);
    return job;
}

// What is burnt is made from another job than the one that is certified.
Certificate certify_cut(const JobResult& planned, const JobResult& cut) {
    const std::vector<std::string> gcode{program_of(cut)};
    return certify(planned, gcode);
}

Piece& named(JobResult& job, const std::string& id) {
    return *std::find_if(job.pieces.begin(), job.pieces.end(),
                         [&](const Piece& piece) { return piece.id == id; });
}

void set_id_marks(Piece& piece, const std::string& id) {
    for (Mark& mark : piece.marks) {
        if (mark.text.rfind(piece.id, 0) == 0) {
            mark.text.replace(0, piece.id.size(), id);
        }
    }
}

// Every X and Y of a program, mapped.
template <typename Map>
std::string mapped(const std::string& gcode, Map map) {
    std::string out;
    std::size_t at = 0;
    while (at < gcode.size()) {
        const std::size_t end = std::min(gcode.find('\n', at), gcode.size());
        const std::string line = gcode.substr(at, end - at);
        double x = 0.0;
        double y = 0.0;
        char rest[64] = "";
        const int read = std::sscanf(line.c_str(), "G%*d X%lf Y%lf %63[^\n]", &x, &y, rest);
        if (read >= 2) {
            const Vector2d point = map(Vector2d(x, y));
            char buffer[160];
            std::snprintf(buffer, sizeof buffer, "%.2s X%.3f Y%.3f %s\n", line.c_str(), point.x(),
                          point.y(), read == 3 ? rest : "");
            out += buffer;
        } else {
            out += line + "\n";
        }
        at = end + 1;
    }
    return out;
}

TEST(Certificate, HoldsForWhatIsCutAsPlanned) {
    const JobResult job = woven();
    const Certificate result = certify_cut(job, job);
    EXPECT_TRUE(result.holds) << (result.faults.empty() ? "" : result.faults.front());
    EXPECT_LT(result.largest_deviation_relative, kLargestDeviation);
    EXPECT_LT(result.largest_length_error_mm, 4e-3);
    EXPECT_EQ(result.matched_by, "ids");
    EXPECT_EQ(result.matched_by_id, static_cast<int>(job.pieces.size()));
    EXPECT_EQ(result.unread + result.missing + result.extra_contours, 0);
    EXPECT_GT(result.ticks, 100);
    EXPECT_GT(result.edges_compared, 8 * 12 * 5);
}

TEST(Certificate, HoldsInEveryDialectAndForLinesAcross) {
    for (const Dialect dialect : {Dialect::Marlin, Dialect::Smoothie}) {
        FitParams fit;
        fit.cell_marks = CellMarks::Lines;
        JobResult job = woven(fit);
        job.params.output.dialect = dialect;
        const Certificate result = certify_cut(job, job);
        EXPECT_TRUE(result.holds) << (result.faults.empty() ? "" : result.faults.front());
    }
}

TEST(Certificate, FindsPiecesByShapeWithoutMarks) {
    FitParams fit;
    fit.labels = false;
    fit.cell_marks = CellMarks::None;
    const JobResult job = woven(fit);
    const Certificate result = certify_cut(job, job);
    EXPECT_TRUE(result.holds) << (result.faults.empty() ? "" : result.faults.front());
    EXPECT_EQ(result.matched_by, "shapes");
    EXPECT_EQ(result.unread, static_cast<int>(job.pieces.size()));
    EXPECT_EQ(result.matched_by_shape, static_cast<int>(job.pieces.size()));
}

TEST(Certificate, DoesNotReadTheLayout) {
    const JobResult job = woven();
    JobResult blind = job;
    blind.layout = {};
    EXPECT_TRUE(certify_cut(blind, job).holds);
}

TEST(Certificate, SeesSwappedLabels) {
    const JobResult job = woven();
    JobResult cut = job;
    set_id_marks(named(cut, "W2.1"), "W5.1");
    set_id_marks(named(cut, "W5.1"), "W2.1");
    const Certificate result = certify_cut(job, cut);
    EXPECT_FALSE(result.holds);
    EXPECT_GT(result.largest_outline_error_mm, kLargestOutlineMm);
    ASSERT_GE(result.faults.size(), 2U);
    EXPECT_EQ(result.faults[0], "W2.1: is engraved on the contour of W5.1");
}

TEST(Certificate, SeesAnIdThatDoesNotExist) {
    const JobResult job = woven();
    JobResult cut = job;
    set_id_marks(named(cut, "W2.1"), "W99.1");
    EXPECT_FALSE(certify_cut(job, cut).holds);
}

TEST(Certificate, SeesAMissingPiece) {
    const JobResult job = woven();
    JobResult cut = job;
    cut.layout.sheets.front().placements.erase(cut.layout.sheets.front().placements.begin() + 3);
    const Certificate result = certify_cut(job, cut);
    EXPECT_FALSE(result.holds);
    EXPECT_EQ(result.missing, 1);
    EXPECT_EQ(result.largest_deviation_relative, 1.0);
}

TEST(Certificate, SeesAPieceCutTwice) {
    const JobResult job = woven();
    JobResult cut = job;
    Placement again = cut.layout.sheets.front().placements.front();
    again.x_mm += 300.0;
    cut.layout.sheets.front().placements.push_back(again);
    const Certificate result = certify_cut(job, cut);
    EXPECT_FALSE(result.holds);
    EXPECT_EQ(result.duplicates, 1);
}

TEST(Certificate, SeesAContourOfNoPiece) {
    const JobResult job = woven();
    JobResult cut = job;
    Piece stranger;
    stranger.id = "X";
    stranger.outline = {{0.0, 0.0}, {30.0, 0.0}, {30.0, 7.0}, {0.0, 7.0}};
    cut.pieces.push_back(stranger);
    Placement place;
    place.piece = "X";
    place.x_mm = 900.0;
    place.y_mm = 50.0;
    cut.layout.sheets.front().placements.push_back(place);
    const Certificate result = certify_cut(job, cut);
    EXPECT_FALSE(result.holds);
    EXPECT_EQ(result.extra_contours, 1);
}

TEST(Certificate, SeesAScaledProgram) {
    const JobResult job = woven();
    const std::vector<std::string> gcode{
        mapped(program_of(job), [](const Vector2d& point) { return Vector2d(1.001 * point); })};
    const Certificate result = certify(job, gcode);
    EXPECT_FALSE(result.holds);
    EXPECT_EQ(result.matched_by_id, static_cast<int>(job.pieces.size()));
    EXPECT_GT(result.largest_deviation_relative, kLargestDeviation);
    // All lengths grow by a thousandth, and the surface with them.
    EXPECT_GT(result.largest_deviation_mm, 0.8 * 0.0005 * 80.0);
}

TEST(Certificate, SeesOneCornerMoved) {
    const JobResult job = woven();
    for (const Vector2d& shift : {Vector2d(0.2, 0.0), Vector2d(0.0, 0.2)}) {
        JobResult cut = job;
        Ring& outline = named(cut, "W4.1").outline;
        outline[outline.size() / 4] += shift;
        const Certificate result = certify_cut(job, cut);
        EXPECT_FALSE(result.holds);
        EXPECT_GT(result.largest_outline_error_mm, kLargestOutlineMm);
    }
}

TEST(Certificate, SeesAMirroredPiece) {
    const JobResult job = woven();
    JobResult cut = job;
    for (Vector2d& point : named(cut, "W3.1").outline) {
        point.y() = -point.y();
    }
    std::reverse(named(cut, "W3.1").outline.begin(), named(cut, "W3.1").outline.end());
    const Certificate contour_only = certify_cut(job, cut);
    EXPECT_FALSE(contour_only.holds);

    // Marks and all: then its id can't be read, and no piece has its shape.
    cut = job;
    cut.layout.sheets.front().placements[2].mirrored = true;
    const Certificate whole = certify_cut(job, cut);
    EXPECT_FALSE(whole.holds);
    EXPECT_EQ(whole.unread, 1);
    EXPECT_EQ(whole.missing, 1);
    EXPECT_EQ(whole.extra_contours, 1);
}

TEST(Certificate, SeesShiftedTicks) {
    const JobResult job = woven();
    const auto with_ticks_moved = [&](double by_mm) {
        JobResult cut = job;
        Piece& piece = named(cut, "W4.1");
        const Vector2d way = (piece.cut_left[1] - piece.cut_left[0]).normalized();
        for (Mark& mark : piece.marks) {
            for (Vector2d& point : mark.path) {
                point += by_mm * way;
            }
        }
        return certify_cut(job, cut);
    };
    const Certificate little = with_ticks_moved(0.2);
    EXPECT_FALSE(little.holds);
    EXPECT_GT(little.largest_tick_error_mm, kLargestTickMm);
    EXPECT_GT(little.largest_length_error_mm, 0.05);
    const Certificate far = with_ticks_moved(1.0);
    EXPECT_FALSE(far.holds);
    EXPECT_GT(far.ticks_missing, 0);
}

TEST(Certificate, CountsNothingOnEmptySheets) {
    const JobResult job = woven();
    const Certificate result = certify(job, {});
    EXPECT_FALSE(result.holds);
    EXPECT_EQ(result.missing, static_cast<int>(job.pieces.size()));
    EXPECT_EQ(result.matched_by, "nothing");
    EXPECT_EQ(result.faults.size(), std::min(job.pieces.size(), kMostFaults + 1));
}

std::vector<MeasuredLength> lengths_of(const geometry::QuadMesh& mesh, double scale) {
    std::vector<MeasuredLength> lengths;
    for (const auto& quad : mesh.quads) {
        for (const auto& [i, j] : {std::pair(0, 1), std::pair(1, 2), std::pair(2, 3),
                                   std::pair(3, 0), std::pair(0, 2)}) {
            const int from = quad[static_cast<std::size_t>(i)];
            const int to = quad[static_cast<std::size_t>(j)];
            lengths.push_back({from, to,
                               scale * (mesh.vertices[static_cast<std::size_t>(from)] -
                                        mesh.vertices[static_cast<std::size_t>(to)])
                                           .norm(),
                               Family::Weft});
        }
    }
    return lengths;
}

TEST(VirtualWeave, StaysWhereLengthsAreThePlans) {
    const geometry::QuadMesh mesh = leaning_vase();
    const auto woven_vertices = weave_virtually(mesh, lengths_of(mesh, 1.0));
    for (std::size_t i = 0; i < woven_vertices.size(); ++i) {
        EXPECT_LT((woven_vertices[i] - mesh.vertices[i]).norm(), 1e-9);
    }
}

TEST(VirtualWeave, GrowsWithItsLengths) {
    const geometry::QuadMesh mesh = leaning_vase();
    const auto woven_vertices = weave_virtually(mesh, lengths_of(mesh, 1.01));
    EXPECT_NEAR(diagonal_of(woven_vertices) / diagonal_of(mesh.vertices), 1.01, 0.001);
}

TEST(Disagreement, IsTheLargestBetweenFamiliesOnOneLength) {
    EXPECT_EQ(largest_disagreement_mm({}), 0.0);
    EXPECT_NEAR(largest_disagreement_mm({{0, 1, 10.0, Family::Weft},
                                         {1, 0, 10.3, Family::Warp},
                                         {0, 1, 9.9, Family::Weft},
                                         {1, 2, 5.0, Family::Weft},
                                         {1, 2, 9.0, Family::Weft}}),
                0.4, 1e-12);
}

}  // namespace
}  // namespace leafcutter::fab
