#include <cstring>
#include <numbers>
#include <set>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "fab/pipeline.h"
#include "fab/utf8.h"
#include "fab/warnings.h"
#include "geometry/error.h"
#include "geometry/io/mesh_writer.h"
#include "geometry/samples.h"

namespace leafcutter::fab {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

// A wavy sheet of n x n squares, each cut in two; side 1.
std::string wavy_sheet(int n) {
    geometry::TriangleMesh mesh;
    for (int i = 0; i <= n; ++i) {
        for (int j = 0; j <= n; ++j) {
            const double x = double(j) / n;
            const double y = double(i) / n;
            mesh.positions.emplace_back(x, y, 0.1 * std::sin(3.0 * x) * std::cos(2.0 * y));
        }
    }
    for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) {
            const int a = i * (n + 1) + j;
            mesh.triangles.push_back({a, a + 1, a + n + 2});
            mesh.triangles.push_back({a, a + n + 2, a + n + 1});
        }
    }
    return geometry::write_obj(mesh);
}

JobParams small_job() {
    JobParams params;
    params.scale.longest_side_mm = 80.0;
    params.nesting.time_s = 0.01;
    return params;
}

PackageSummary weave_text(const std::string& text,
                          const JobParams& params,
                          const std::string& name = "sheet.obj",
                          const geometry::Context& context = {}) {
    const std::span<const char> letters(text.data(), text.size());
    return weave({name, std::as_bytes(letters)}, params, {built_in_materials(), {}}, context);
}

// The number behind `"key":` in JSON text, the first one after `from`.
double number_behind(const std::string& json, const std::string& key, std::size_t from = 0) {
    const std::size_t at = json.find("\"" + key + "\":", from);
    EXPECT_NE(at, std::string::npos) << key;
    return std::stod(json.substr(at + key.size() + 3));
}

std::string refusal(const JobParams& params) {
    try {
        weave_text(wavy_sheet(10), params);
    } catch (const geometry::Error& error) {
        EXPECT_EQ(error.kind(), geometry::ErrorKind::BadOption);
        return error.what();
    }
    return {};
}

TEST(Weave, WritesEveryFileOfThePackage) {
    const PackageSummary made = weave_text(wavy_sheet(20), small_job());
    std::vector<std::string> names;
    for (const PackageFile& file : made.package.files) {
        EXPECT_FALSE(file.bytes.empty()) << file.path;
        if (file.path.rfind("scissors/page-", 0) != 0) {  // As many pages as it takes.
            names.push_back(file.path);
        }
    }
    std::vector<std::string> expected = {
        "report.json", "surface.ply", "quads.obj",  "quality.json", "leaves.json", "strips.json",
        "weave.json",  "layout.json", "guide.html", "guide.pdf",    "woven.stl",   "woven.obj",
        "woven.mtl",   "woven.glb",   "strips.svg", "bill.csv",     "stock.json"};
    for (int sheet = 1; sheet <= made.sheets; ++sheet) {
        for (const char* ending : {".svg", ".dxf", ".gcode"}) {
            expected.push_back(fmt::format("sheets/sheet-{:03}{}", sheet, ending));
        }
    }
    EXPECT_THAT(names, testing::UnorderedElementsAreArray(expected));
    EXPECT_EQ(made.strips, made.pieces);
    EXPECT_GT(made.quads, 40);
    EXPECT_GT(made.estimated_s, 0.0);
}

TEST(Weave, CertifiesWhatTheBeamCuts) {
    const PackageSummary made = weave_text(wavy_sheet(20), small_job());
    const std::string& report = made.package.find("report.json")->bytes;
    EXPECT_LT(number_behind(report, "largest_deviation_relative"), 1e-4);
    // Of each strip: both sides and the diagonal of its cells, and its rungs.
    EXPECT_EQ(number_behind(report, "edges_compared"), 8.0 * made.quads + made.strips);
}

TEST(Weave, ScalesTheLongestSide) {
    const std::string report =
        weave_text(wavy_sheet(12), small_job()).package.find("report.json")->bytes;
    EXPECT_NEAR(number_behind(report, "scale"), 80.0, 1e-9);
    JobParams as_is = small_job();
    as_is.scale.longest_side_mm.reset();
    as_is.grid.strip_width_mm = 0.2;
    as_is.fit.labels = false;
    EXPECT_EQ(number_behind(weave_text(wavy_sheet(12), as_is).package.find("report.json")->bytes,
                            "scale"),
              1.0);
}

TEST(Weave, GivesEqualPackagesForEqualInput) {
    const PackageSummary one = weave_text(wavy_sheet(12), small_job());
    const PackageSummary two = weave_text(wavy_sheet(12), small_job());
    ASSERT_EQ(one.package.files.size(), two.package.files.size());
    for (std::size_t i = 0; i < one.package.files.size(); ++i) {
        EXPECT_EQ(one.package.files[i].bytes, two.package.files[i].bytes)
            << one.package.files[i].path;
    }
}

TEST(Weave, PutsBothFamiliesOnOneSheetWhereTheyShareTheMaterial) {
    JobParams params = small_job();
    EXPECT_EQ(weave_text(wavy_sheet(12), params).sheets, 2);
    params.material.warp = params.material.weft;
    const PackageSummary made = weave_text(wavy_sheet(12), params);
    EXPECT_EQ(made.sheets, 1);
    EXPECT_THAT(made.package.find("layout.json")->bytes, HasSubstr("\"family\":\"both\""));
}

std::size_t vertices_in(const std::string& quads) {
    std::size_t count = 0;
    for (std::size_t i = quads.find("\nv "); i != std::string::npos;
         i = quads.find("\nv ", i + 1)) {
        ++count;
    }
    return count;
}

TEST(Weave, GoesOnFromOneCylinderIntoTheNext) {
    const std::string model = geometry::write_obj(geometry::make_sample("double-torus", 3000));
    JobParams params = small_job();
    params.grid.strip_width_mm = 5.0;
    const PackageSummary made = weave_text(model, params, "double-torus.obj");
    const std::string& quads = made.package.find("quads.obj")->bytes;
    EXPECT_THAT(quads, HasSubstr("g cylinder_2\n"));  // 3g - 3 = 3 cylinders.
    // Euler characteristic -2 of one closed mesh, with two edges to each quad.
    EXPECT_EQ(vertices_in(quads), static_cast<std::size_t>(made.quads) - 2U);
    EXPECT_THAT(made.package.find("weave.json")->bytes, HasSubstr("\"seams\":[]"));
    EXPECT_THAT(made.package.find("guide.html")->bytes, HasSubstr("Joining the regions"));
    EXPECT_LT(number_behind(made.package.find("report.json")->bytes, "largest_deviation_relative"),
              1e-3);
    params.grid.junctions = geometry::Junctions::Independent;
    const PackageSummary apart = weave_text(model, params, "double-torus.obj");
    EXPECT_GT(vertices_in(apart.package.find("quads.obj")->bytes),
              static_cast<std::size_t>(apart.quads));
}

// Two models as one, the second moved aside by `shift`.
geometry::TriangleMesh side_by_side(geometry::TriangleMesh one,
                                    const geometry::TriangleMesh& two,
                                    double shift) {
    const int base = static_cast<int>(one.positions.size());
    for (const Eigen::Vector3d& point : two.positions) {
        one.positions.emplace_back(point.x() + shift, point.y(), point.z());
    }
    for (const auto& [a, b, c] : two.triangles) {
        one.triangles.push_back({base + a, base + b, base + c});
    }
    return one;
}

TEST(Weave, WeavesEachPartOrTheLargestAlone) {
    const std::string model = geometry::write_obj(side_by_side(
        geometry::make_sample("torus", 1500), geometry::make_sample("cylinder", 600), 20.0));
    JobParams params = small_job();
    params.scale.longest_side_mm = 300.0;  // So that whole numbers of rows mean little.
    const PackageSummary both = weave_text(model, params, "both.obj");
    const std::string& report = both.package.find("report.json")->bytes;
    EXPECT_EQ(number_behind(report, "components"), 2.0);
    EXPECT_LT(number_behind(report, "left_out_area_percent"), 1e-6);
    EXPECT_THAT(both.package.find("guide.html")->bytes, HasSubstr(", part 2<"));
    EXPECT_LT(number_behind(report, "largest_deviation_relative"), 1e-3);
    JobParams largest = params;
    largest.foliation.components = geometry::Components::Largest;
    const PackageSummary one = weave_text(model, largest, "both.obj");
    EXPECT_LT(one.quads, both.quads);
    EXPECT_THAT(one.package.find("guide.html")->bytes, Not(HasSubstr("Cylinder 2")));
    const std::string& of_one = one.package.find("report.json")->bytes;
    EXPECT_GT(number_behind(of_one, "left_out_area_percent"), 5.0);
    EXPECT_GE(number_behind(of_one, "removed_area_percent"),
              number_behind(of_one, "left_out_area_percent"));
}

TEST(Weave, TellsWhereAHoleWasOpenedInNumbersOfTheFile) {
    JobParams params = small_job();
    const geometry::TriangleMesh tube = geometry::make_sample("cylinder", 3000);
    // Halfway up, so that the hole stays clear of both ends.
    int vertex = 0;
    Eigen::Vector3d low = tube.positions.front();
    Eigen::Vector3d high = low;
    for (const Eigen::Vector3d& point : tube.positions) {
        low = low.cwiseMin(point);
        high = high.cwiseMax(point);
    }
    const auto off_middle = [&](std::size_t i) {
        return std::abs(tube.positions[i].z() - 0.5 * (low.z() + high.z()));
    };
    for (std::size_t i = 0; i < tube.positions.size(); ++i) {
        vertex = off_middle(i) < off_middle(static_cast<std::size_t>(vertex)) ? static_cast<int>(i)
                                                                              : vertex;
    }
    params.foliation.puncture = geometry::PunctureChoice::Given;
    params.foliation.punctures = {{vertex + 1, 4.0}};
    // A vertex that nothing uses comes first: the file's numbers aren't the mesh's.
    std::string model = "v 9 9 9\n";
    for (const Eigen::Vector3d& point : tube.positions) {
        model += fmt::format("v {} {} {}\n", point.x(), point.y(), point.z());
    }
    for (const auto& [a, b, c] : tube.triangles) {
        model += fmt::format("f {} {} {}\n", a + 2, b + 2, c + 2);
    }
    const PackageSummary made = weave_text(model, params, "tube.obj");
    const std::string& report = made.package.find("report.json")->bytes;
    const std::size_t holes = report.find("\"punctures\":");
    ASSERT_NE(holes, std::string::npos);
    EXPECT_EQ(number_behind(report, "vertex", holes), vertex + 1.0);
    EXPECT_NEAR(number_behind(report, "radius_mm", holes), 4.0, 1e-9);
    const double lost =
        0.01 * number_behind(report, "left_out_area_percent") * number_behind(report, "area_mm2");
    EXPECT_NEAR(lost, std::numbers::pi * 16.0, 3.0);
}

TEST(Weave, WritesTheCriticalGraphWhereCylindersMeet) {
    const std::string model = geometry::write_obj(geometry::make_sample("eight", 3000));
    const PackageSummary made = weave_text(model, small_job(), "eight.obj");
    const std::string& leaves = made.package.find("leaves.json")->bytes;
    const std::size_t graph = leaves.find("\"critical_graph\":[{\"points\":[[");
    EXPECT_NE(graph, std::string::npos);
    const std::string& report = made.package.find("report.json")->bytes;
    EXPECT_GT(number_behind(report, "largest_edge"), 0.5);
    EXPECT_LT(number_behind(report, "flux_mismatch"), 1e-3);
}

TEST(Weave, RefusesUnknownMaterialsByTheirPath) {
    JobParams params = small_job();
    params.material.warp = "cheese";
    EXPECT_EQ(refusal(params), "material.warp: there is no material cheese");
}

TEST(Weave, RefusesMarginsThatLeaveNoSheet) {
    JobParams params = small_job();
    params.nesting.margin_mm = 200.0;
    EXPECT_THAT(refusal(params), StartsWith("nesting.margin_mm: "));
}

TEST(Weave, RefusesCornersThatTheFileHasNot) {
    JobParams params = small_job();
    params.foliation.corners = {0, 10, 120, 4711};
    EXPECT_THAT(refusal(params), StartsWith("foliation.corners[3]: the model has no vertex 4711"));
}

TEST(Weave, EscapesTheFileNameInTheGuide) {
    const PackageSummary made =
        weave_text(wavy_sheet(12), small_job(), "<script>alert(1)</script>\xff & \"x\".obj");
    const std::string& guide = made.package.find("guide.html")->bytes;
    EXPECT_EQ(guide.find("<script"), std::string::npos);
    EXPECT_THAT(guide, HasSubstr("&lt;script&gt;alert(1)&lt;/script&gt;\xEF\xBF\xBD &amp;"));
    EXPECT_EQ(valid_utf8(made.package.find("report.json")->bytes),
              made.package.find("report.json")->bytes);
}

TEST(Weave, StopsWhenAsked) {
    std::stop_source stop;
    geometry::Context context;
    context.stop = stop.get_token();
    std::string stopped_in;
    context.progress = [&](std::string_view stage, double) {
        if (stage == "strips") {
            stopped_in = stage;
            stop.request_stop();
        }
    };
    EXPECT_THROW(weave_text(wavy_sheet(12), small_job(), "sheet.obj", context),
                 geometry::Cancelled);
    EXPECT_EQ(stopped_in, "strips");
}

TEST(Weave, TellsProgressThatNeverFallsAndEndsAtOne) {
    geometry::Context context;
    std::vector<double> told;
    context.progress = [&](std::string_view, double fraction) { told.push_back(fraction); };
    weave_text(wavy_sheet(12), small_job(), "sheet.obj", context);
    EXPECT_TRUE(std::is_sorted(told.begin(), told.end()));
    EXPECT_EQ(told.back(), 1.0);
}

TEST(ValidUtf8, ReplacesExactlyWhatIsInvalid) {
    EXPECT_EQ(valid_utf8("Blatt-\xC3\xBC \xE2\x82\xAC \xF0\x9F\x8D\x83"),
              "Blatt-\xC3\xBC \xE2\x82\xAC \xF0\x9F\x8D\x83");
    EXPECT_EQ(valid_utf8("a\xffz"), "a\xEF\xBF\xBDz");
    EXPECT_EQ(valid_utf8("\xC0\xAF"), "\xEF\xBF\xBD\xEF\xBF\xBD");
    EXPECT_EQ(valid_utf8("\xED\xA0\x80").find("\xED"), std::string::npos);
    EXPECT_EQ(valid_utf8("\xE2\x82"), "\xEF\xBF\xBD\xEF\xBF\xBD");
}

TEST(JoinedWarnings, SayTheSameOnce) {
    EXPECT_EQ(joined_warnings({"W1: thin", "the surface is odd", "W2: thin", "P1: bent"}),
              (std::vector<std::string>{"W1, W2: thin", "the surface is odd", "P1: bent"}));
}

}  // namespace
}  // namespace leafcutter::fab
