// The report and the page of pieces cut again: which, and where they lie.

#include <map>
#include <string>
#include <string_view>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "fab/export/formats.h"
#include "fab/markup.h"
#include "fab/material/totals.h"
#include "fab/nest/shape.h"
#include "fab/package/package_files.h"
#include "fab/package/records.h"
#include "geometry/plane.h"

namespace leafcutter::fab {

using geometry::signed_area;

namespace {

constexpr const char* kStyle =
    "body{font:15px/1.4 sans-serif;margin:2em auto;max-width:50em;color:#222;padding:0 1em}"
    "h1{font-size:1.4em}h2{font-size:1.1em;margin-top:1.5em}table{border-collapse:collapse;"
    "width:100%}th,td{text-align:left;padding:.2em .8em .2em 0;border-bottom:1px solid #ccc}"
    "td.n,th.n{text-align:right}svg{width:100%;height:auto;max-height:70vh;border:1px solid #999;"
    "background:#fff}svg path{vector-effect:non-scaling-stroke;stroke-width:1px}"
    "section{break-inside:avoid}@page{margin:15mm}@media print{body{margin:0;max-width:none}}";

// The sheet as it is cut; of a remnant, with its outline.
std::string drawing(const CutProgram& program, const Sheet& sheet) {
    std::string file = write_svg(program);
    const std::size_t start = file.find("<svg");
    const std::size_t end = file.rfind("</svg>");
    if (start == std::string::npos || end == std::string::npos) {
        return {};
    }
    if (!sheet.outline.empty()) {
        std::string points;
        for (const Eigen::Vector2d& point : sheet.outline) {
            points += fmt::format("{}{:.3f},{:.3f}", points.empty() ? "M" : " ", point.x(),
                                  sheet.size.height_mm - point.y());
        }
        file.insert(end, fmt::format("<path fill=\"none\" stroke=\"#2a8a4a\" "
                                     "stroke-dasharray=\"6 4\" d=\"{}Z\"/>\n",
                                     points));
    }
    return file.substr(start);
}

std::map<std::string_view, const Piece*> index_of(const JobResult& job) {
    std::map<std::string_view, const Piece*> index;
    for (const Piece& piece : job.pieces) {
        index.emplace(piece.id, &piece);
    }
    return index;
}

std::string rows(const JobResult& job) {
    const auto index = index_of(job);
    std::string out;
    for (const Sheet& sheet : job.layout.sheets) {
        for (const Placement& placement : sheet.placements) {
            const Piece& piece = *index.at(placement.piece);
            const Eigen::Vector2d size = bounds(piece.outline).size();
            out += fmt::format(
                "<tr><td><b>{}</b></td><td>{}</td><td>{}</td><td class=n>{}</td>"
                "<td class=n>{:.0f} × {:.0f} mm</td><td class=n>{:.1f} cm²</td></tr>\n",
                escaped(piece.id), escaped(piece.strip), escaped(sheet.material), sheet.id,
                size.x(), size.y(), signed_area(piece.outline) / 100.0);
        }
    }
    return out;
}

}  // namespace

std::string recut_report_json(const JobResult& job) {
    nlohmann::ordered_json pieces = nlohmann::ordered_json::array();
    for (const Piece& piece : job.pieces) {
        pieces.push_back(piece.id);
    }
    nlohmann::ordered_json file = {
        {"format", "leafcutter-report/1"},  {"recut", {{"pieces", std::move(pieces)}}},
        {"input", input_record(job.input)}, {"nesting", nesting_record(job.layout)},
        {"cut", cut_record(job)},           {"warnings", nlohmann::ordered_json::array()}};
    add_makings(job, file);
    return report_text(file);
}

std::string recut_html(const JobResult& job) {
    std::string out = fmt::format(
        "<!DOCTYPE html>\n<html lang=en><meta charset=utf-8><title>Cut again: {0}</title>\n"
        "<style>{1}</style>\n<h1>Cut again: {2} piece{3} of {0}</h1>\n",
        escaped(job.input.file), kStyle, job.pieces.size(), job.pieces.size() == 1 ? "" : "s");
    out +=
        "<table><tr><th>Piece</th><th>Strip</th><th>Material</th><th class=n>Sheet</th>"
        "<th class=n>Size</th><th class=n>Area</th></tr>\n";
    out += rows(job) + "</table>\n";
    for (std::size_t i = 0; i < job.programs.size(); ++i) {
        const CutProgram& program = job.programs[i];
        out += fmt::format(
            "<section><h2>Sheet {}: {}, {:g} × {:g} mm, about {:.0f} s</h2>\n{}</section>\n",
            program.sheet, escaped(program.material), program.size.width_mm, program.size.height_mm,
            program.estimated_s, drawing(program, job.layout.sheets[i]));
    }
    return out + "</html>\n";
}

}  // namespace leafcutter::fab
