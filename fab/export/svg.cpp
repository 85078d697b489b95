#include <array>
#include <iterator>
#include <string>

#include <fmt/format.h>

#include "fab/export/formats.h"
#include "fab/export/number.h"
#include "fab/markup.h"

namespace leafcutter::fab {

namespace {

struct Layer {
    Operation operation;
    const char* name;
    const char* stroke;  // The colours that laser programs map to layers by habit.
};

constexpr std::array<Layer, 3> kLayers{{{Operation::Engrave, "engrave", "#000000"},
                                        {Operation::Score, "score", "#0000ff"},
                                        {Operation::Cut, "cut", "#ff0000"}}};

// Sheets have y up, SVG has y down.
void add_path(const CutPath& path, double height_mm, std::string& out) {
    const bool closed = path.points.front() == path.points.back();
    fmt::format_to(std::back_inserter(out), "<path data-piece=\"{}\" d=\"M", escaped(path.piece));
    const std::size_t count = path.points.size() - (closed ? 1 : 0);
    for (std::size_t i = 0; i < count; ++i) {
        fmt::format_to(std::back_inserter(out), "{}{},{}", i == 0 ? "" : " ",
                       short_number(path.points[i].x()),
                       short_number(height_mm - path.points[i].y()));
    }
    out += closed ? "Z\"/>\n" : "\"/>\n";
}

}  // namespace

std::string write_svg(const CutProgram& program) {
    const std::string width = short_number(program.size.width_mm);
    const std::string height = short_number(program.size.height_mm);
    std::string out = fmt::format(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}mm\" height=\"{1}mm\" "
        "viewBox=\"0 0 {0} {1}\">\n<title>{2}, sheet {3}, {4}</title>\n",
        width, height, escaped(program.job), program.sheet, escaped(program.material));
    for (const Layer& layer : kLayers) {
        fmt::format_to(std::back_inserter(out),
                       "<g id=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"0.1\">\n",
                       layer.name, layer.stroke);
        for (const CutPath& path : program.paths) {
            if (path.operation == layer.operation && path.points.size() > 1) {
                add_path(path, program.size.height_mm, out);
            }
        }
        out += "</g>\n";
    }
    return out + "</svg>\n";
}

}  // namespace leafcutter::fab
