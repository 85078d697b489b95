#include "geometry/io/read_mesh.h"

#include <string>

#include <fmt/format.h>

#include "geometry/io/text_scanner.h"

namespace leafcutter::geometry {

namespace {

using Reader = PolygonSoup (*)(std::span<const std::byte>, const ReadLimits&);

Reader reader_for(std::string_view file_name) {
    const std::size_t dot = file_name.rfind('.');
    const std::string ending =
        dot == std::string_view::npos ? std::string() : lower_case(file_name.substr(dot));
    if (ending == ".stl") {
        return read_stl;
    }
    if (ending == ".obj") {
        return read_obj;
    }
    if (ending == ".off") {
        return read_off;
    }
    if (ending == ".ply") {
        return read_ply;
    }
    throw Error(ErrorKind::BadFile, "unknown-format",
                fmt::format("{} is no mesh format we read; use .stl, .obj, .off or .ply",
                            ending.empty() ? "a name without ending" : quoted(ending)));
}

}  // namespace

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
