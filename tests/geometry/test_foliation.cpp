// The facade: which surfaces are taken, which refused and how, and what every foliation promises.

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "geometry/foliation.h"
#include "tests/geometry/chart_checks.h"
#include "tests/geometry/surfaces.h"

namespace leafcutter::geometry {
namespace {

using testing::at;
using testing::is_sound;
using testing::make_grid;
using testing::make_prism;
using testing::make_square;
using testing::make_torus;
using testing::to_mesh;

TriangleMesh make_tetrahedron() {
    return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
            {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}};
}

void expect_refusal(const TriangleMesh& mesh,
                    const FoliationOptions& options,
                    ErrorKind kind,
                    const std::string& code) {
    try {
        compute_foliation(to_mesh(mesh), options);
        FAIL() << "took what should be refused as " << code;
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), kind);
        EXPECT_EQ(error.code(), code);
        EXPECT_GT(std::string(error.what()).size(), 30U);
    }
}

TEST(Foliation, RefusesModesThatDoNotFit) {
    FoliationOptions options;
    options.mode = FoliationMode::Torus;
    expect_refusal(make_square(4), options, ErrorKind::BadOption, "mode-does-not-fit");
    options.mode = FoliationMode::Disk;
    expect_refusal(make_prism(8, 3, 1.0, 1.0), options, ErrorKind::BadOption, "mode-does-not-fit");
    options.mode = FoliationMode::SpherePillowcase;
    expect_refusal(make_square(4), options, ErrorKind::BadOption, "mode-does-not-fit");
    options.mode = FoliationMode::SpherePolar;
    expect_refusal(make_square(4), options, ErrorKind::BadOption, "mode-does-not-fit");
}

TEST(Foliation, RefusesModesThatNeedHolesNobodyMayOpen) {
    FoliationOptions options;
    options.puncture = PunctureChoice::None;
    for (const FoliationMode mode : {FoliationMode::Pants, FoliationMode::OneForm}) {
        options.mode = mode;
        expect_refusal(make_square(4), options, ErrorKind::BadOption, "mode-does-not-fit");
        expect_refusal(make_torus(10, 20, 0.3), options, ErrorKind::BadOption, "mode-does-not-fit");
    }
}

TEST(Foliation, RefusesBadCorners) {
    const TriangleMesh square = make_square(4);  // Vertices 0..24, 12 in the middle.
    FoliationOptions options;
    for (const std::array<int, 4> corners :
         {std::array<int, 4>{0, 4, 24, 12}, std::array<int, 4>{0, 4, 24, 0},
          std::array<int, 4>{0, 4, 24, -1}, std::array<int, 4>{0, 4, 24, 25}}) {
        options.corners = corners;
        expect_refusal(square, options, ErrorKind::BadOption, "bad-corners");
    }
    options.corners = {0, 1, 2, 3};
    expect_refusal(make_prism(8, 3, 1.0, 1.0), options, ErrorKind::BadOption, "bad-corners");
}

TEST(Foliation, RefusesABoundaryWithoutRoomForCorners) {
    TriangleMesh open = make_tetrahedron();
    open.triangles.pop_back();
    expect_refusal(open, {}, ErrorKind::BadMesh, "boundary-too-short");
}

TEST(Foliation, NamesTheModeItUsedAndItsGraph) {
    const Foliation disk = compute_foliation(to_mesh(make_square(6)));
    EXPECT_EQ(disk.mode, FoliationMode::Disk);
    EXPECT_EQ(disk.graph.nodes, 2);
    EXPECT_TRUE(disk.corners.has_value());
    const Foliation annulus = compute_foliation(to_mesh(make_prism(10, 5, 1.0, 1.0)));
    EXPECT_EQ(annulus.mode, FoliationMode::Annulus);
    EXPECT_EQ(annulus.graph.nodes, 2);
    const Foliation torus = compute_foliation(to_mesh(make_torus(10, 20, 0.3)));
    EXPECT_EQ(torus.mode, FoliationMode::Torus);
    EXPECT_EQ(torus.graph.nodes, 1);
    for (const Foliation* foliation : {&disk, &annulus, &torus}) {
        ASSERT_EQ(foliation->cylinders.size(), 1U);
        ASSERT_EQ(foliation->graph.edges.size(), 1U);
        EXPECT_TRUE(foliation->singularities.empty());
        EXPECT_TRUE(is_sound(foliation->cylinders[0]));
        EXPECT_EQ(foliation->iterations, 1);
        // The energy is half of circumference times height (within the gap).
        EXPECT_NEAR(2.0 * foliation->energy, foliation->cylinders[0].width,
                    0.02 * foliation->energy);
    }
}

TEST(Foliation, DoesNotDependOnSize) {
    for (const TriangleMesh& mesh :
         {make_square(9), make_prism(14, 6, 1.0, 2.0), make_torus(10, 22, 0.3)}) {
        const Foliation base = compute_foliation(to_mesh(mesh));
        for (const double scale : {1e-9, 1e9}) {
            TriangleMesh scaled = mesh;
            for (Eigen::Vector3d& position : scaled.positions) {
                position *= scale;
            }
            const Foliation same = compute_foliation(to_mesh(scaled));
            EXPECT_NEAR(same.cylinders[0].width, base.cylinders[0].width, 1e-9);
            EXPECT_TRUE(is_sound(same.cylinders[0]));
        }
    }
}

TEST(Foliation, ReportsProgressThatNeverFallsAndStopsOnRequest) {
    const Mesh mesh = to_mesh(make_torus(10, 22, 0.3));
    std::vector<double> fractions;
    Context context;
    context.progress = [&](std::string_view, double fraction) { fractions.push_back(fraction); };
    compute_foliation(mesh, {}, context);
    EXPECT_TRUE(std::is_sorted(fractions.begin(), fractions.end()));
    ASSERT_FALSE(fractions.empty());
    EXPECT_EQ(fractions.back(), 1.0);

    std::stop_source source;
    source.request_stop();
    Context stopped;
    stopped.stop = source.get_token();
    EXPECT_THROW(compute_foliation(mesh, {}, stopped), Cancelled);
}

}  // namespace
}  // namespace leafcutter::geometry
