// A job as the pipeline leaves it, made by hand of a quad mesh: straight pieces, one for each
// strip, all on one sheet.

#pragma once

#include <algorithm>

#include "fab/job_result.h"
#include "fab/strips/crossings.h"
#include "fab/strips/strips.h"
#include "fab/weave/weave.h"
#include "simple_assembly.h"

namespace leafcutter::test {

inline fab::Piece straight_piece(const fab::Strip& strip, double width_mm) {
    fab::Piece piece;
    piece.id = strip.id + ".1";
    piece.strip = strip.id;
    piece.family = strip.family;
    piece.cell_count = static_cast<int>(strip.quads.size());
    for (int i = 0; i <= piece.cell_count; ++i) {
        piece.left.emplace_back(i * width_mm, width_mm);
        piece.right.emplace_back(i * width_mm, 0.0);
    }
    piece.cut_left = piece.left;
    piece.cut_right = piece.right;
    double end = piece.cell_count * width_mm;
    if (strip.closed) {
        piece.end_tab.length_mm = 8.0;
        piece.end_tab.onto = piece.id;
        end += 8.0;
    }
    piece.outline = {{0.0, 0.0}, {end, 0.0}, {end, width_mm}, {0.0, width_mm}};
    fab::Mark name;
    name.text = piece.id + ">";
    name.at = {1.0, 3.0};
    name.height_mm = 3.0;
    piece.marks.push_back(name);
    return piece;
}

inline fab::JobResult grid_job(geometry::QuadMesh mesh, double width_mm = 10.0) {
    fab::JobResult job;
    job.input.file = "grid.obj";
    job.quads = std::move(mesh);
    job.strips = fab::make_strips(job.quads, fab::ColumnRuns::PerCylinder);
    job.weave = fab::weave_cells(job.quads, job.params.weave);
    job.crossings = fab::crossings_of(job.strips, job.weave);
    job.weft.name = job.warp.name = "Paper";
    job.weft.colour = "#f2c94c";
    job.warp.colour = "#2d4f93";
    fab::Sheet sheet;
    sheet.family = "both";
    sheet.size = {600.0, 400.0};
    double y = 5.0;
    for (fab::Strip& strip : job.strips) {
        job.pieces.push_back(straight_piece(strip, width_mm));
        strip.pieces = {job.pieces.back().id};
        sheet.placements.push_back({job.pieces.back().id, 5.0, y, 0.0, false});
        y += width_mm + 1.0;
    }
    job.layout.sheets.push_back(std::move(sheet));
    job.assembly = simple_assembly(job.quads, job.strips, job.pieces);
    return job;
}

}  // namespace leafcutter::test
