// SVG of a sheet for laser programs. Stroke colours are those that they map to settings by habit:
// red cuts, blue scores, black engraves (LightBurn's first layers, VisiCut's default mapping). Each
// operation is a layer of Inkscape; each piece is one element in it, named by id and <title>. A
// common edge belongs to the first of its two pieces. Over-cuts are not drawn: contours stay
// closed.

#include <algorithm>
#include <array>
#include <iterator>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "fab/cut/path_walk.h"
#include "fab/export/formats.h"
#include "fab/export/number.h"
#include "fab/markup.h"

namespace leafcutter::fab {

namespace {

struct Layer {
    Operation operation;
    const char* name;
    const char* stroke;
    bool lead_ins = false;
};

constexpr std::array<Layer, 3> kLayers{{{Operation::Engrave, "engrave", "#000000"},
                                        {Operation::Score, "score", "#0000ff"},
                                        {Operation::Cut, "cut", "#ff0000"}}};

// Apart from the contours, for programs that make their own.
constexpr Layer kLeadIns{Operation::Cut, "lead-in", "#ff0000", true};

std::vector<Polyline> lead_run(const CutPath& path) {
    return {{*path.lead_in, path.points.front()}};
}

// Sheets have y up, SVG has y down.
void add_run(const Polyline& points, double height_mm, std::string& out) {
    const bool closed = points.size() > 2 && points.front() == points.back();
    const std::size_t count = points.size() - (closed ? 1 : 0);
    for (std::size_t i = 0; i < count; ++i) {
        fmt::format_to(std::back_inserter(out), "{}{},{}", i == 0 ? "M" : " ",
                       short_number(points[i].x()), short_number(height_mm - points[i].y()));
    }
    out += closed ? "Z" : "";
}

// The paths of one piece in one operation, in the order of the program.
struct Element {
    std::string_view piece;
    std::vector<const CutPath*> paths;
};

std::vector<Element> elements_of(const CutProgram& program, const Layer& layer) {
    std::vector<Element> elements;
    std::map<std::string_view, std::size_t> place_of;
    for (const CutPath& path : program.paths) {
        if (path.operation != layer.operation || path.points.size() < 2 ||
            (layer.lead_ins && !path.lead_in)) {
            continue;
        }
        const auto [place, is_new] = place_of.emplace(path.piece, elements.size());
        if (is_new) {
            elements.push_back({path.piece, {}});
        }
        elements[place->second].paths.push_back(&path);
    }
    return elements;
}

void add_layer(const CutProgram& program, const Layer& layer, std::string& out) {
    fmt::format_to(std::back_inserter(out),
                   "<g id=\"{0}\" inkscape:groupmode=\"layer\" inkscape:label=\"{0}\" "
                   "fill=\"none\" stroke=\"{1}\" stroke-width=\"0.1\">\n",
                   layer.name, layer.stroke);
    for (const Element& element : elements_of(program, layer)) {
        const std::string piece = escaped(element.piece);
        fmt::format_to(std::back_inserter(out), "<path id=\"{}-{}\" data-piece=\"{}\" d=\"",
                       layer.name, piece, piece);
        for (const CutPath* path : element.paths) {
            for (const Polyline& run : layer.lead_ins ? lead_run(*path) : drawn_runs(*path)) {
                add_run(run, program.size.height_mm, out);
            }
        }
        fmt::format_to(std::back_inserter(out), "\"><title>{}, {}</title></path>\n", piece,
                       layer.name);
    }
    out += "</g>\n";
}

}  // namespace

std::string write_svg(const CutProgram& program) {
    const std::string width = short_number(program.size.width_mm);
    const std::string height = short_number(program.size.height_mm);
    std::string out = fmt::format(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
        "<svg xmlns=\"http://www.w3.org/2000/svg\" "
        "xmlns:inkscape=\"http://www.inkscape.org/namespaces/inkscape\" "
        "width=\"{0}mm\" height=\"{1}mm\" viewBox=\"0 0 {0} {1}\">\n"
        "<title>{2}, sheet {3}, {4}</title>\n",
        width, height, escaped(program.job), program.sheet, escaped(program.material));
    for (const Layer& layer : kLayers) {
        add_layer(program, layer, out);
    }
    if (std::any_of(program.paths.begin(), program.paths.end(),
                    [](const CutPath& path) { return path.lead_in.has_value(); })) {
        add_layer(program, kLeadIns, out);
    }
    return out + "</svg>\n";
}

}  // namespace leafcutter::fab
