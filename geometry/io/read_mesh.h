// Strict readers for STL (ASCII, binary), OBJ, OFF and PLY (ASCII, both binaries), from bytes.
//
// Made for hostile input: no include is followed, counts are checked against the byte size before
// any allocation, numbers are read with from_chars and must be finite, indices must exist. What a
// file says is read or refused, never guessed.

#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "geometry/types.h"

namespace leafcutter::geometry {

struct ReadLimits {
    std::size_t max_bytes = 256U << 20U;
    std::size_t max_triangles = 20'000'000;
    std::size_t max_line_bytes = 1U << 20U;
};

// Reads a mesh whose format is told by `file_name`'s ending (.stl .obj .off .ply, any case) and
// confirmed by its first bytes.
//
// Throws Error(BadFile) naming the line or byte and the defect.
PolygonSoup read_mesh(std::span<const std::byte> bytes,
                      std::string_view file_name,
                      const ReadLimits& limits = {});

// Whether read_mesh knows the ending of that name.
bool is_mesh_name(std::string_view file_name);

// A name for read_mesh: `name` itself if it has an ending of ours, else with the one that the first
// bytes of the mesh tell; `name` if they tell none.
std::string mesh_file_name(std::string_view name, std::span<const std::byte> bytes);

// The single formats; `read_mesh` chooses among them.
PolygonSoup read_stl(std::span<const std::byte> bytes, const ReadLimits& limits);
PolygonSoup read_obj(std::span<const std::byte> bytes, const ReadLimits& limits);
PolygonSoup read_off(std::span<const std::byte> bytes, const ReadLimits& limits);
PolygonSoup read_ply(std::span<const std::byte> bytes, const ReadLimits& limits);

}  // namespace leafcutter::geometry
