#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "geometry/io/mesh_writer.h"
#include "geometry/io/read_mesh.h"
#include "geometry/repair.h"
#include "geometry/topology.h"
#include "tests/support/mesh_text.h"

namespace leafcutter::geometry {
namespace {

using test::code_of;
using test::error_of;
using test::read_text;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr std::string_view kTriangleObj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
constexpr std::string_view kTriangleOff = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
constexpr std::string_view kTrianglePly =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float "
    "z\n"
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
    "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
constexpr std::string_view kTriangleStl =
    "solid one\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
    "endloop\nendfacet\nendsolid one\n";

template <typename Number>
void append_raw(std::string& out, Number number, std::size_t order = 1) {
    std::array<char, sizeof(Number)> raw{};
    std::memcpy(raw.data(), &number, raw.size());
    if (order != 1) {
        std::reverse(raw.begin(), raw.end());
    }
    out.append(raw.data(), raw.size());
}

std::string binary_stl(std::uint32_t claimed, std::uint32_t held, std::string header) {
    header.resize(80);
    append_raw(header, claimed);
    for (std::uint32_t face = 0; face < held; ++face) {
        const auto shift = static_cast<float>(face);
        for (const float number :
             {0.F, 0.F, 1.F, shift, 0.F, 0.F, shift + 1, 0.F, 0.F, shift, 1.F, 0.F}) {
            append_raw(header, number);
        }
        append_raw(header, std::uint16_t{0});
    }
    return header;
}

std::string binary_ply(bool big_endian) {
    std::string out = std::string("ply\r\nformat ") +
                      (big_endian ? "binary_big_endian" : "binary_little_endian") +
                      " 1.0\r\nelement vertex 3\r\nproperty double x\r\nproperty float y\r\n"
                      "property short z\r\nproperty list uchar float extra\r\n"
                      "element face 1\r\nproperty uchar flags\r\n"
                      "property list ushort uint vertex_index\r\nend_header\r\n";
    const std::size_t order = big_endian ? 2 : 1;
    for (const int vertex : {0, 1, 2}) {
        append_raw(out, vertex == 1 ? 10.5 : 0.0, order);
        append_raw(out, vertex == 2 ? 2.5F : 0.0F, order);
        append_raw(out, static_cast<std::int16_t>(-7), order);
        append_raw(out, std::uint8_t{1});
        append_raw(out, 9.0F, order);
    }
    append_raw(out, std::uint8_t{255});
    append_raw(out, std::uint16_t{3}, order);
    for (const std::uint32_t vertex : {0U, 1U, 2U}) {
        append_raw(out, vertex, order);
    }
    return out;
}

void expect_one_triangle(const PolygonSoup& soup) {
    ASSERT_EQ(soup.positions.size(), 3U);
    EXPECT_EQ(soup.positions[0], Eigen::Vector3d(0, 0, 0));
    EXPECT_EQ(soup.positions[1], Eigen::Vector3d(1, 0, 0));
    EXPECT_EQ(soup.positions[2], Eigen::Vector3d(0, 1, 0));
    EXPECT_THAT(soup.corners, ElementsAre(0, 1, 2));
    EXPECT_THAT(soup.face_offsets, ElementsAre(0, 3));
}

TEST(Readers, EachFormatGivesTheSameTriangle) {
    expect_one_triangle(read_text(kTriangleObj, "a.obj"));
    expect_one_triangle(read_text(kTriangleOff, "a.OFF"));
    expect_one_triangle(read_text(kTrianglePly, "a.Ply"));
    expect_one_triangle(read_text(kTriangleStl, "a.stl"));
    expect_one_triangle(read_text(binary_stl(1, 1, "made by hand"), "a.STL"));
}

TEST(Readers, AnyLineEndReadsTheSame) {
    for (const std::string_view end : {"\r\n", "\r"}) {
        for (const auto& [text, name] :
             {std::pair(kTriangleObj, "a.obj"), std::pair(kTriangleOff, "a.off"),
              std::pair(kTrianglePly, "a.ply"), std::pair(kTriangleStl, "a.stl")}) {
            std::string converted;
            for (const char letter : text) {
                letter == '\n' ? converted.append(end) : converted.append(1, letter);
            }
            SCOPED_TRACE(name);
            expect_one_triangle(read_text(converted, name));
        }
    }
}

TEST(Readers, AnyTruncationIsRefusedOrKeepsTheWholeMesh) {
    const std::string stl = binary_stl(1, 1, "x");
    const std::string ply = binary_ply(false);
    for (const auto& [whole, name] :
         {std::pair(kTriangleObj, "a.obj"), std::pair(kTriangleOff, "a.off"),
          std::pair(kTrianglePly, "a.ply"), std::pair(kTriangleStl, "a.stl"),
          std::pair(std::string_view(stl), "b.stl"), std::pair(std::string_view(ply), "b.ply")}) {
        const PolygonSoup expected = read_text(whole, name);
        for (std::size_t size = 0; size < whole.size(); ++size) {
            try {
                const PolygonSoup soup = read_text(whole.substr(0, size), name);
                EXPECT_EQ(soup.corners, expected.corners) << name << " cut at " << size;
            } catch (const Error& error) {
                EXPECT_EQ(error.kind(), ErrorKind::BadFile);
            }
        }
    }
}

TEST(Readers, WhatIsWrittenReadsBackExactly) {
    TriangleMesh mesh;
    mesh.positions = {{0.1, 1.0 / 3.0, -1e-17}, {1e9 + 0.123456789, 0, 0}, {5e-324, 1, 2}};
    mesh.triangles = {{0, 1, 2}};
    for (const auto& [text, name] :
         {std::pair(write_obj(mesh), "a.obj"), std::pair(write_off(mesh), "a.off"),
          std::pair(write_ply(mesh), "a.ply")}) {
        const PolygonSoup soup = read_text(text, name);
        EXPECT_EQ(soup.positions, mesh.positions) << name;
        EXPECT_THAT(soup.corners, ElementsAre(0, 1, 2)) << name;
    }
}

TEST(Readers, AnUnknownEndingIsRefused) {
    EXPECT_EQ(code_of("x", "a.3ds"), "unknown-format");
    EXPECT_EQ(code_of("x", "obj"), "unknown-format");
}

TEST(ObjReader, TakesNegativeIndicesContinuedLinesAndSlashes) {
    const PolygonSoup soup =
        read_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3/1/1 \\\n 2//5 -1/7 # a comment\n", "a.obj");
    EXPECT_THAT(soup.corners, ElementsAre(0, 1, 2));
}

TEST(ObjReader, TakesAFaceBeforeItsVertices) {
    EXPECT_EQ(read_text("f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n", "a.obj").face_count(), 1U);
}

TEST(ObjReader, NamesTheLineOfTheDefect) {
    const auto message = [](std::string_view text) {
        return std::string(error_of([&] { read_text(text, "a.obj"); }).what());
    };
    EXPECT_THAT(message("v 0 0 0\nv 1 nan 0\n"), HasSubstr("line 2: non-finite"));
    EXPECT_THAT(message("v 0 0 0\nv 1 1e999 0\n"), HasSubstr("line 2: non-finite"));
    EXPECT_THAT(message("v 0 0 0\n\nv 1 3.1+e2 0\n"), HasSubstr("line 3: \"3.1+e2\""));
    EXPECT_THAT(message("v 0 0\n"), HasSubstr("line 1:"));
    EXPECT_THAT(message("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2\n"), HasSubstr("line 4: a face needs"));
    EXPECT_THAT(message("v 0 0 0\nf 1 1 9\nf 1 1 1\n"), HasSubstr("line 2: index out of range"));
    EXPECT_THAT(message("v 0 0 0\nf 0 1 1\n"), HasSubstr("line 2: index out of range: 0"));
    EXPECT_THAT(message("v 0 0 0\nf -2 1 1\n"), HasSubstr("line 2: index out of range: -2"));
}

TEST(ObjReader, MessagesStayAsciiForAnyBytes) {
    const Error error = error_of([] { read_text("v 0 0 \xE9\xFF\x01\n", "a.obj"); });
    for (const char letter : std::string_view(error.what())) {
        EXPECT_TRUE(letter >= ' ' && letter <= '~');
    }
}

TEST(OffReader, TakesEveryKeywordAndPassesColoursOver) {
    for (const char* keyword : {"OFF", "COFF", "NOFF", "STOFF", "CNOFF", "STCNOFF"}) {
        const std::string text = std::string(keyword) +
                                 " # by hand\n\n3 1\n0 0 0 192 192 192 255\n1 0 0 1 2 3 4\n# here\n"
                                 "0 1 0 9 9 9 9 # there\n3 0 1 2 0.5 0.5 0.5\n";
        expect_one_triangle(read_text(text, "a.off"));
    }
    expect_one_triangle(read_text("OFF3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2", "a.off"));
    expect_one_triangle(read_text("3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2", "a.off"));
}

TEST(OffReader, RefusesCountsThatDontFitTheFile) {
    EXPECT_EQ(code_of("OFF\n353535235358 6 0\n0 0 0\n", "a.off"), "count-exceeds-file");
    EXPECT_EQ(code_of("OFF\n-3 1 0\n0 0 0\n", "a.off"), "bad-header");
    EXPECT_EQ(code_of("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 0 1 2\n", "a.off"),
              "bad-header");
    EXPECT_EQ(code_of("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", "a.off"), "index-out-of-range");
    EXPECT_EQ(code_of("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n4 0 1 2\n", "a.off"), "bad-index");
}

TEST(OffReader, RefusesWhatItDoesntSpeak) {
    EXPECT_EQ(code_of("OFF BINARY\nabc", "a.off"), "not-supported");
    EXPECT_EQ(code_of("4OFF\n3 1 0\n", "a.off"), "not-supported");
    EXPECT_EQ(code_of("nOFF\n3 1 0\n", "a.off"), "not-supported");
}

TEST(PlyReader, ReadsBothByteOrdersAndPassesOverOtherProperties) {
    for (const bool big_endian : {false, true}) {
        const PolygonSoup soup = read_text(binary_ply(big_endian), "a.ply");
        ASSERT_EQ(soup.positions.size(), 3U);
        EXPECT_EQ(soup.positions[1], Eigen::Vector3d(10.5, 0, -7));
        EXPECT_EQ(soup.positions[2], Eigen::Vector3d(0, 2.5, -7));
        EXPECT_THAT(soup.corners, ElementsAre(0, 1, 2));
    }
}

TEST(PlyReader, RefusesHeadersThatDeclareNoMesh) {
    const auto with = [](std::string_view from, std::string_view to) {
        std::string text(kTrianglePly);
        text.replace(text.find(from), from.size(), to);
        return code_of(text, "a.ply");
    };
    EXPECT_EQ(with("element vertex 3", "element vertex 4294967295"), "count-exceeds-file");
    EXPECT_EQ(with("element face 1", "element face 9999"), "count-exceeds-file");
    EXPECT_EQ(with("element face 1", "element face -1"), "bad-header");
    EXPECT_EQ(with("property float z\n", ""), "bad-header");
    EXPECT_EQ(with("property float z", "property list uchar float z"), "bad-header");
    EXPECT_EQ(with("float x", "quaternion x"), "bad-header");
    EXPECT_EQ(with("vertex_indices", "something"), "bad-header");
    EXPECT_EQ(with("end_header\n", ""), "bad-header");
    EXPECT_EQ(with("ply\n", "plx\n"), "bad-header");
    EXPECT_EQ(with("3 0 1 2", "3 0 1 3"), "index-out-of-range");
    EXPECT_EQ(with("3 0 1 2", "3 0 1 1.5"), "index-out-of-range");
    EXPECT_EQ(with("3 0 1 2", "2 0 1  "), "bad-face");
    EXPECT_EQ(with("1 0 0", "1 inf 0"), "non-finite");
    EXPECT_EQ(with("3 0 1 2\n", "3 0 1 2\n3 0 1 2\n"), "bad-header");
}

TEST(StlReader, ASolidHeaderDoesNotMakeABinaryFileText) {
    EXPECT_EQ(read_text(binary_stl(2, 2, "solid as SolidWorks writes it"), "a.stl").face_count(),
              2U);
}

TEST(StlReader, RefusesCountsThatDontFitTheFile) {
    EXPECT_EQ(code_of(binary_stl(3, 2, "x"), "a.stl"), "truncated");
    EXPECT_EQ(code_of(binary_stl(0xFFFFFFFF, 2, "x"), "a.stl"), "truncated");
    EXPECT_EQ(code_of(binary_stl(3, 2, "solid x"), "a.stl"), "truncated");
    EXPECT_EQ(code_of(binary_stl(1, 2, "x"), "a.stl"), "bad-header");
    EXPECT_EQ(code_of(binary_stl(0, 0, "x"), "a.stl"), "no-faces");
}

TEST(StlReader, RefusesTextThatEndsEarlyOrStrays) {
    const std::string_view text = kTriangleStl;
    EXPECT_EQ(code_of(text.substr(0, text.find("endsolid")), "a.stl"), "truncated");
    EXPECT_EQ(code_of(text.substr(0, text.find("endloop")), "a.stl"), "truncated");
    EXPECT_EQ(code_of("solid a\nfacet\nouter loop\nvertex 0 0 0\nendloop\n", "a.stl"),
              "bad-statement");
    EXPECT_EQ(code_of("solid a\nfacet\nouter loop\nvertex 0 nan 0\n", "a.stl"), "non-finite");
}

TEST(Readers, AMeshWithoutAnEndingIsToldByItsBytes) {
    const auto name = [](std::string_view given, std::string_view text) {
        return mesh_file_name(given, test::bytes_of(text));
    };
    EXPECT_EQ(name("a.OFF", "v 0 0 0\n"), "a.OFF");  // What is said is not guessed.
    EXPECT_EQ(name("my head", kTriangleObj), "my head.obj");
    EXPECT_EQ(name("head 1.2", "# made by hand\n\nOFF\n3 1 0\n"), "head 1.2.off");
    EXPECT_EQ(name("", "ply\nformat ascii 1.0\n"), ".ply");
    EXPECT_EQ(name("a", kTriangleStl), "a.stl");
    EXPECT_EQ(name("a", binary_stl(2, 2, "v")), "a.stl");
    EXPECT_EQ(name("a", "hello"), "a");
    EXPECT_EQ(name("a", ""), "a");
    EXPECT_EQ(name("a", std::string(200'000, 'v')), "a");
}

TEST(Readers, LimitsAreKept) {
    const ReadLimits few_triangles{.max_triangles = 1};
    const auto code = [](std::string_view text, std::string_view name, const ReadLimits& limits) {
        return error_of([&] { read_mesh(test::bytes_of(text), name, limits); }).code();
    };
    EXPECT_EQ(code("v 0 0 0\nf 1 1 1\nf 1 1 1\n", "a.obj", few_triangles), "too-large");
    EXPECT_EQ(code("OFF\n1 1 0\n0 0 0\n4 0 0 0 0\n", "a.off", few_triangles), "too-large");
    EXPECT_EQ(code(binary_stl(2, 2, "x"), "a.stl", few_triangles), "too-large");
    EXPECT_EQ(code(kTriangleObj, "a.obj", {.max_bytes = 10}), "too-large");
    EXPECT_EQ(code(kTriangleObj, "a.obj", {.max_line_bytes = 5}), "line-too-long");
}

// ---- The shared collections

const std::filesystem::path kShared = LEAFCUTTER_SHARED_DIR;

TEST(SharedMeshes, HaveTheirKnownTopology) {
    const auto folder = kShared / "data/meshes";
    if (!std::filesystem::exists(folder / "meshes.json")) {
        GTEST_SKIP() << "no shared data";
    }
    for (const auto& known : nlohmann::json::parse(test::read_file(folder / "meshes.json"))) {
        const auto name = known.at("file").get<std::string>();
        SCOPED_TRACE(name);
        const RepairedMesh repaired = repair(read_text(test::read_file(folder / name), name));
        const Topology topology = analyse_topology(repaired.mesh);
        EXPECT_EQ(topology.vertices,
                  known.at("V").get<int>() - known.at("unreferenced").get<int>());
        EXPECT_EQ(topology.faces, known.at("F").get<int>());
        EXPECT_EQ(topology.edges, known.at("E").get<int>());
        EXPECT_EQ(topology.components, known.at("components").get<int>());
        EXPECT_EQ(static_cast<int>(topology.boundary_loops.size()),
                  known.at("boundary_loops").get<int>());
        EXPECT_EQ(topology.genus, known.at("genus").get<int>());
        EXPECT_EQ(repaired.report.welded_vertices, 0U);
        EXPECT_EQ(repaired.report.faces_reoriented, 0U);
    }
}

TEST(SharedBadFiles, AreAnsweredAsExpected) {
    const auto folder = kShared / "data/bad";
    if (!std::filesystem::exists(folder / "expected.json")) {
        GTEST_SKIP() << "no shared data";
    }
    for (const auto& entry : nlohmann::json::parse(test::read_file(folder / "expected.json"))) {
        const auto name = entry.at("file").get<std::string>();
        const auto expect = entry.at("expect").get<std::string>();
        SCOPED_TRACE(name);
        std::string answer = "accept";
        try {
            const RepairedMesh repaired = repair(read_text(test::read_file(folder / name), name));
            EXPECT_GT(analyse_topology(repaired.mesh).faces, 0);
        } catch (const Error& error) {
            answer = "reject";
            EXPECT_STRNE(error.what(), "");
        }
        if (expect != "either") {
            EXPECT_EQ(answer, expect == "reject" ? "reject" : "accept");
        }
    }
}

}  // namespace
}  // namespace leafcutter::geometry
