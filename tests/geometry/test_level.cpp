// Levels of detail of a surface for the graph-valued map: what collapses and flips must keep, and
// that maps carried between levels stay in their homotopy class.

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <numbers>
#include <random>
#include <set>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "geometry/half_edges.h"
#include "geometry/harmonic/chart_surface.h"
#include "geometry/io/read_mesh.h"
#include "geometry/laplacian.h"
#include "geometry/mesh.h"
#include "geometry/pants/harmonic_map.h"
#include "geometry/pants/initial_map.h"
#include "geometry/pants/level.h"
#include "geometry/pants/reeb_graph.h"
#include "geometry/pants/slice.h"
#include "geometry/pants/split_long_edges.h"
#include "geometry/repair.h"
#include "geometry/samples.h"
#include "geometry/topology.h"
#include "tests/geometry/surfaces.h"

namespace leafcutter::geometry {
namespace {

using testing::at;

using Loops = std::vector<std::vector<int>>;

struct Lined {
    LinedSurface surface;
    Loops loops;  // Boundary, surface to the left.
};

int count_of(const TriangleMesh& mesh) {
    return static_cast<int>(mesh.positions.size());
}

VertexRings rings_of(const TriangleMesh& mesh) {
    return build_vertex_rings(build_half_edges(mesh.triangles, count_of(mesh)), count_of(mesh));
}

int euler_of(const TriangleMesh& mesh) {
    return count_of(mesh) - static_cast<int>(rings_of(mesh).edges.size()) +
           static_cast<int>(mesh.triangles.size());
}

// All boundary loops, each from its least vertex, in the order of these.
Loops boundary_loops(const TriangleMesh& mesh) {
    const HalfEdges edges = build_half_edges(mesh.triangles, count_of(mesh));
    std::map<int, int> next;
    for (int h = 0; h < edges.size(); ++h) {
        if (edges.twin_of(h) < 0) {
            EXPECT_TRUE(next.emplace(edges.from_of(h), edges.to_of(h)).second) << "pinched";
        }
    }
    Loops loops;
    while (!next.empty()) {
        loops.emplace_back();
        const int start = next.begin()->first;
        for (int v = start; next.count(v) > 0;) {
            loops.back().push_back(v);
            const int following = next.at(v);
            next.erase(v);
            v = following;
        }
    }
    return loops;
}

// With all edges between two boundary vertices split, as the solver makes it.
Lined lined(const TriangleMesh& mesh) {
    std::vector<std::uint8_t> on_boundary(mesh.positions.size(), 0);
    for (const std::vector<int>& loop : boundary_loops(mesh)) {
        for (const int v : loop) {
            on_boundary[at(v)] = 1;
        }
    }
    Lined out;
    out.surface.mesh = start_surface(mesh, std::move(on_boundary)).mesh;
    out.surface.line_of_vertex.assign(out.surface.mesh.positions.size(), -1);
    out.loops = boundary_loops(out.surface.mesh);
    for (std::size_t k = 0; k < out.loops.size(); ++k) {
        for (const int v : out.loops[k]) {
            out.surface.line_of_vertex[at(v)] = static_cast<int>(k);
        }
    }
    return out;
}

TriangleMesh without_unused(const TriangleMesh& mesh) {
    std::vector<int> fresh(mesh.positions.size(), -1);
    TriangleMesh out;
    for (auto t : mesh.triangles) {
        for (int& v : t) {
            int& name = fresh[at(v)];
            if (name < 0) {
                name = static_cast<int>(out.positions.size());
                out.positions.push_back(mesh.positions[at(v)]);
            }
            v = name;
        }
        out.triangles.push_back(t);
    }
    return out;
}

// A sphere without the triangles near three of its points.
TriangleMesh sphere_with_holes() {
    TriangleMesh mesh = make_sample("sphere", 6000);
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& p : mesh.positions) {
        centre += p / static_cast<double>(mesh.positions.size());
    }
    std::erase_if(mesh.triangles, [&](const std::array<int, 3>& t) {
        return std::any_of(t.begin(), t.end(), [&](int v) {
            const Eigen::Vector3d d = (mesh.positions[at(v)] - centre).normalized();
            return d.x() > 0.95 || d.y() > 0.95 || d.z() < -0.95;
        });
    });
    return without_unused(mesh);
}

TriangleMesh needles() {
    TriangleMesh mesh = make_sample("eight", 3000);
    std::minstd_rand random(7);
    testing::add_needles(mesh, 400, random);
    return mesh;
}

TriangleMesh shared_model(const char* file) {
    const std::filesystem::path path =
        std::filesystem::path(LEAFCUTTER_SHARED_DIR) / "data" / "meshes" / file;
    std::ifstream in(path, std::ios::binary);
    if (!in) {
        return {};
    }
    const std::vector<char> bytes((std::istreambuf_iterator<char>(in)), {});
    return to_triangle_mesh(repair(read_mesh(std::as_bytes(std::span(bytes)), file)).mesh);
}

struct Case {
    const char* name;
    TriangleMesh (*make)();
};

void PrintTo(const Case& one, std::ostream* out) {
    *out << one.name;
}

class Level : public ::testing::TestWithParam<Case> {
protected:
    void SetUp() override {
        const TriangleMesh mesh = GetParam().make();
        if (mesh.triangles.empty()) {
            GTEST_SKIP() << "no shared data";
        }
        whole_ = lined(mesh);
    }
    Lined whole_;
};

INSTANTIATE_TEST_SUITE_P(
    Surfaces,
    Level,
    ::testing::Values(Case{"eight", [] { return make_sample("eight", 6000); }},
                      Case{"doubletorus", [] { return make_sample("double-torus", 6000); }},
                      Case{"holes", sphere_with_holes},
                      Case{"needles", needles},
                      Case{"torus", [] { return testing::make_torus(40, 90, 0.3); }},
                      Case{"prism", [] { return testing::make_prism(40, 60, 1.0, 3.0); }},
                      Case{"fertility", [] { return shared_model("fertility.off"); }},
                      Case{"boot", [] { return shared_model("boot.obj"); }},
                      Case{"hand", [] { return shared_model("hand-6-boundaries.obj"); }}),
    [](const auto& tested) { return std::string(tested.param.name); });

std::pair<int, int> ends_of(const MeshEdge& edge) {
    return {std::min(edge.from, edge.to), std::max(edge.from, edge.to)};
}

std::set<std::pair<int, int>> vertex_pairs(const VertexRings& rings) {
    std::set<std::pair<int, int>> pairs;
    for (const MeshEdge& edge : rings.edges) {
        pairs.insert(ends_of(edge));
    }
    return pairs;
}

void expect_simplicial(const VertexRings& rings) {
    EXPECT_EQ(vertex_pairs(rings).size(), rings.edges.size());
    for (const MeshEdge& edge : rings.edges) {
        EXPECT_NE(edge.from, edge.to);
    }
}

int line_length(const LinedSurface& surface, int line) {
    return static_cast<int>(
        std::count(surface.line_of_vertex.begin(), surface.line_of_vertex.end(), line));
}

// Boundary edges apart, no edge joins two boundary vertices.
void expect_no_chords(const LinedSurface& surface, const VertexRings& rings) {
    const HalfEdges edges = build_half_edges(surface.mesh.triangles, count_of(surface.mesh));
    for (const MeshEdge& edge : rings.edges) {
        if (edges.twin_of(edge.half_edge) >= 0) {
            EXPECT_FALSE(surface.line_of_vertex[at(edge.from)] >= 0 &&
                         surface.line_of_vertex[at(edge.to)] >= 0);
        }
    }
}

// The same surface with flipped triangles.
LinedSurface flipped_surface(const LinedSurface& surface, const FlippedSurface& flipped) {
    LinedSurface out = surface;
    for (std::size_t h = 0; h < flipped.half_edges.from.size(); ++h) {
        out.mesh.triangles[h / 3][h % 3] = flipped.half_edges.from[h];
    }
    return out;
}

void expect_coarser(const Lined& fine, const CoarsenOptions& options) {
    const Coarser coarser = coarsen(fine.surface, options, {});
    const TriangleMesh& mesh = coarser.surface.mesh;
    const VertexRings fine_rings = rings_of(fine.surface.mesh);
    const VertexRings rings = rings_of(mesh);
    EXPECT_EQ(euler_of(mesh), euler_of(fine.surface.mesh));
    expect_simplicial(rings);
    expect_no_chords(coarser.surface, rings);
    EXPECT_LE(mesh.positions.size(), options.target_vertices + 5 * options.target_vertices / 100);

    const Loops loops = boundary_loops(mesh);
    ASSERT_EQ(loops.size(), fine.loops.size());
    for (const std::vector<int>& loop : loops) {
        const int line = coarser.surface.line_of_vertex[at(loop.front())];
        for (const int v : loop) {
            EXPECT_EQ(coarser.surface.line_of_vertex[at(v)], line);
        }
        EXPECT_EQ(line_length(coarser.surface, line), static_cast<int>(loop.size()));
        EXPECT_GE(static_cast<int>(loop.size()),
                  std::min(options.least_line_vertices, line_length(fine.surface, line)));
    }

    ASSERT_EQ(coarser.representative.size(), fine.surface.mesh.positions.size());
    const auto pairs = vertex_pairs(rings);
    for (const MeshEdge& edge : fine_rings.edges) {
        const int from = coarser.representative[at(edge.from)];
        const int to = coarser.representative[at(edge.to)];
        EXPECT_TRUE(from == to || pairs.count(std::minmax(from, to)) > 0);
    }
    for (std::size_t v = 0; v < coarser.representative.size(); ++v) {
        const int kept = coarser.representative[v];
        if (fine.surface.line_of_vertex[v] >= 0) {
            EXPECT_EQ(coarser.surface.line_of_vertex[at(kept)], fine.surface.line_of_vertex[v]);
        }
    }
}

TEST_P(Level, CollapseKeepsTopologyAndLines) {
    const std::size_t count = whole_.surface.mesh.positions.size();
    for (const std::size_t target : {count / 4, count / 12}) {
        SCOPED_TRACE(target);
        expect_coarser(whole_, {.target_vertices = target, .least_line_vertices = 16});
    }
}

TEST_P(Level, CollapseStartsFromFlippedTrianglesToo) {
    const FlippedSurface flipped = flip_to_delaunay(whole_.surface, rings_of(whole_.surface.mesh));
    whole_.surface = flipped_surface(whole_.surface, flipped);
    const std::size_t count = whole_.surface.mesh.positions.size();
    expect_coarser(whole_, {.target_vertices = count / 4, .least_line_vertices = 16});
}

TEST_P(Level, FlipsEndDelaunayAndSimplicial) {
    const VertexRings rings = rings_of(whole_.surface.mesh);
    const FlippedSurface flipped = flip_to_delaunay(whole_.surface, rings);
    const LinedSurface after = flipped_surface(whole_.surface, flipped);
    const VertexRings again = rings_of(after.mesh);
    EXPECT_EQ(euler_of(after.mesh), euler_of(whole_.surface.mesh));
    expect_simplicial(flipped.rings);
    expect_no_chords(after, again);
    EXPECT_EQ(vertex_pairs(flipped.rings), vertex_pairs(again));
    EXPECT_EQ(again.begin, flipped.rings.begin);
    std::set<int> touched(flipped.flips.begin(), flipped.flips.end());
    for (std::size_t e = 0; e < rings.edges.size(); ++e) {
        EXPECT_GT(flipped.weights[e], 0.0);
        if (touched.count(static_cast<int>(e)) == 0) {
            EXPECT_EQ(ends_of(rings.edges[e]), ends_of(flipped.rings.edges[e]));
        }
    }
    double area = 0.0;
    for (const double a : flipped.area) {
        area += a;
    }
    double expected = 0.0;
    for (const auto& t : whole_.surface.mesh.triangles) {
        const Eigen::Vector3d& p = whole_.surface.mesh.positions[at(t[0])];
        expected += 0.5 * (whole_.surface.mesh.positions[at(t[1])] - p)
                              .cross(whole_.surface.mesh.positions[at(t[2])] - p)
                              .norm();
    }
    EXPECT_NEAR(area / expected, 1.0, 1e-3);
    EXPECT_LE(flipped.forced_weights, static_cast<int>(rings.edges.size() / 500));
}

// Whether the vertices of a line are joined in one cycle, and to no others of it.
bool is_cycle(const LinedSurface& surface, const VertexRings& rings, int line) {
    const std::vector<int>& lines = surface.line_of_vertex;
    const auto first = std::find(lines.begin(), lines.end(), line);
    const int start = static_cast<int>(first - lines.begin());
    int steps = 0;
    int before = -1;
    int v = start;
    do {
        std::vector<int> along;
        for (int k = rings.begin[at(v)]; k < rings.begin[at(v) + 1]; ++k) {
            const int w = rings.slots[at(k)].neighbour;
            if (lines[at(w)] == line) {
                along.push_back(w);
            }
        }
        if (along.size() != 2) {
            return false;
        }
        const int next = along[0] == before ? along[1] : along[0];
        before = std::exchange(v, next);
    } while (++steps < static_cast<int>(lines.size()) && v != start);
    return v == start && steps == line_length(surface, line);
}

TEST(LinesInside, SurviveCollapseAndFlips) {
    // Two closed lines round the tube of a torus.
    constexpr int kAcross = 40;
    constexpr int kAlong = 90;
    LinedSurface surface;
    surface.mesh = testing::make_torus(kAcross, kAlong, 0.4);
    std::minstd_rand random(3);
    testing::jitter(surface.mesh, 0.02, random);
    surface.line_of_vertex.assign(surface.mesh.positions.size(), -1);
    for (int k = 0; k < kAcross; ++k) {
        surface.line_of_vertex[at(k)] = 0;
        surface.line_of_vertex[at(45 * kAcross + k)] = 1;
    }
    for (const std::size_t target : {1500U, 600U, 150U}) {
        const FlippedSurface flipped = flip_to_delaunay(surface, rings_of(surface.mesh));
        EXPECT_FALSE(flipped.flips.empty());
        surface = flipped_surface(surface, flipped);
        for (const int line : {0, 1}) {
            EXPECT_TRUE(is_cycle(surface, flipped.rings, line));
        }
        surface =
            coarsen(surface, {.target_vertices = target, .least_line_vertices = 10}, {}).surface;
        EXPECT_EQ(surface.mesh.positions.size(), target);
        const VertexRings rings = rings_of(surface.mesh);
        for (const int line : {0, 1}) {
            EXPECT_TRUE(is_cycle(surface, rings, line));
            EXPECT_GE(line_length(surface, line), 10);
        }
    }
    EXPECT_LT(line_length(surface, 0), kAcross);
}

TEST(Collapse, IsStoppedOnRequest) {
    LinedSurface surface;
    surface.mesh = testing::make_torus(100, 200, 0.4);
    surface.line_of_vertex.assign(surface.mesh.positions.size(), -1);
    std::stop_source source;
    source.request_stop();
    Context context;
    context.stop = source.get_token();
    EXPECT_THROW(coarsen(surface, {.target_vertices = 100}, context), Cancelled);
}

// --- maps -------------------------------------------------------------------------------------

// A surface with its flipped triangles.
struct Flat {
    LinedSurface surface;
    VertexRings rings;
    FlippedSurface flipped;
};

Flat flat(LinedSurface surface) {
    Flat out{std::move(surface), {}, {}};
    out.rings = rings_of(out.surface.mesh);
    out.flipped = flip_to_delaunay(out.surface, out.rings);
    return out;
}

// A first map of the surface as it is, from the Reeb graph of a coordinate.
GraphMap first_map(const LinedSurface& surface, int axis) {
    std::vector<double> values;
    for (const Eigen::Vector3d& p : surface.mesh.positions) {
        values.push_back(p[axis]);
    }
    const Loops loops = boundary_loops(surface.mesh);
    std::vector<char> low(loops.size(), 0);
    if (!loops.empty()) {
        low.front() = 1;
    }
    const ReebGraph reeb = build_reeb_graph(surface.mesh.triangles, values, loops, low);
    return initial_map(reeb, rings_of(surface.mesh), loops);
}

std::vector<double> weights_of(const TriangleMesh& mesh) {
    std::vector<double> weights;
    for (const WeightedEdge& edge :
         positive_edges(mesh, build_half_edges(mesh.triangles, count_of(mesh)), 1e-3)) {
        weights.push_back(edge.weight);
    }
    return weights;
}

double solve(GraphMap& map, const VertexRings& rings, const std::vector<double>& weights) {
    return solve_harmonic_map(map, rings, weights, MapStart::Cold, {}).energy;
}

// Carries a map forwards to the flipped surface: the flips that are taken back are the flips back.
void carry_forwards(GraphMap& map, const Flat& flat) {
    FlippedSurface before;
    before.rings = flat.rings;
    before.flips.assign(flat.flipped.flips.rbegin(), flat.flipped.flips.rend());
    undo_flips(map, before, flat.surface, flat.flipped.rings);
}

// The words round every triangle are those of three points of a tree: no one or both of two sides
// pass a node, and no side is longer than the others together.
void expect_tree(const GraphMap& map, const VertexRings& rings) {
    for (std::size_t h = 0; h < rings.edge_of_half_edge.size(); h += 3) {
        std::array<double, 3> side{};
        int cut = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            const int e = rings.edge_of_half_edge[h + k];
            const MeshEdge& edge = rings.edges[at(e)];
            const Word& word = map.words[at(e)];
            ASSERT_NE(word.size(), 1U);
            if (!word.empty()) {
                EXPECT_EQ(edge_of(word.front()), map.graph_edge[at(edge.from)]);
                EXPECT_EQ(edge_of(word.back()), map.graph_edge[at(edge.to)]);
            }
            cut += word.empty() ? 0 : 1;
            side[k] = map.distance(edge.from, edge.to, word);
        }
        EXPECT_NE(cut, 1) << h / 3;
        for (std::size_t k = 0; k < 3; ++k) {
            EXPECT_LE(side[k], side[(k + 1) % 3] + side[(k + 2) % 3] + 1e-9) << h / 3;
        }
    }
}

// A fine surface and one of a quarter of its vertices, with a first map of the coarse one.
struct TwoLevels {
    Flat fine;
    Flat coarse;
    std::vector<int> representative;
    GraphMap first;
};

TwoLevels two_levels(const Lined& whole, int axis) {
    constexpr std::size_t kFine = 6000;
    LinedSurface start = whole.surface;
    if (start.mesh.positions.size() > kFine) {
        start = coarsen(start, {.target_vertices = kFine}, {}).surface;
    }
    TwoLevels out;
    out.fine = flat(std::move(start));
    const std::size_t count = out.fine.surface.mesh.positions.size();
    Coarser coarser = coarsen(flipped_surface(out.fine.surface, out.fine.flipped),
                              {.target_vertices = std::max<std::size_t>(count / 4, 1200)}, {});
    out.coarse = flat(std::move(coarser.surface));
    out.representative = std::move(coarser.representative);
    out.first = first_map(out.coarse.surface, axis);
    return out;
}

double refined_energy(const GraphMap& coarse, const TwoLevels& levels) {
    const VertexRings& rings = levels.fine.flipped.rings;
    GraphMap map = prolong(coarse, levels.coarse.rings, levels.representative, rings);
    EXPECT_EQ(std::count(map.fixed.begin(), map.fixed.end(), 1),
              std::count_if(levels.fine.surface.line_of_vertex.begin(),
                            levels.fine.surface.line_of_vertex.end(),
                            [](int line) { return line >= 0; }));
    expect_tree(map, rings);
    return solve(map, rings, levels.fine.flipped.weights);
}

class MapLevel : public Level {};
class CutLevel : public Level {};

// Boot, of genus 12, has too many cylinders for a coarse level as small as this test's: its first
// map is only good for cutting.
INSTANTIATE_TEST_SUITE_P(Surfaces,
                         CutLevel,
                         ::testing::Values(Case{"boot", [] { return shared_model("boot.obj"); }}),
                         [](const auto& tested) { return std::string(tested.param.name); });

INSTANTIATE_TEST_SUITE_P(
    Surfaces,
    MapLevel,
    ::testing::Values(Case{"eight", [] { return make_sample("eight", 6000); }},
                      Case{"doubletorus", [] { return make_sample("double-torus", 6000); }},
                      Case{"holes", sphere_with_holes},
                      Case{"needles", needles},
                      Case{"fertility", [] { return shared_model("fertility.off"); }},
                      Case{"hand", [] { return shared_model("hand-6-boundaries.obj"); }}),
    [](const auto& tested) { return std::string(tested.param.name); });

// The energy at the minimum tells the class: it must be the same whichever way a first map is
// carried to the fine surface.
TEST_P(MapLevel, KeepsItsClassOnAllWaysToTheFineSurface) {
    for (const int axis : {0, 2}) {
        SCOPED_TRACE(axis);
        const TwoLevels levels = two_levels(whole_, axis);
        const Flat& coarse = levels.coarse;
        const double direct = refined_energy(levels.first, levels);

        GraphMap map = levels.first;
        solve(map, coarse.rings, weights_of(coarse.surface.mesh));
        EXPECT_NEAR(refined_energy(map, levels) / direct, 1.0, 1e-9);

        carry_forwards(map, coarse);
        expect_tree(map, coarse.flipped.rings);
        const double energy = solve(map, coarse.flipped.rings, coarse.flipped.weights);
        expect_tree(map, coarse.flipped.rings);
        undo_flips(map, coarse.flipped, coarse.surface, coarse.rings);
        expect_tree(map, coarse.rings);
        EXPECT_NEAR(refined_energy(map, levels) / direct, 1.0, 1e-9);

        carry_forwards(map, coarse);
        EXPECT_NEAR(map_energy(map, coarse.flipped.rings, coarse.flipped.weights) / energy, 1.0,
                    1e-12);
    }
}

void expect_annuli(const Lined& whole) {
    const TwoLevels levels = two_levels(whole, 2);
    GraphMap map = prolong(levels.first, levels.coarse.rings, levels.representative,
                           levels.fine.flipped.rings);
    solve(map, levels.fine.flipped.rings, levels.fine.flipped.weights);
    undo_flips(map, levels.fine.flipped, levels.fine.surface, levels.fine.rings);
    expect_tree(map, levels.fine.rings);
    TriangleMesh mesh = levels.fine.surface.mesh;
    VertexRings rings = levels.fine.rings;
    while (split_long_edges(mesh, rings, map) > 0) {
    }
    const Sliced sliced = slice_surface(mesh, rings, map);  // Throws where a piece is no annulus.
    const int loops = static_cast<int>(whole.loops.size());
    const int genus = (2 - loops - euler_of(mesh)) / 2;
    EXPECT_EQ(static_cast<int>(sliced.pieces.size()), 3 * genus - 3 + 2 * loops);
}

TEST_P(MapLevel, IsCutIntoAnnuliAfterFlipsAreUndone) {
    expect_annuli(whole_);
}

TEST_P(CutLevel, IsCutIntoAnnuliAfterFlipsAreUndone) {
    expect_annuli(whole_);
}

// The word of edge 1-3 after the edge 0-4 of `triangles` was flipped to it, on a map that puts
// vertices 0 and 4 on the first edge of a path of two, all others on the second.
Word word_after_flip(const std::vector<std::array<int, 3>>& before,
                     const std::vector<std::array<int, 3>>& after) {
    const VertexRings target = build_vertex_rings(build_half_edges(after, 5), 5);
    std::map<std::pair<int, int>, int> number;
    for (std::size_t e = 0; e < target.edges.size(); ++e) {
        number[ends_of(target.edges[e])] = static_cast<int>(e);
    }
    const int flipped_edge = number.at({1, 3});
    number[{0, 4}] = flipped_edge;
    FlippedSurface flipped;
    flipped.half_edges = build_half_edges(before, 5);
    std::vector<int> numbers;
    for (int h = 0; h < flipped.half_edges.size(); ++h) {
        numbers.push_back(
            number.at(std::minmax(flipped.half_edges.from_of(h), flipped.half_edges.to_of(h))));
    }
    flipped.rings = build_vertex_rings(flipped.half_edges, 5, numbers);
    flipped.flips = {flipped_edge};
    GraphMap map;
    map.graph = {3, {{0, 1, 1.0}, {1, 2, 1.0}}};
    map.graph_edge = {0, 1, 1, 1, 0};
    map.t = {0.9, 0.1, 0.2, 0.1, 0.5};
    map.fixed.assign(5, 0);
    for (const MeshEdge& edge : flipped.rings.edges) {
        const int from = map.graph_edge[at(edge.from)];
        const int to = map.graph_edge[at(edge.to)];
        map.words.push_back(from == to ? Word{} : from < to ? Word{0, 2} : Word{3, 1});
    }
    undo_flips(map, flipped, {}, target);
    return map.words[at(flipped_edge)];
}

TEST(UndoneFlip, GoesRoundAPeninsula) {
    // Vertex 0 has a whole ring 4, 1, 2, 3, of which 1, 2, 3 are in one leg: so are 1 and 3.
    EXPECT_EQ(word_after_flip({{0, 4, 1}, {0, 1, 2}, {0, 2, 3}, {0, 3, 4}},
                              {{1, 3, 4}, {3, 1, 0}, {0, 1, 2}, {0, 2, 3}}),
              Word{});
}

TEST(UndoneFlip, KeepsLegsApartThatAStripParts) {
    // Nothing beyond vertex 2 joins 1 and 3: the strip from 0 to 4 lies between them.
    const Word word =
        word_after_flip({{0, 4, 1}, {0, 3, 4}, {0, 1, 2}}, {{1, 3, 4}, {3, 1, 0}, {0, 1, 2}});
    EXPECT_EQ(word, (Word{3, 2}));
}

}  // namespace
}  // namespace leafcutter::geometry
