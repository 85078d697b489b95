// DXF R12 (AC1009): group code and value on lines of their own. Polylines are POLYLINE, VERTEX…,
// SEQEND; group 70 of a POLYLINE is 1 when it is closed.

#include <array>
#include <iterator>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "fab/export/formats.h"

namespace leafcutter::fab {

namespace {

struct Layer {
    const char* name;
    int colour;  // AutoCAD colour index.
};

// In the order of Operation.
constexpr std::array<Layer, 3> kLayers{{{"ENGRAVE", 7}, {"SCORE", 5}, {"CUT", 1}}};

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

std::string tables() {
    std::string out =
        "0\nSECTION\n2\nTABLES\n0\nTABLE\n2\nLTYPE\n70\n1\n"
        "0\nLTYPE\n2\nCONTINUOUS\n70\n0\n3\nSolid line\n72\n65\n73\n0\n40\n0.0\n0\nENDTAB\n";
    fmt::format_to(std::back_inserter(out), "0\nTABLE\n2\nLAYER\n70\n{}\n", kLayers.size());
    for (const Layer& layer : kLayers) {
        fmt::format_to(std::back_inserter(out), "0\nLAYER\n2\n{}\n70\n0\n62\n{}\n6\nCONTINUOUS\n",
                       layer.name, layer.colour);
    }
    return out + "0\nENDTAB\n0\nENDSEC\n";
}

void add_polyline(const CutPath& path, std::string& out) {
    const char* layer = kLayers[static_cast<std::size_t>(path.operation)].name;
    const bool closed = path.points.front() == path.points.back();
    add(out, 0, "POLYLINE");
    add(out, 8, layer);
    out += "66\n1\n10\n0.0\n20\n0.0\n30\n0.0\n";
    add(out, 70, closed ? "1" : "0");
    const std::size_t count = path.points.size() - (closed ? 1 : 0);
    for (std::size_t i = 0; i < count; ++i) {
        add(out, 0, "VERTEX");
        add(out, 8, layer);
        add_mm(out, 10, path.points[i].x());
        add_mm(out, 20, path.points[i].y());
        out += "30\n0.0\n";
    }
    add(out, 0, "SEQEND");
    add(out, 8, layer);
}

}  // namespace

std::string write_dxf(const CutProgram& program) {
    std::string out = head(program.size) + tables() + "0\nSECTION\n2\nENTITIES\n";
    for (const CutPath& path : program.paths) {
        if (path.points.size() > 1) {
            add_polyline(path, out);
        }
    }
    return out + "0\nENDSEC\n0\nEOF\n";
}

}  // namespace leafcutter::fab
