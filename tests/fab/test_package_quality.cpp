#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "fab/pipeline.h"
#include "geometry/io/mesh_writer.h"
#include "geometry/samples.h"

namespace leafcutter::fab {
namespace {

using nlohmann::json;

constexpr double kDigits = 2e-5;  // Values are written with six digits.

struct Woven {
    json report;
    json quality;
    std::string quads;
};

Woven weave_sample(const std::string& sample) {
    JobParams params;
    params.scale.longest_side_mm = 200.0;
    params.nesting.time_s = 0.01;
    const std::string text = geometry::write_obj(geometry::make_sample(sample, 1500));
    const std::span<const char> letters(text.data(), text.size());
    const PackageSummary made = weave({"sample.obj", std::as_bytes(letters)}, params,
                                      {built_in_materials(), {}}, geometry::Context{});
    return {json::parse(made.package.find("report.json")->bytes),
            json::parse(made.package.find("quality.json")->bytes),
            made.package.find("quads.obj")->bytes};
}

std::size_t lines_with(const std::string& text, const std::string& begin) {
    std::size_t count = 0;
    for (std::size_t at = text.find("\n" + begin); at != std::string::npos;
         at = text.find("\n" + begin, at + 1)) {
        ++count;
    }
    return count;
}

std::vector<double> known(const json& values) {
    std::vector<double> result;
    for (const json& value : values) {
        if (!value.is_null()) {
            result.push_back(value.get<double>());
        }
    }
    return result;
}

double mean(const std::vector<double>& values) {
    double sum = 0.0;
    for (const double value : values) {
        sum += value;
    }
    return sum / static_cast<double>(values.size());
}

void expect_same(const json& figure, const std::vector<double>& values, const std::string& name) {
    ASSERT_FALSE(values.empty()) << name;
    const double avg = figure.at("avg");
    EXPECT_NEAR(mean(values), avg, kDigits * avg + 1e-12) << name;
    if (figure.contains("max")) {
        const double max = figure.at("max");
        EXPECT_NEAR(*std::max_element(values.begin(), values.end()), max, kDigits * max + 1e-12)
            << name;
    }
}

class PackageQuality : public ::testing::TestWithParam<const char*> {};

TEST_P(PackageQuality, PerQuadAddsUpToTheReport) {
    const Woven woven = weave_sample(GetParam());
    EXPECT_EQ(woven.quality.at("format"), "leafcutter-quality/1");
    const json& overall = woven.report.at("quality").at("overall");
    const json& cells = woven.quality.at("per_quad");
    const json& vertices = woven.quality.at("per_vertex");
    for (const auto& [name, column] : cells.items()) {
        EXPECT_EQ(column.size(), lines_with(woven.quads, "f ")) << name;
    }
    for (const auto& [name, column] : vertices.items()) {
        EXPECT_EQ(column.size(), lines_with(woven.quads, "v ")) << name;
    }
    for (const auto& [figure, column] : {std::pair{"surface_distance_percent", "distance_percent"},
                                         std::pair{"area_distortion_percent", "area_percent"},
                                         std::pair{"region_distortion_percent", "region_percent"},
                                         std::pair{"planarity_percent", "planarity_percent"}}) {
        expect_same(overall.at(figure), known(cells.at(column)), figure);
    }
    for (const char* name :
         {"angle_deviation_deg", "angle_deviation_bound_deg", "crossing_angle_deviation_deg"}) {
        expect_same(overall.at(name), known(vertices.at(name)), name);
    }
}

TEST_P(PackageQuality, RegionsCoverTheSurface) {
    const Woven woven = weave_sample(GetParam());
    double sum = 0.0;
    for (const double area : known(woven.quality.at("per_quad").at("region_area_mm2"))) {
        sum += area;
    }
    const json& surface = woven.report.at("surface");
    const double covered = 1.0 - 0.01 * surface.at("left_out_area_percent").get<double>();
    EXPECT_NEAR(sum / (covered * surface.at("area_mm2").get<double>()), 1.0, 1e-4);
}

// A disk, rings that go on into each other, a sphere with points of one prong.
INSTANTIATE_TEST_SUITE_P(Samples, PackageQuality, ::testing::Values("face", "eight", "sphere"));

}  // namespace
}  // namespace leafcutter::fab
