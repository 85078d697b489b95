// quality.json: how good every single quad and vertex is, in the order of quads.obj.

#include <cmath>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "fab/package/package_files.h"
#include "geometry/error.h"

namespace leafcutter::fab {

namespace {

using geometry::CellQuality;
using geometry::VertexPlace;
using geometry::VertexQuality;

// Six digits are more than anything here is measured to.
void append_number(std::string& out, const std::optional<double>& value, std::string_view name) {
    if (!value) {
        out += "null";
        return;
    }
    if (!std::isfinite(*value)) {
        throw geometry::Error(geometry::ErrorKind::SelfCheck, "quality-not-finite",
                              fmt::format("quality: a value of {} is not a finite number", name));
    }
    fmt::format_to(std::back_inserter(out), "{:.6g}", *value);
}

// "name":[value, …] of all items.
template <typename Items, typename Value>
void append_array(std::string& out, std::string_view name, const Items& items, Value value) {
    fmt::format_to(std::back_inserter(out), "\"{}\":[", name);
    bool first = true;
    for (const auto& item : items) {
        if (!first) {
            out += ',';
        }
        first = false;
        append_number(out, value(item), name);
    }
    out += ']';
}

void append_cells(std::string& out, const std::vector<CellQuality>& cells) {
    struct Column {
        const char* name;
        double CellQuality::*value;
    };
    constexpr Column kColumns[] = {
        {"distance_mm", &CellQuality::distance},
        {"distance_percent", &CellQuality::distance_percent},
        {"area_percent", &CellQuality::area_percent},
        {"region_percent", &CellQuality::region_percent},
        {"planarity_percent", &CellQuality::planarity_percent},
        {"corner_deviation_deg", &CellQuality::corner_deviation_deg},
        {"stretch", &CellQuality::stretch},
        {"shear_deg", &CellQuality::shear_deg},
        {"region_area_mm2", &CellQuality::region_area},
    };
    const char* between = "";
    for (const Column& column : kColumns) {
        out += between;
        between = ",\n  ";
        append_array(out, column.name, cells,
                     [&](const CellQuality& cell) { return std::optional(cell.*column.value); });
    }
}

void append_vertices(std::string& out, const std::vector<VertexQuality>& vertices) {
    append_array(out, "angle_deviation_deg", vertices,
                 [](const VertexQuality& vertex) -> std::optional<double> {
                     if (vertex.place == VertexPlace::None) {
                         return std::nullopt;
                     }
                     return vertex.angle_deviation_deg;
                 });
    out += ",\n  ";
    append_array(out, "angle_deviation_bound_deg", vertices,
                 [](const VertexQuality& vertex) { return vertex.bound_deg; });
    out += ",\n  ";
    append_array(out, "crossing_angle_deviation_deg", vertices,
                 [](const VertexQuality& vertex) { return vertex.crossing_deviation_deg; });
}

}  // namespace

std::string quality_json(const JobResult& job) {
    std::string out = fmt::format(
        "{{\"format\":\"leafcutter-quality/1\",\n \"quads\":{},\n \"vertices\":{},\n "
        "\"per_quad\":{{",
        job.quality.cells.size(), job.quality.vertices.size());
    append_cells(out, job.quality.cells);
    out += "},\n \"per_vertex\":{";
    append_vertices(out, job.quality.vertices);
    out += "}}\n";
    return out;
}

}  // namespace leafcutter::fab
