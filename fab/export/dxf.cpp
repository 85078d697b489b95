// DXF R12 (AC1009): group code and value on lines of their own. Polylines are POLYLINE, VERTEX…,
// SEQEND; group 70 of a POLYLINE is 1 when it is closed.

#include <algorithm>
#include <array>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "fab/cut/path_walk.h"
#include "fab/export/formats.h"

namespace leafcutter::fab {

namespace {

struct Layer {
    const char* name;
    int colour;  // AutoCAD colour index.
};

// In the order of Operation.
constexpr std::array<Layer, 3> kLayers{{{"ENGRAVE", 7}, {"SCORE", 5}, {"CUT", 1}}};

// Apart from the contours, for programs that make their own.
constexpr Layer kLeadIns{"LEAD_IN", 1};

void add(std::string& out, int code, std::string_view value) {
    fmt::format_to(std::back_inserter(out), "{}\n{}\n", code, value);
}

void add_mm(std::string& out, int code, double value_mm) {
    fmt::format_to(std::back_inserter(out), "{}\n{:.4f}\n", code, value_mm);
}

std::string head(const SheetSize& size) {
    std::string out = "999\nLeafcutter, millimetres\n";
    out += "0\nSECTION\n2\nHEADER\n9\n$ACADVER\n1\nAC1009\n9\n$INSUNITS\n70\n4\n";
    out += "9\n$EXTMIN\n10\n0.0\n20\n0.0\n9\n$EXTMAX\n";
    add_mm(out, 10, size.width_mm);
    add_mm(out, 20, size.height_mm);
    return out + "0\nENDSEC\n";
}

bool has_lead_ins(const CutProgram& program) {
    return std::any_of(program.paths.begin(), program.paths.end(),
                       [](const CutPath& path) { return path.lead_in.has_value(); });
}

std::string tables(bool lead_ins) {
    std::string out =
        "0\nSECTION\n2\nTABLES\n0\nTABLE\n2\nLTYPE\n70\n1\n"
        "0\nLTYPE\n2\nCONTINUOUS\n70\n0\n3\nSolid line\n72\n65\n73\n0\n40\n0.0\n0\nENDTAB\n";
    std::vector<Layer> layers(kLayers.begin(), kLayers.end());
    if (lead_ins) {
        layers.push_back(kLeadIns);
    }
    fmt::format_to(std::back_inserter(out), "0\nTABLE\n2\nLAYER\n70\n{}\n", layers.size());
    for (const Layer& layer : layers) {
        fmt::format_to(std::back_inserter(out), "0\nLAYER\n2\n{}\n70\n0\n62\n{}\n6\nCONTINUOUS\n",
                       layer.name, layer.colour);
    }
    return out + "0\nENDTAB\n0\nENDSEC\n";
}

void add_polyline(const Polyline& points, const char* layer, std::string& out) {
    const bool closed = points.size() > 2 && points.front() == points.back();
    add(out, 0, "POLYLINE");
    add(out, 8, layer);
    out += "66\n1\n10\n0.0\n20\n0.0\n30\n0.0\n";
    add(out, 70, closed ? "1" : "0");
    const std::size_t count = points.size() - (closed ? 1 : 0);
    for (std::size_t i = 0; i < count; ++i) {
        add(out, 0, "VERTEX");
        add(out, 8, layer);
        add_mm(out, 10, points[i].x());
        add_mm(out, 20, points[i].y());
        out += "30\n0.0\n";
    }
    add(out, 0, "SEQEND");
    add(out, 8, layer);
}

}  // namespace

std::string write_dxf(const CutProgram& program) {
    std::string out =
        head(program.size) + tables(has_lead_ins(program)) + "0\nSECTION\n2\nENTITIES\n";
    for (const CutPath& path : program.paths) {
        if (path.points.size() < 2) {
            continue;
        }
        for (const Polyline& run : drawn_runs(path)) {
            add_polyline(run, kLayers[static_cast<std::size_t>(path.operation)].name, out);
        }
        if (path.lead_in) {
            add_polyline({*path.lead_in, path.points.front()}, kLeadIns.name, out);
        }
    }
    return out + "0\nENDSEC\n0\nEOF\n";
}

}  // namespace leafcutter::fab
