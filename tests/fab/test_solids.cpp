#include <cstring>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "fab/export/colour.h"
#include "fab/export/solids.h"

namespace leafcutter::fab {
namespace {

using nlohmann::json;

// A tetrahedron of 10 mm.
Solid tetrahedron(const std::string& name, Family family) {
    Solid solid;
    solid.name = name;
    solid.family = family;
    solid.vertices = {{0, 0, 0}, {10, 0, 0}, {0, 10, 0}, {0, 0, 10}};
    solid.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
    return solid;
}

std::vector<Solid> two_solids() {
    return {tetrahedron("W1", Family::Weft), tetrahedron("P1", Family::Warp)};
}

template <typename Number>
Number number_at(const std::string& bytes, std::size_t at) {
    Number value{};
    std::memcpy(&value, bytes.data() + at, sizeof value);
    return value;
}

TEST(Stl, HoldsEveryTriangleInMillimetres) {
    const std::string stl = write_stl(two_solids());
    ASSERT_EQ(stl.size(), 84U + 8U * 50U);
    EXPECT_NE(stl.substr(0, 5), "solid");
    EXPECT_EQ(number_at<std::uint32_t>(stl, 80), 8U);
    // The first triangle: normal -z, then the corners 0, 2, 1.
    EXPECT_FLOAT_EQ(number_at<float>(stl, 84 + 8), -1.0F);
    EXPECT_FLOAT_EQ(number_at<float>(stl, 84 + 24 + 4), 10.0F);
    EXPECT_FLOAT_EQ(number_at<float>(stl, 84 + 36), 10.0F);
}

TEST(Obj, NamesStripsAndCountsVerticesThroughout) {
    const std::string obj = write_obj(two_solids(), "woven.mtl");
    EXPECT_NE(obj.find("mtllib woven.mtl\n"), std::string::npos);
    EXPECT_NE(obj.find("o W1\nusemtl weft\n"), std::string::npos);
    EXPECT_NE(obj.find("o P1\nusemtl warp\n"), std::string::npos);
    EXPECT_NE(obj.find("f 5 7 6\n"), std::string::npos);
    const std::string mtl = write_mtl({"#ff0000", "#0000ff"});
    EXPECT_NE(mtl.find("newmtl weft\nKd 1.0000 0.0000 0.0000\n"), std::string::npos);
}

TEST(Glb, PointsIntoItsBytes) {
    const std::string glb = write_glb(two_solids(), {"#ff0000", "#808080"});
    EXPECT_EQ(glb.substr(0, 4), "glTF");
    EXPECT_EQ(number_at<std::uint32_t>(glb, 4), 2U);
    ASSERT_EQ(number_at<std::uint32_t>(glb, 8), glb.size());
    const std::size_t length = number_at<std::uint32_t>(glb, 12);
    ASSERT_EQ(length % 4, 0U);
    ASSERT_EQ(glb.substr(16, 4), "JSON");
    const json file = json::parse(glb.substr(20, length));
    const std::size_t begin = 20 + length + 8;
    ASSERT_EQ(number_at<std::uint32_t>(glb, 20 + length), glb.size() - begin);

    EXPECT_EQ(file["buffers"][0]["byteLength"], glb.size() - begin);
    for (const json& view : file["bufferViews"]) {
        EXPECT_EQ(view["byteOffset"].get<std::size_t>() % 4, 0U);
        EXPECT_LE(view["byteOffset"].get<std::size_t>() + view["byteLength"].get<std::size_t>(),
                  glb.size() - begin);
    }
    // Nodes: the root, then the strips; metres.
    const json& root = file["nodes"][file["scenes"][0]["nodes"][0].get<std::size_t>()];
    ASSERT_EQ(root["children"].size(), 2U);
    const json& node = file["nodes"][root["children"][1].get<std::size_t>()];
    EXPECT_EQ(node["name"], "P1");
    const json& mesh = file["meshes"][node["mesh"].get<std::size_t>()]["primitives"][0];
    EXPECT_EQ(file["materials"][mesh["material"].get<std::size_t>()]["name"], "warp");
    const json& positions = file["accessors"][mesh["attributes"]["POSITION"].get<std::size_t>()];
    EXPECT_NEAR(positions["max"][2].get<double>(), 0.01, 1e-9);
    const json& indices = file["accessors"][mesh["indices"].get<std::size_t>()];
    EXPECT_EQ(indices["count"], 12);
    const std::size_t offset =
        file["bufferViews"][indices["bufferView"].get<std::size_t>()]["byteOffset"];
    EXPECT_EQ(number_at<std::uint16_t>(glb, begin + offset + 2), 2U);
}

TEST(Glb, WritesColoursAsLight) {
    const std::string glb = write_glb(two_solids(), {"#ff0000", "#808080"});
    const json file = json::parse(glb.substr(20, number_at<std::uint32_t>(glb, 12)));
    const json& grey = file["materials"][1]["pbrMetallicRoughness"]["baseColorFactor"];
    EXPECT_NEAR(grey[0].get<double>(), 0.2158605, 1e-6);
    EXPECT_EQ(file["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"][0], 1.0);
}

TEST(Glb, NeedsNoStrips) {
    const std::string glb = write_glb({}, {});
    EXPECT_EQ(number_at<std::uint32_t>(glb, 8), glb.size());
}

TEST(Colour, IsGreyIfItIsNone) {
    EXPECT_EQ(rgb_of("#ff8000")[0], 1.0);
    EXPECT_EQ(rgb_of("blue"), (Rgb{0.5, 0.5, 0.5}));
    EXPECT_EQ(rgb_of("#12345g"), (Rgb{0.5, 0.5, 0.5}));
}

}  // namespace
}  // namespace leafcutter::fab
