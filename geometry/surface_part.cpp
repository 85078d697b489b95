#include "geometry/surface_part.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "geometry/coarse_version.h"
#include "geometry/disjoint_sets.h"
#include "geometry/half_edges.h"
#include "geometry/harmonic/chart_surface.h"
#include "geometry/surface_measures.h"

namespace leafcutter::geometry {
namespace {

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

int euler_of(const TriangleMesh& mesh) {
    const int vertices = static_cast<int>(mesh.positions.size());
    const HalfEdges edges = build_half_edges(mesh.triangles, vertices);
    int count = 0;
    for (int h = 0; h < edges.size(); ++h) {
        count += edges.is_first(h) ? 1 : 0;
    }
    return vertices - count + static_cast<int>(mesh.triangles.size());
}

// The whole surface as if it were one part.
SurfacePart whole_surface(const TriangleMesh& mesh, const Topology& topology) {
    SurfacePart whole;
    whole.mesh = mesh;
    whole.source_vertex.resize(mesh.positions.size());
    std::iota(whole.source_vertex.begin(), whole.source_vertex.end(), 0);
    whole.loops = topology.boundary_loops;
    whole.loop_numbers.resize(whole.loops.size());
    std::iota(whole.loop_numbers.begin(), whole.loop_numbers.end(), 0);
    whole.euler = topology.euler;
    return whole;
}

SurfacePart with_opened(const SurfacePart& part, OpenedMesh opened) {
    SurfacePart out;
    out.mesh = std::move(opened.mesh);
    std::vector<int> place(part.mesh.positions.size(), -1);
    for (const int source : opened.source_vertex) {
        if (source >= 0) {
            place[at(source)] = static_cast<int>(out.source_vertex.size());
        }
        out.source_vertex.push_back(source < 0 ? -1 : part.source_vertex[at(source)]);
    }
    // Splitting may have put new vertices on the old loops.
    const HalfEdges edges =
        build_half_edges(out.mesh.triangles, static_cast<int>(out.mesh.positions.size()));
    for (const std::vector<int>& loop : part.loops) {
        const int start = place[at(loop.front())];
        out.loops.push_back(boundary_path(edges, start, start));
    }
    out.loop_numbers = part.loop_numbers;
    out.punctures = part.punctures;
    for (std::size_t k = 0; k < opened.punctures.size(); ++k) {
        out.loops.push_back(std::move(opened.loops[k]));
        out.loop_numbers.push_back(-1);
        const Puncture& puncture = opened.punctures[k];
        out.punctures.push_back({part.source_vertex[at(puncture.vertex)], puncture.radius});
    }
    out.removed_area = part.removed_area + opened.removed_area;
    out.euler = euler_of(out.mesh);
    return out;
}

// Per vertex of a triangle mesh the number of its part; parts in the order of their first
// triangles.
std::vector<int> number_parts(const TriangleMesh& mesh, int& parts) {
    DisjointSets sets(mesh.positions.size());
    for (const auto& t : mesh.triangles) {
        sets.unite(static_cast<std::uint32_t>(t[0]), static_cast<std::uint32_t>(t[1]));
        sets.unite(static_cast<std::uint32_t>(t[0]), static_cast<std::uint32_t>(t[2]));
    }
    std::vector<int> part_of_root(mesh.positions.size(), -1);
    parts = 0;
    for (const auto& t : mesh.triangles) {
        int& part = part_of_root[sets.find(static_cast<std::uint32_t>(t[0]))];
        part = part < 0 ? parts++ : part;
    }
    std::vector<int> part_of_vertex(mesh.positions.size(), -1);
    for (std::size_t v = 0; v < part_of_vertex.size(); ++v) {
        part_of_vertex[v] = part_of_root[sets.find(static_cast<std::uint32_t>(v))];
    }
    return part_of_vertex;
}

// Adds what the holes of each part have taken from it. The parts of the surface before are those
// after, as a hole takes no part whole and splits none.
void set_removed_areas(std::vector<SurfacePart>& parts, const TriangleMesh& before) {
    int count = 0;
    const std::vector<int> part_before = number_parts(before, count);
    std::vector<TriangleMesh> pieces(at(count));
    for (const auto& t : before.triangles) {
        pieces[at(part_before[at(t[0])])].triangles.push_back(t);
    }
    for (SurfacePart& part : parts) {
        const auto known = std::find_if(part.source_vertex.begin(), part.source_vertex.end(),
                                        [](int source) { return source >= 0; });
        if (part.punctures.empty() || known == part.source_vertex.end()) {
            continue;
        }
        TriangleMesh& piece = pieces[at(part_before[at(*known)])];
        piece.positions = before.positions;
        part.removed_area = surface_area(piece) - surface_area(part.mesh);
        piece.positions.clear();
    }
}

}  // namespace

std::vector<SurfacePart> split_into_parts(const TriangleMesh& mesh,
                                          const Topology& topology,
                                          std::span<const Puncture> given,
                                          const Context& context) {
    SurfacePart whole = whole_surface(mesh, topology);
    if (!given.empty()) {
        whole = with_opened(whole, open_punctures(mesh, given, context));
        std::iota(whole.loop_numbers.begin(), whole.loop_numbers.end(), 0);
    }
    if (topology.components == 1) {
        return {std::move(whole)};
    }
    int count = 0;
    const std::vector<int> part_of_vertex = number_parts(whole.mesh, count);
    std::vector<SurfacePart> parts(at(count));
    std::vector<int> place(part_of_vertex.size(), -1);
    for (std::size_t v = 0; v < place.size(); ++v) {
        if (part_of_vertex[v] < 0) {
            continue;
        }
        SurfacePart& part = parts[at(part_of_vertex[v])];
        place[v] = static_cast<int>(part.mesh.positions.size());
        part.mesh.positions.push_back(whole.mesh.positions[v]);
        part.source_vertex.push_back(whole.source_vertex[v]);
    }
    for (const auto& t : whole.mesh.triangles) {
        parts[at(part_of_vertex[at(t[0])])].mesh.triangles.push_back(
            {place[at(t[0])], place[at(t[1])], place[at(t[2])]});
    }
    const std::size_t holes = whole.punctures.size();
    for (std::size_t k = 0; k < whole.loops.size(); ++k) {
        SurfacePart& part = parts[at(part_of_vertex[at(whole.loops[k].front())])];
        std::vector<int>& loop = part.loops.emplace_back();
        for (const int v : whole.loops[k]) {
            loop.push_back(place[at(v)]);
        }
        part.loop_numbers.push_back(whole.loop_numbers[k]);
        if (k + holes >= whole.loops.size()) {
            part.punctures.push_back(whole.punctures[k + holes - whole.loops.size()]);
        }
    }
    for (SurfacePart& part : parts) {
        part.euler = euler_of(part.mesh);
    }
    set_removed_areas(parts, mesh);
    return parts;
}

SurfacePart with_holes(const SurfacePart& part,
                       std::span<const Puncture> punctures,
                       const Context& context) {
    return with_opened(part, open_punctures(part.mesh, punctures, context, PunctureFit::Shrink));
}

SurfacePart coarse_part(const SurfacePart& part, std::size_t most, const Context& context) {
    CoarseVersion coarse = coarse_version(part.mesh, most, context);
    SurfacePart out = part;
    std::vector<int> place(part.mesh.positions.size(), -1);
    out.source_vertex.clear();
    for (std::size_t v = 0; v < coarse.source_vertex.size(); ++v) {
        place[at(coarse.source_vertex[v])] = static_cast<int>(v);
        out.source_vertex.push_back(part.source_vertex[at(coarse.source_vertex[v])]);
    }
    out.mesh = std::move(coarse.mesh);
    const HalfEdges edges =
        build_half_edges(out.mesh.triangles, static_cast<int>(out.mesh.positions.size()));
    for (std::vector<int>& loop : out.loops) {
        const auto kept =
            std::find_if(loop.begin(), loop.end(), [&](int v) { return place[at(v)] >= 0; });
        const int start = place[at(*kept)];
        loop = boundary_path(edges, start, start);
    }
    return out;
}

FoliationMode natural_mode(const SurfacePart& part) {
    if (part.euler == 2) {
        return FoliationMode::SpherePillowcase;
    }
    if (part.euler < 0) {
        return FoliationMode::Pants;
    }
    if (part.euler == 1) {
        return FoliationMode::Disk;
    }
    return part.loops.empty() ? FoliationMode::Torus : FoliationMode::Annulus;
}

std::string describe(const SurfacePart& part) {
    switch (natural_mode(part)) {
        case FoliationMode::SpherePillowcase:
            return "a closed sphere";
        case FoliationMode::Disk:
            return "a disk";
        case FoliationMode::Annulus:
            return "an annulus";
        case FoliationMode::Torus:
            return "a torus";
        default:
            return fmt::format("a surface of genus {} with {} boundary loop{}", part.genus(),
                               part.loops.size(), part.loops.size() == 1 ? "" : "s");
    }
}

}  // namespace leafcutter::geometry
