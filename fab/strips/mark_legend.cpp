#include "fab/strips/labels.h"
#include "fab/strips/marks.h"

namespace leafcutter::fab {

namespace {

// Pictures of single marks stand on a piece of strip, which is drawn with them.
std::vector<Polyline> on_cell(std::vector<Polyline> lines) {
    lines.push_back({{0.0, 0.0}, {1.2, 0.0}});
    lines.push_back({{0.0, 1.0}, {1.2, 1.0}});
    return lines;
}

void add_texts(std::vector<LegendEntry>& legend) {
    legend.push_back({"W12.1 with an arrow, at both ends of a piece",
                      "strip W12 (W = weft, P = warp), its piece 1; the text reads the way the "
                      "strip is numbered and woven, the arrow points on to its next crossing",
                      text_strokes("W12.1>")});
    legend.push_back({"flag of the arrow",
                      "it flies on the left of the arrow on the engraved side: that side is the "
                      "outside of the finished shape",
                      text_strokes(">")});
    legend.push_back({"+W12.2 at a tab",
                      "this end goes under the start of piece W12.2 and is joined to it; a plus "
                      "alone: under the piece's own start",
                      text_strokes("+W12.2")});
    legend.push_back({"P7 inside a cell",
                      "strip P7 crosses here; between two such ids count cell by cell",
                      text_strokes("P7")});
}

}  // namespace

std::vector<LegendEntry> mark_legend(const FitParams& fit) {
    std::vector<LegendEntry> legend;
    if (fit.labels) {
        add_texts(legend);
    }
    if (fit.cell_marks == CellMarks::Ticks) {
        legend.push_back({"ticks on both edges",
                          "one crossing ends and the next begins: crossing strips lie between",
                          on_cell({{{0.6, 0.05}, {0.6, 0.2}}, {{0.6, 0.8}, {0.6, 0.95}}})});
    } else if (fit.cell_marks == CellMarks::Lines) {
        legend.push_back({"line from edge to edge",
                          "one crossing ends and the next begins: crossing strips lie between",
                          on_cell({{{0.6, 0.05}, {0.6, 0.95}}})});
    }
    if (fit.weave_marks) {
        legend.push_back({"single short bar across the strip, between two pairs of ticks",
                          "the crossing strip goes over this one here (beside a text the bar moves "
                          "aside); cells without a bar lie on top",
                          on_cell({{{0.6, 0.38}, {0.6, 0.62}}})});
    }
    legend.push_back({"scored line from corner to corner of a cell", "fold here a little",
                      on_cell({{{0.15, 0.1}, {1.05, 0.9}}})});
    legend.push_back({"line across the strip near its end",
                      "the tab begins here; the other piece reaches up to this line",
                      on_cell({{{0.6, 0.05}, {0.6, 0.95}}, {{1.2, 0.0}, {1.2, 1.0}}})});
    return legend;
}

}  // namespace leafcutter::fab
