#include "geometry/io/ply_header.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <utility>

#include <fmt/format.h>

namespace leafcutter::geometry {

namespace {

static_assert(std::endian::native == std::endian::little,
              "little-endian values are copied as they lie");

PlyType parse_type(std::string_view word, std::size_t line) {
    struct Name {
        std::string_view word;
        PlyType type;
    };
    static constexpr std::array<Name, 16> kNames{{{"char", PlyType::Int8},
                                                  {"int8", PlyType::Int8},
                                                  {"uchar", PlyType::Uint8},
                                                  {"uint8", PlyType::Uint8},
                                                  {"short", PlyType::Int16},
                                                  {"int16", PlyType::Int16},
                                                  {"ushort", PlyType::Uint16},
                                                  {"uint16", PlyType::Uint16},
                                                  {"int", PlyType::Int32},
                                                  {"int32", PlyType::Int32},
                                                  {"uint", PlyType::Uint32},
                                                  {"uint32", PlyType::Uint32},
                                                  {"float", PlyType::Float32},
                                                  {"float32", PlyType::Float32},
                                                  {"double", PlyType::Float64},
                                                  {"float64", PlyType::Float64}}};
    for (const Name& name : kNames) {
        if (name.word == word) {
            return name.type;
        }
    }
    throw bad_line("bad-header", line, fmt::format("{} is no PLY type", quoted(word)));
}

PlyEncoding parse_encoding(std::string_view words, std::size_t line) {
    const std::string_view word = take_word(words);
    if (word == "ascii") {
        return PlyEncoding::Text;
    }
    if (word == "binary_little_endian") {
        return PlyEncoding::LittleEndian;
    }
    if (word == "binary_big_endian") {
        return PlyEncoding::BigEndian;
    }
    throw bad_line("bad-header", line, fmt::format("{} is no PLY format", quoted(word)));
}

PlyElement parse_element(std::string_view words, std::size_t line) {
    PlyElement element;
    element.name = take_word(words);
    const std::string_view word = take_word(words);
    const auto count = parse_integer(word);
    if (!count || *count < 0) {
        throw bad_line("bad-header", line,
                       fmt::format("{} is no number of elements", quoted(word)));
    }
    element.count = static_cast<std::size_t>(*count);
    return element;
}

PlyProperty parse_property(std::string_view words, std::size_t line) {
    PlyProperty property;
    std::string_view word = take_word(words);
    if (word == "list") {
        property.count_type = parse_type(take_word(words), line);
        word = take_word(words);
    }
    property.type = parse_type(word, line);
    property.name = take_word(words);
    return property;
}

// The least bytes one such element takes. In text a value takes a digit and a blank or line end.
std::size_t least_bytes(const PlyElement& element, PlyEncoding encoding) {
    constexpr std::size_t kTextValue = 2;
    std::size_t bytes = 0;
    for (const PlyProperty& property : element.properties) {
        const PlyType type = property.count_type.value_or(property.type);
        bytes += encoding == PlyEncoding::Text ? kTextValue : ply_size(type);
        if (property.is_corner_list()) {
            constexpr std::size_t kCorners = 3;
            bytes +=
                kCorners * (encoding == PlyEncoding::Text ? kTextValue : ply_size(property.type));
        }
    }
    return bytes;
}

void check_counts(const PlyHeader& header, const LineScanner& lines) {
    std::size_t room = lines.bytes_left() + 1;
    for (const PlyElement& element : header.elements) {
        const std::size_t each = least_bytes(element, header.encoding);
        if (element.count > 0 && (each == 0 || element.count > room / each)) {
            throw bad_line("count-exceeds-file", lines.number(),
                           fmt::format("the header claims {} elements {}, more than the {} bytes "
                                       "behind it can hold; the file may have been cut off",
                                       element.count, quoted(element.name), lines.bytes_left()));
        }
        room -= element.count * each;
    }
}

std::size_t find_element(const PlyHeader& header, std::string_view name) {
    const auto is_it = [&](const PlyElement& element) { return element.name == name; };
    if (std::count_if(header.elements.begin(), header.elements.end(), is_it) > 1) {
        throw Error(ErrorKind::BadFile, "bad-header",
                    fmt::format("the header declares element {} twice", quoted(name)));
    }
    return static_cast<std::size_t>(
        std::find_if(header.elements.begin(), header.elements.end(), is_it) -
        header.elements.begin());
}

void check_vertex(const PlyElement& vertex) {
    for (const std::string_view axis : {"x", "y", "z"}) {
        const auto count =
            std::count_if(vertex.properties.begin(), vertex.properties.end(),
                          [&](const PlyProperty& p) { return p.name == axis && !p.count_type; });
        const auto lists =
            std::count_if(vertex.properties.begin(), vertex.properties.end(),
                          [&](const PlyProperty& p) { return p.name == axis && p.count_type; });
        if (count != 1 || lists != 0) {
            throw Error(
                ErrorKind::BadFile, "bad-header",
                fmt::format("the vertices have {} properties {}, one is due", count + lists, axis));
        }
    }
}

void check_mesh(const PlyHeader& header) {
    const std::size_t vertex = find_element(header, "vertex");
    const std::size_t face = find_element(header, "face");
    if (vertex == header.elements.size()) {
        throw Error(ErrorKind::BadFile, "bad-header", "the header declares no vertices");
    }
    check_vertex(header.elements[vertex]);
    if (face == header.elements.size()) {
        const bool strips = find_element(header, "tristrips") < header.elements.size();
        throw Error(ErrorKind::BadFile, strips ? "not-supported" : "no-faces",
                    strips ? "triangle strips are not supported; save the mesh with faces"
                           : "no faces: the header declares none (a point cloud?)");
    }
    const auto& properties = header.elements[face].properties;
    const auto lists = std::count_if(properties.begin(), properties.end(),
                                     [](const PlyProperty& p) { return p.is_corner_list(); });
    if (lists != 1) {
        throw Error(ErrorKind::BadFile, "bad-header",
                    fmt::format("the faces have {} lists vertex_indices, one is due", lists));
    }
}

void read_declaration(std::string_view words, std::size_t line, PlyHeader& header) {
    const std::string_view keyword = take_word(words);
    if (keyword == "element") {
        header.elements.push_back(parse_element(words, line));
    } else if (keyword == "property") {
        if (header.elements.empty()) {
            throw bad_line("bad-header", line, "a property before the first element");
        }
        header.elements.back().properties.push_back(parse_property(words, line));
    } else if (!keyword.empty() && keyword != "comment" && keyword != "obj_info") {
        throw bad_line("bad-header", line,
                       fmt::format("{} is no PLY declaration", quoted(keyword)));
    }
}

template <typename Number>
double value_of(std::string_view bytes, PlyEncoding encoding) {
    std::array<char, sizeof(Number)> raw{};
    std::memcpy(raw.data(), bytes.data(), raw.size());
    if (encoding == PlyEncoding::BigEndian) {
        std::reverse(raw.begin(), raw.end());
    }
    Number number;
    std::memcpy(&number, raw.data(), raw.size());
    return static_cast<double>(number);
}

}  // namespace

std::size_t PlyHeader::vertex_count() const {
    return elements[find_element(*this, "vertex")].count;
}

std::size_t ply_size(PlyType type) {
    switch (type) {
        case PlyType::Int8:
        case PlyType::Uint8:
            return 1;
        case PlyType::Int16:
        case PlyType::Uint16:
            return 2;
        case PlyType::Int32:
        case PlyType::Uint32:
        case PlyType::Float32:
            return 4;
        case PlyType::Float64:
            return 8;
    }
    return 8;
}

double ply_value(std::string_view bytes, PlyType type, PlyEncoding encoding) {
    switch (type) {
        case PlyType::Int8:
            return value_of<std::int8_t>(bytes, encoding);
        case PlyType::Uint8:
            return value_of<std::uint8_t>(bytes, encoding);
        case PlyType::Int16:
            return value_of<std::int16_t>(bytes, encoding);
        case PlyType::Uint16:
            return value_of<std::uint16_t>(bytes, encoding);
        case PlyType::Int32:
            return value_of<std::int32_t>(bytes, encoding);
        case PlyType::Uint32:
            return value_of<std::uint32_t>(bytes, encoding);
        case PlyType::Float32:
            return value_of<float>(bytes, encoding);
        case PlyType::Float64:
            return value_of<double>(bytes, encoding);
    }
    return 0.0;
}

PlyHeader read_ply_header(LineScanner& lines) {
    if (!lines.next() || lines.line() != "ply") {
        throw bad_line("bad-header", 1, "no PLY header: the file doesn't begin with \"ply\"");
    }
    PlyHeader header;
    bool has_format = false;
    for (;;) {
        if (!lines.next()) {
            throw bad_line("truncated", lines.number(), "the header is cut off: no \"end_header\"");
        }
        std::string_view words = lines.line();
        std::string_view rest = words;
        const std::string_view keyword = take_word(rest);
        if (keyword == "end_header") {
            break;
        }
        if (keyword == "format") {
            header.encoding = parse_encoding(rest, lines.number());
            has_format = true;
        } else {
            read_declaration(words, lines.number(), header);
        }
    }
    if (!has_format) {
        throw bad_line("bad-header", lines.number(), "the header declares no format");
    }
    check_mesh(header);
    check_counts(header, lines);
    return header;
}

}  // namespace leafcutter::geometry
