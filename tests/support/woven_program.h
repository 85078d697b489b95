// The G-code of a small woven sheet, made as `leafcutter weave` makes it.

#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "fab/pipeline.h"
#include "geometry/io/mesh_writer.h"
#include "geometry/samples.h"

namespace leafcutter::test {

inline std::string woven_program(fab::Dialect dialect = fab::Dialect::Grbl, int cells = 3) {
    fab::JobParams params;
    params.scale.longest_side_mm = 25.0 * cells;
    params.grid.all.rows = cells;
    params.grid.all.cols = cells;
    params.nesting.time_s = 0.01;
    params.output.dialect = dialect;
    const std::string mesh = geometry::write_obj(geometry::make_sample("square", 100));
    const std::span<const char> letters(mesh.data(), mesh.size());
    const fab::PackageSummary woven =
        fab::weave({"square.obj", std::as_bytes(letters)}, params, {fab::built_in_materials(), {}});
    const fab::PackageFile* file = woven.package.find("sheets/sheet-001.gcode");
    return file == nullptr ? std::string() : file->bytes;
}

}  // namespace leafcutter::test
