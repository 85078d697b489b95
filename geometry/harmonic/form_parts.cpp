#include "geometry/harmonic/form_parts.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <queue>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "geometry/disjoint_sets.h"
#include "geometry/error.h"

namespace leafcutter::geometry {
namespace {

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

std::uint32_t id(int index) {
    return static_cast<std::uint32_t>(index);
}

[[noreturn]] void fail(const std::string& what) {
    throw Error(ErrorKind::SelfCheck, "one-form",
                "one-form, parts: " + what + "; remesh the model, or choose foliation.mode pants");
}

enum class Side { Bottom, Top, Flank };

// The boundary of one part, before its vertices have names of their own.
struct Outline {
    std::vector<int> walk;    // Half-edges on cuts and loops, in order, the part to the left.
    std::vector<Side> sides;  // Per half-edge.
    int first_bottom = 0;     // Where the source side begins in `walk`,
    int first_right = 0;      // and the others.
    int first_top = 0;
    int first_left = 0;
    double flux = 0.0;
};

bool is_border(const CutSurface& cut, int h) {
    return cut.cut[at(h)] != 0 || cut.surface.edges.twin_of(h) < 0;
}

Side side_of(const CutSurface& cut, int h) {
    const HalfEdges& edges = cut.surface.edges;
    if (edges.twin_of(h) >= 0) {
        return Side::Flank;
    }
    const unsigned lines =
        cut.surface.lines[at(edges.from_of(h))] & cut.surface.lines[at(edges.to_of(h))];
    if ((lines & SourceLoop) != 0) {
        return Side::Bottom;
    }
    return (lines & SinkLoop) != 0 ? Side::Top : Side::Flank;
}

std::vector<int> walk_border(const CutSurface& cut, int start) {
    const HalfEdges& edges = cut.surface.edges;
    std::vector<int> walk;
    int h = start;
    do {
        walk.push_back(h);
        h = HalfEdges::next(h);
        while (!is_border(cut, h)) {
            h = HalfEdges::next(edges.twin_of(h));
        }
    } while (h != start);
    return walk;
}

// Finds the four sides. Fails unless they are bottom, flank, top, flank.
Outline outline_from(const CutSurface& cut, int start) {
    Outline outline;
    outline.walk = walk_border(cut, start);
    for (const int h : outline.walk) {
        outline.sides.push_back(side_of(cut, h));
        if (outline.sides.back() == Side::Bottom) {
            outline.flux += cut.rise[at(h)];
        }
    }
    const std::size_t count = outline.sides.size();
    std::vector<std::size_t> begins;
    for (std::size_t i = 0; i < count; ++i) {
        if (outline.sides[i] != outline.sides[(i + count - 1) % count]) {
            begins.push_back(i);
        }
    }
    if (begins.size() != 4) {
        fail(fmt::format("a part has {} sides instead of 4", begins.size()));
    }
    std::size_t k = 0;
    while (k < 4 && outline.sides[begins[k]] != Side::Bottom) {
        ++k;
    }
    if (k == 4 || outline.sides[begins[(k + 2) % 4]] != Side::Top) {
        fail("a part does not run from a source to a sink");
    }
    const auto begin = [&](std::size_t side) { return static_cast<int>(begins[(k + side) % 4]); };
    outline.first_bottom = begin(0);
    outline.first_right = begin(1);
    outline.first_top = begin(2);
    outline.first_left = begin(3);
    return outline;
}

// Parts by the first border half-edge met on a source, and the part of each triangle.
struct Division {
    std::vector<int> part_of_triangle;
    std::vector<Outline> outlines;
};

Division divide(const CutSurface& cut) {
    const HalfEdges& edges = cut.surface.edges;
    DisjointSets sets(cut.surface.mesh.triangles.size());
    for (int h = 0; h < edges.size(); ++h) {
        if (!is_border(cut, h)) {
            sets.unite(id(h / 3), id(edges.twin_of(h) / 3));
        }
    }
    Division division;
    std::vector<int> part_of_set(cut.surface.mesh.triangles.size(), -1);
    std::vector<int> borders(cut.surface.mesh.triangles.size(), 0);  // Per set.
    for (int h = 0; h < edges.size(); ++h) {
        borders[sets.find(id(h / 3))] += is_border(cut, h) ? 1 : 0;
    }
    for (const std::vector<int>& walk : boundary_walks(edges)) {
        for (const int h : walk) {
            const std::uint32_t set = sets.find(id(h / 3));
            if (side_of(cut, h) != Side::Bottom || part_of_set[set] >= 0) {
                continue;
            }
            part_of_set[set] = static_cast<int>(division.outlines.size());
            division.outlines.push_back(outline_from(cut, h));
            if (static_cast<int>(division.outlines.back().walk.size()) != borders[set]) {
                fail("a part has a hole");
            }
        }
    }
    for (std::size_t t = 0; t < part_of_set.size(); ++t) {
        const int part = part_of_set[sets.find(static_cast<std::uint32_t>(t))];
        if (part < 0) {
            fail(fmt::format("triangle {} lies in a part without source", t));
        }
        division.part_of_triangle.push_back(part);
    }
    return division;
}

// A name for every corner, shared by the corners of one vertex on one side of all cuts.
DisjointSets join_corners(const CutSurface& cut) {
    const HalfEdges& edges = cut.surface.edges;
    DisjointSets corners(edges.from.size());
    for (int h = 0; h < edges.size(); ++h) {
        if (!is_border(cut, h)) {
            corners.unite(id(h), id(HalfEdges::next(edges.twin_of(h))));
        }
    }
    return corners;
}

void check_disk(const FormPart& part) {
    const int vertices = static_cast<int>(part.mesh.positions.size());
    const int border = static_cast<int>(part.loop.size());
    const int triangles = static_cast<int>(part.mesh.triangles.size());
    const int inner = (3 * triangles - border) / 2;
    if (vertices - inner - border + triangles != 1) {
        fail(fmt::format("a part has Euler characteristic {} instead of 1",
                         vertices - inner - border + triangles));
    }
}

}  // namespace

std::vector<FormPart> separate_parts(const CutSurface& cut) {
    const HalfEdges& edges = cut.surface.edges;
    const Division division = divide(cut);
    DisjointSets corners = join_corners(cut);
    std::vector<int> vertex_of_corner(edges.from.size(), -1);  // By representative.
    std::vector<FormPart> parts(division.outlines.size());
    for (int t = 0; t < edges.size() / 3; ++t) {
        FormPart& part = parts[at(division.part_of_triangle[at(t)])];
        std::array<int, 3> triangle{};
        for (int k = 0; k < 3; ++k) {
            int& name = vertex_of_corner[corners.find(id(3 * t + k))];
            if (name < 0) {
                const int v = edges.from_of(3 * t + k);
                name = static_cast<int>(part.mesh.positions.size());
                part.mesh.positions.push_back(cut.surface.mesh.positions[at(v)]);
                part.source_vertex.push_back(v);
            }
            triangle[at(k)] = name;
        }
        part.mesh.triangles.push_back(triangle);
        part.source_triangle.push_back(t);
    }
    for (std::size_t p = 0; p < parts.size(); ++p) {
        const Outline& outline = division.outlines[p];
        for (const int h : outline.walk) {
            parts[p].loop.push_back(vertex_of_corner[corners.find(id(h))]);
        }
        parts[p].loop_edge = outline.walk;
        parts[p].corners = {outline.first_bottom, outline.first_right, outline.first_top,
                            outline.first_left};
        parts[p].flux = outline.flux;
        check_disk(parts[p]);
    }
    return parts;
}

}  // namespace leafcutter::geometry
