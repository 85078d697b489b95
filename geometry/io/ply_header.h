// The declarations at the head of a PLY file. Internal to geometry/io.

#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/io/text_scanner.h"

namespace leafcutter::geometry {

enum class PlyEncoding { Text, LittleEndian, BigEndian };
enum class PlyType { Int8, Uint8, Int16, Uint16, Int32, Uint32, Float32, Float64 };

struct PlyProperty {
    std::string name;
    PlyType type = PlyType::Float32;
    std::optional<PlyType> count_type;  // Of lists only.

    bool is_corner_list() const {
        return count_type && (name == "vertex_indices" || name == "vertex_index");
    }
};

struct PlyElement {
    std::string name;
    std::size_t count = 0;
    std::vector<PlyProperty> properties;
};

struct PlyHeader {
    PlyEncoding encoding = PlyEncoding::Text;
    std::vector<PlyElement> elements;

    std::size_t vertex_count() const;
};

// Reads up to and with the "end_header" line. What it declares is fit for reading a mesh: one
// vertex element with x y z, one face element with one corner list, and no more of any element than
// the bytes behind the header can hold.
//
// Throws Error(BadFile) with the line number.
PlyHeader read_ply_header(LineScanner& lines);

std::size_t ply_size(PlyType type);

// The value of exactly ply_size(type) bytes. Every type fits a double exactly.
double ply_value(std::string_view bytes, PlyType type, PlyEncoding encoding);

}  // namespace leafcutter::geometry
