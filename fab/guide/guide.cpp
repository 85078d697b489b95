// guide.html: what to cut, what goes where, which thread lies on top. Self-contained, prints well.

#include <algorithm>
#include <iterator>
#include <map>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "fab/markup.h"
#include "fab/material/totals.h"
#include "fab/package/package_files.h"

namespace leafcutter::fab {

namespace {

constexpr const char* kStyle = R"(
:root { color-scheme: light; }
body { font: 15px/1.45 system-ui, sans-serif; max-width: 60rem; margin: 2rem auto; padding: 0 1rem;
       color: #222; background: #fff; }
h1 { margin-bottom: 0; } h2 { margin-top: 2rem; border-bottom: 1px solid #ccc; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; }
td, th { padding: .15rem .7rem; text-align: left; border-bottom: 1px solid #e5e5e5; }
td.n { text-align: right; } .facts td:first-child { color: #666; }
svg.weave { max-width: 100%; border: 1px solid #999; }
.swatch { display: inline-block; width: .9em; height: .9em; border: 1px solid #888;
          vertical-align: -.1em; margin-right: .3em; }
.columns { columns: 18rem; font-size: 13px; } li { break-inside: avoid; }
@media print { body { margin: 0; max-width: none; font-size: 11px; } h2 { break-after: avoid; }
               table, svg { break-inside: avoid; } }
)";

// A colour of a material store goes into style attributes: "#rrggbb" or nothing.
std::string colour_of(const Material& material) {
    const std::string& colour = material.colour;
    const bool hex = colour.size() == 7 && colour[0] == '#' &&
                     colour.find_first_not_of("0123456789abcdefABCDEF", 1) == std::string::npos;
    return hex ? colour : "#888888";
}

const char* name_of(Family family) {
    return family == Family::Weft ? "weft" : "warp";
}

class GuideWriter {
public:
    explicit GuideWriter(const JobResult& job) : job_(job) {
        for (const Piece& piece : job.pieces) {
            pieces_[piece.id] = &piece;
        }
        for (const Sheet& sheet : job.layout.sheets) {
            for (const Placement& placement : sheet.placements) {
                sheet_of_[placement.piece] = sheet.id;
            }
        }
        for (const Strip& strip : job.strips) {
            auto& names = strip.family == Family::Weft ? weft_of_ : warp_of_;
            for (const int quad : strip.quads) {
                names[quad] = &strip;
            }
        }
        for (std::size_t part = 0; job.parts.size() > 1 && part < job.parts.size(); ++part) {
            for (const int cylinder : job.parts[part].cylinders) {
                part_of_[static_cast<std::size_t>(cylinder)] = part + 1;
            }
        }
    }

    std::string write() {
        add("<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
            "<meta name=\"viewport\" content=\"width=device-width\">\n<title>{0}</title>\n"
            "<style>{1}</style></head><body>\n<h1>{0}</h1>\n",
            escaped(job_.input.file), kStyle);
        add_facts();
        add_order();
        for (std::size_t cylinder = 0; cylinder < job_.quads.grids.size(); ++cylinder) {
            add_cylinder(cylinder);
        }
        add_seams();
        add_sheets();
        add_parts(Family::Weft);
        add_parts(Family::Warp);
        add_warnings();
        out_ += "</body></html>\n";
        return std::move(out_);
    }

private:
    template <typename... Values>
    void add(fmt::format_string<Values...> format, Values&&... values) {
        fmt::format_to(std::back_inserter(out_), format, std::forward<Values>(values)...);
    }

    void fact(std::string_view what, const std::string& value) {
        add("<tr><td>{}</td><td>{}</td></tr>\n", what, value);
    }

    void add_family_fact(Family family) {
        const Material& material = job_.material_of(family);
        const FamilyTotals totals = total_of(job_, family);
        fact(
            name_of(family),
            fmt::format("<span class=\"swatch\" style=\"background:{}\"></span>{}: {} strips in {} "
                        "pieces, {:.1f} m, {:.1f} g",
                        colour_of(material), escaped(material.name), totals.strips, totals.pieces,
                        totals.length_mm / 1000.0, totals.weight_g));
    }

    void add_facts() {
        Eigen::Vector3d low = job_.quads.vertices.front();
        Eigen::Vector3d high = low;
        for (const Eigen::Vector3d& point : job_.quads.vertices) {
            low = low.cwiseMin(point);
            high = high.cwiseMax(point);
        }
        const Eigen::Vector3d size = high - low;
        double seconds = 0.0;
        for (const CutProgram& program : job_.programs) {
            seconds += program.estimated_s;
        }
        out_ += "<table class=\"facts\">\n";
        fact("size", fmt::format("{:.0f} x {:.0f} x {:.0f} mm", size.x(), size.y(), size.z()));
        fact("cells", fmt::format("{}", job_.quads.quads.size()));
        add_family_fact(Family::Weft);
        add_family_fact(Family::Warp);
        fact("sheets", fmt::format("{}, {:.0f} % used", job_.layout.sheets.size(),
                                   job_.layout.density_percent));
        fact("cutting time", fmt::format("about {:.0f} min", seconds / 60.0));
        out_ += "</table>\n";
    }

    void add_order() {
        out_ +=
            "<h2>Order of work</h2>\n<ol>\n"
            "<li>Cut the sheets. Each piece carries its id; the arrow behind it shows the way "
            "the strip runs. Engraved sides face outward.</li>\n"
            "<li>Join the pieces of a strip in the order of their numbers: the tab at the end of "
            "each piece is glued under the start of the next.</li>\n"
            "<li>Fold lightly along scored lines.</li>\n";
        if (std::any_of(job_.strips.begin(), job_.strips.end(),
                        [](const Strip& strip) { return !strip.next.empty(); })) {
            out_ +=
                "<li>Cylinders meet cell by cell: where a warp strip ends at the rim of its "
                "cylinder, its tab goes under the start of the strip named in the list of parts, "
                "and the weave goes on as if there were no joint.</li>\n";
        }
        for (std::size_t i = 0; i < job_.quads.grids.size(); ++i) {
            const geometry::ChartShape shape = job_.quads.grids[i].shape;
            const bool rings = shape != geometry::ChartShape::Rectangle;
            const bool folds = shape == geometry::ChartShape::Pillowcase;
            add("<li>Cylinder {}: lay out all warp strips side by side in the order of the table's "
                "columns. Weave in the weft strips from the bottom row up, over and under as "
                "drawn.{}{}</li>\n",
                i + 1,
                rings ? " Close each weft ring with its tab before the next one follows." : "",
                folds ? " The first and the last ring lie flat, like the ends of a pillowcase: "
                        "there each warp strip goes on over the fold into another column, and "
                        "closes on itself where it began."
                      : "");
        }
        out_ += "</ol>\n";
    }

    std::string id_at(std::size_t cylinder, int row, int col, Family family) const {
        const auto& grid = job_.quads.grids[cylinder];
        const int quad = first_quad(cylinder) + row * grid.cols + col;
        const auto& names = family == Family::Weft ? weft_of_ : warp_of_;
        const auto found = names.find(quad);
        return found == names.end() ? std::string() : found->second->id;
    }

    // Empty where the model is all one part.
    std::string part_text(std::size_t cylinder) const {
        const auto part = part_of_.find(cylinder);
        return part == part_of_.end() ? std::string() : fmt::format(", part {}", part->second);
    }

    // Quads are sorted by cylinder, row and column.
    int first_quad(std::size_t cylinder) const {
        int first = 0;
        for (std::size_t i = 0; i < cylinder; ++i) {
            first += job_.quads.grids[i].rows * job_.quads.grids[i].cols;
        }
        return first;
    }

    void add_cylinder(std::size_t cylinder) {
        const auto& grid = job_.quads.grids[cylinder];
        if (grid.rows == 0) {
            return;  // Left out: its ends are joined.
        }
        const double cell = std::clamp(900.0 / grid.cols, 4.0, 16.0);
        add("<h2>Cylinder {}{}: {} weft rows, {} warp columns</h2>\n", cylinder + 1,
            part_text(cylinder), grid.rows, grid.cols);
        add("<p>Dark: warp on top. Rows run from {} (bottom) to {} (top), columns from {} (left) "
            "to "
            "{} (right), seen from outside.</p>\n",
            id_at(cylinder, 0, 0, Family::Weft), id_at(cylinder, grid.rows - 1, 0, Family::Weft),
            id_at(cylinder, 0, 0, Family::Warp), id_at(cylinder, 0, grid.cols - 1, Family::Warp));
        const int margin = 4;  // Cells, for the names of rows and columns.
        add("<svg class=\"weave\" xmlns=\"http://www.w3.org/2000/svg\" width=\"{:.0f}\" "
            "viewBox=\"{} 0 {} {}\" font-family=\"sans-serif\" font-size=\"0.8\">\n",
            (grid.cols + margin) * cell, -margin, grid.cols + margin, grid.rows + 2);
        add("<rect width=\"{}\" height=\"{}\" fill=\"{}\"/>\n", grid.cols, grid.rows,
            colour_of(job_.weft));
        add("<path fill=\"{}\" d=\"{}\"/>\n", colour_of(job_.warp), warp_path(cylinder));
        add("<path fill=\"none\" stroke=\"#0003\" stroke-width=\".04\" d=\"{}\"/>\n",
            grid_path(grid.rows, grid.cols));
        add_names(cylinder, cell);
        out_ += "</svg>\n";
    }

    std::string warp_path(std::size_t cylinder) const {
        const auto& grid = job_.quads.grids[cylinder];
        const int first = first_quad(cylinder);
        std::string path;
        for (int row = 0; row < grid.rows; ++row) {
            for (int col = 0; col < grid.cols; ++col) {
                const int quad = first + row * grid.cols + col;
                if (job_.weave.warp_on_top[static_cast<std::size_t>(quad)] != 0) {
                    fmt::format_to(std::back_inserter(path), "M{} {}h1v1h-1z", col,
                                   grid.rows - 1 - row);
                }
            }
        }
        return path;
    }

    static std::string grid_path(int rows, int cols) {
        std::string path;
        for (int row = 0; row <= rows; ++row) {
            fmt::format_to(std::back_inserter(path), "M0 {}h{}", row, cols);
        }
        for (int col = 0; col <= cols; ++col) {
            fmt::format_to(std::back_inserter(path), "M{} 0v{}", col, rows);
        }
        return path;
    }

    void add_names(std::size_t cylinder, double cell) {
        const auto& grid = job_.quads.grids[cylinder];
        const int step = cell < 9.0 ? 5 : 1;
        for (int row = 0; row < grid.rows; row += step) {
            add("<text x=\"-.2\" y=\"{:.1f}\" text-anchor=\"end\">{}</text>\n",
                grid.rows - row - 0.2, id_at(cylinder, row, 0, Family::Weft));
        }
        for (int col = 0; col < grid.cols; col += std::max(step, 4)) {
            add("<text x=\"{}\" y=\"{}\">{}</text>\n", col, grid.rows + 1.2,
                id_at(cylinder, 0, col, Family::Warp));
        }
    }

    void add_seams() {
        if (job_.weave.seams.empty()) {
            return;
        }
        add("<h2>Where the pattern breaks</h2>\n<p>{} pairs of neighbouring cells lie alike:</p>\n"
            "<ul class=\"columns\">\n",
            job_.weave.seams.size());
        for (const auto& [one, two] : job_.weave.seams) {
            add("<li>{} x {} beside {} x {}</li>\n", weft_of_.at(one)->id, warp_of_.at(one)->id,
                weft_of_.at(two)->id, warp_of_.at(two)->id);
        }
        out_ += "</ul>\n";
    }

    void add_sheets() {
        out_ +=
            "<h2>Sheets</h2>\n<table><tr><th>sheet</th><th>material</th><th>size</th>"
            "<th>pieces</th><th>time</th></tr>\n";
        for (std::size_t i = 0; i < job_.layout.sheets.size(); ++i) {
            const Sheet& sheet = job_.layout.sheets[i];
            add("<tr><td>{}</td><td>{}</td><td>{:g} x {:g} mm</td><td class=\"n\">{}</td>"
                "<td class=\"n\">{:.0f} min</td></tr>\n",
                sheet.id, escaped(sheet.material), sheet.size.width_mm, sheet.size.height_mm,
                sheet.placements.size(), job_.programs[i].estimated_s / 60.0);
        }
        out_ += "</table>\n";
    }

    void add_parts(Family family) {
        add("<h2>Parts: {}</h2>\n<table><tr><th>piece</th><th>sheet</th><th>cells</th>"
            "<th>length</th><th></th></tr>\n",
            name_of(family));
        for (const Strip& strip : job_.strips) {
            if (strip.family != family) {
                continue;
            }
            for (const std::string& id : strip.pieces) {
                const Piece& piece = *pieces_.at(id);
                const auto sheet = sheet_of_.find(id);
                add("<tr><td>{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td>"
                    "<td class=\"n\">{:.0f} mm</td><td>{}</td></tr>\n",
                    id, sheet == sheet_of_.end() ? "none" : fmt::format("{}", sheet->second),
                    piece.cell_count, piece_length_mm(piece), note_of(strip, id));
            }
        }
        out_ += "</table>\n";
    }

    static std::string note_of(const Strip& strip, const std::string& id) {
        if (strip.pieces.size() == 1 && strip.closed) {
            return "closes to a ring";
        }
        const auto at = std::find(strip.pieces.begin(), strip.pieces.end(), id);
        if (at + 1 != strip.pieces.end()) {
            return "tab to " + *(at + 1);
        }
        if (!strip.next.empty()) {
            return "tab to " + strip.next;
        }
        return strip.closed ? "tab to " + strip.pieces.front() : "";
    }

    void add_warnings() {
        if (job_.warnings.empty()) {
            return;
        }
        out_ += "<h2>Mind</h2>\n<ul>\n";
        for (const std::string& warning : job_.warnings) {
            add("<li>{}</li>\n", escaped(warning));
        }
        out_ += "</ul>\n";
    }

    const JobResult& job_;
    std::map<std::string, const Piece*> pieces_;
    std::map<std::string, int> sheet_of_;
    std::map<int, const Strip*> weft_of_;  // By quad.
    std::map<int, const Strip*> warp_of_;
    std::map<std::size_t, std::size_t> part_of_;  // By cylinder, counted from 1; of several parts.
    std::string out_;
};

}  // namespace

std::string guide_html(const JobResult& job) {
    return GuideWriter(job).write();
}

}  // namespace leafcutter::fab
