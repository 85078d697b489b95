#include "fab/guide/svg_drawing.h"

#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "fab/export/number.h"
#include "fab/markup.h"

namespace leafcutter::fab::guide {

namespace {

// Units of a drawing's coordinates: whole numbers keep files small, and 0.02 mm is finer than
// print.
constexpr double kUnitsPerMm = 50.0;

int units(double mm) {
    return static_cast<int>(std::lround(mm * kUnitsPerMm));
}

// Relative steps, each from where the rounded ones before have come to.
void append_line(std::string& out, const Points& line, bool closed) {
    if (line.empty()) {
        return;
    }
    const auto put = std::back_inserter(out);
    int x = units(line.front().x());
    int y = units(line.front().y());
    fmt::format_to(put, "M{} {}", x, y);
    bool is_first = true;
    for (std::size_t i = 1; i < line.size(); ++i) {
        const int dx = units(line[i].x()) - x;
        const int dy = units(line[i].y()) - y;
        if (dx == 0 && dy == 0) {
            continue;
        }
        out += is_first ? "l" : (dx < 0 ? "" : " ");
        fmt::format_to(put, "{}{}{}", dx, dy < 0 ? "" : " ", dy);
        is_first = false;
        x += dx;
        y += dy;
    }
    if (closed) {
        out += 'z';
    } else if (is_first) {
        out += "h0";
    }
}

void append(std::string& out, const Paths& paths) {
    if (paths.lines.empty()) {
        return;
    }
    const bool filled = paths.closed && paths.fill;
    const auto put = std::back_inserter(out);
    fmt::format_to(put, "<path fill=\"{}\"", filled ? hex(*paths.fill) : "none");
    if (paths.stroke) {
        const int width = std::max(1, units(paths.stroke->width_mm));
        fmt::format_to(put, " stroke=\"{}\" stroke-width=\"{}\"", hex(paths.stroke->colour), width);
        if (paths.stroke->dashed) {
            fmt::format_to(put, " stroke-dasharray=\"{} {}\"", 4 * width, 3 * width);
        }
    }
    out += " d=\"";
    for (const Points& line : paths.lines) {
        append_line(out, line, paths.closed);
    }
    out += "\"/>";
}

void append(std::string& out, const Label& label) {
    const auto put = std::back_inserter(out);
    const int x = units(label.at.x());
    const int y = units(label.at.y());
    fmt::format_to(put, "<text x=\"{}\" y=\"{}\" font-size=\"{}\"", x, y, units(label.size_mm));
    if (label.anchor != Anchor::Start) {
        fmt::format_to(put, " text-anchor=\"{}\"",
                       label.anchor == Anchor::Middle ? "middle" : "end");
    }
    if (label.angle_deg != 0.0) {
        fmt::format_to(put, " transform=\"rotate({} {} {})\"", short_number(-label.angle_deg), x,
                       y);
    }
    if (label.bold) {
        out += " font-weight=\"700\"";
    }
    if (label.halo) {
        out += " class=\"halo\"";
    }
    fmt::format_to(put, " fill=\"{}\">{}</text>", hex(label.colour), escaped(label.text));
}

void append(std::string& out, const Use& use) {
    fmt::format_to(std::back_inserter(out), "<use href=\"#s{}\"/>", use.shared);
}

void append_shapes(std::string& out, const Drawing& drawing) {
    for (const Shape& shape : drawing.shapes) {
        std::visit([&](const auto& one) { append(out, one); }, shape);
    }
}

}  // namespace

std::string hex(const Colour& colour) {
    return fmt::format("#{:02x}{:02x}{:02x}", colour.red, colour.green, colour.blue);
}

void append_svg(std::string& out, const Drawing& drawing) {
    const auto put = std::back_inserter(out);
    fmt::format_to(put, "<svg role=\"img\" style=\"width:{}mm\" viewBox=\"0 0 {} {}\">",
                   short_number(drawing.width_mm), units(drawing.width_mm),
                   units(drawing.height_mm));
    if (!drawing.description.empty()) {
        fmt::format_to(put, "<title>{}</title>", escaped(drawing.description));
    }
    append_shapes(out, drawing);
    out += "</svg>\n";
}

void append_shared(std::string& out, const Drawing& drawing, std::size_t number) {
    fmt::format_to(std::back_inserter(out), "<g id=\"s{}\">", number);
    append_shapes(out, drawing);
    out += "</g>\n";
}

}  // namespace leafcutter::fab::guide
