// A connected surface on its way to a foliation, with what the rest of the world calls its vertices
// and boundary loops. Internal to the choice of a foliation.

#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "geometry/context.h"
#include "geometry/foliation.h"
#include "geometry/foliation_names.h"
#include "geometry/punctures.h"
#include "geometry/topology.h"

namespace leafcutter::geometry {

struct SurfacePart {
    TriangleMesh mesh;
    std::vector<int> source_vertex;       // Per vertex: of the surface the user gave, or -1.
    std::vector<std::vector<int>> loops;  // All boundary loops, surface to the left.
    std::vector<int> loop_numbers;        // As LoopName has them; -1 for holes nobody asked for.
    std::vector<Puncture> punctures;      // Holes in it; vertices of the surface the user gave.
    double removed_area = 0.0;            // By the holes.
    int euler = 0;

    int genus() const { return (2 - static_cast<int>(loops.size()) - euler) / 2; }
};

// The connected parts of a surface in the order of their first triangles, `given` punctures opened.
// Throws as open_punctures does.
std::vector<SurfacePart> split_into_parts(const TriangleMesh& mesh,
                                          const Topology& topology,
                                          std::span<const Puncture> given,
                                          const Context& context);

// With more holes. Vertices of `punctures` are those of `part`; a hole that doesn't fit is made
// smaller or left out.
SurfacePart with_holes(const SurfacePart& part,
                       std::span<const Puncture> punctures,
                       const Context& context);

// With at most about `most` vertices, to try things out on. Boundary loops keep their order.
SurfacePart coarse_part(const SurfacePart& part, std::size_t most, const Context& context);

// The mode that a surface of this topology asks for.
FoliationMode natural_mode(const SurfacePart& part);

// "a disk", "a surface of genus 2 with 1 boundary loop".
std::string describe(const SurfacePart& part);

}  // namespace leafcutter::geometry
