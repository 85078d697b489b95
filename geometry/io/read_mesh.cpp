#include "geometry/io/read_mesh.h"

#include <algorithm>
#include <array>
#include <initializer_list>
#include <string>

#include <fmt/format.h>

#include "geometry/io/text_scanner.h"

namespace leafcutter::geometry {

namespace {

using Reader = PolygonSoup (*)(std::span<const std::byte>, const ReadLimits&);

struct Format {
    std::string_view ending;
    Reader read;
};

constexpr std::array kFormats{Format{".stl", read_stl}, Format{".obj", read_obj},
                              Format{".off", read_off}, Format{".ply", read_ply}};

std::string ending_of(std::string_view file_name) {
    const std::size_t dot = file_name.rfind('.');
    return dot == std::string_view::npos ? std::string() : lower_case(file_name.substr(dot));
}

Reader reader_for(std::string_view file_name) {
    const std::string ending = ending_of(file_name);
    for (const Format& format : kFormats) {
        if (format.ending == ending) {
            return format.read;
        }
    }
    throw Error(ErrorKind::BadFile, "unknown-format",
                fmt::format("{} is no mesh format we read; use .stl, .obj, .off or .ply",
                            ending.empty() ? "a name without ending" : quoted(ending)));
}

bool is_one_of(std::string_view word, std::initializer_list<std::string_view> words) {
    return std::find(words.begin(), words.end(), word) != words.end();
}

// A binary STL says how long it is.
bool is_binary_stl(std::span<const std::byte> bytes) {
    constexpr std::size_t kHead = 84;
    constexpr std::size_t kTriangle = 50;
    if (bytes.size() < kHead) {
        return false;
    }
    std::size_t triangles = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        triangles |= std::to_integer<std::size_t>(bytes[kHead - 4 + i]) << 8 * i;
    }
    return bytes.size() == kHead + kTriangle * triangles;
}

std::string_view ending_told_by(std::span<const std::byte> bytes) {
    if (is_binary_stl(bytes)) {
        return ".stl";
    }
    constexpr std::size_t kLook = 1U << 16U;
    LineScanner lines(as_text(bytes.first(std::min(bytes.size(), kLook))), kLook);
    if (!lines.next_content()) {
        return "";
    }
    std::string_view line = lines.line();
    const std::string_view word = take_word(line);
    if (is_one_of(word, {"OFF", "COFF", "NOFF", "CNOFF", "STOFF", "NCOFF"})) {
        return ".off";
    }
    if (is_one_of(word, {"v", "vn", "vt", "f", "o", "g", "s", "mtllib", "usemtl"})) {
        return ".obj";
    }
    if (word == "ply") {
        return ".ply";
    }
    return word == "solid" ? ".stl" : "";
}

}  // namespace

bool is_mesh_name(std::string_view file_name) {
    const std::string ending = ending_of(file_name);
    return std::any_of(kFormats.begin(), kFormats.end(),
                       [&ending](const Format& format) { return format.ending == ending; });
}

std::string mesh_file_name(std::string_view name, std::span<const std::byte> bytes) {
    return is_mesh_name(name) ? std::string(name)
                              : fmt::format("{}{}", name, ending_told_by(bytes));
}

PolygonSoup read_mesh(std::span<const std::byte> bytes,
                      std::string_view file_name,
                      const ReadLimits& limits) {
    const Reader read = reader_for(file_name);
    if (bytes.empty()) {
        throw Error(ErrorKind::BadFile, "empty-file", "empty file: 0 bytes");
    }
    if (bytes.size() > limits.max_bytes) {
        throw Error(ErrorKind::BadFile, "too-large",
                    fmt::format("the file has {} bytes, more than the {} that are read",
                                bytes.size(), limits.max_bytes));
    }
    PolygonSoup soup = read(bytes, limits);
    if (soup.face_count() == 0) {
        throw Error(ErrorKind::BadFile, "no-faces",
                    fmt::format("no faces: the file holds {} vertices and no surface",
                                soup.positions.size()));
    }
    return soup;
}

}  // namespace leafcutter::geometry
