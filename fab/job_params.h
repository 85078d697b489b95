// Everything a job can be told, as typed values with the defaults of the documentation. JSON comes
// and goes in server/params; nothing here knows of it.

#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "fab/material/stock.h"
#include "fab/nest/rotations.h"
#include "geometry/foliation.h"
#include "geometry/quads/quad_mesh.h"

namespace leafcutter::fab {

struct ScaleParams {
    // The input's longest bounding box side becomes this long; without it, input units are mm.
    std::optional<double> longest_side_mm = 300.0;
};

struct PunctureParams {
    int vertex = 0;
    double radius_mm = 0.0;  // On the surface.
};

// A boundary loop: its number as `leafcutter inspect` lists them, or else some of its vertices.
struct LoopParams {
    std::optional<int> number;
    std::vector<int> vertices;
};

// A place on the surface: a vertex, or the one nearest to a position in units of the input file.
struct PlaceParams {
    std::optional<int> vertex;
    std::array<double, 3> position{};  // Without `vertex`.
};

// The foliation section as written: vertex numbers are those of the input file.
struct FoliationParams {
    geometry::FoliationMode mode = geometry::FoliationMode::Auto;
    geometry::TorusRings torus_rings = geometry::TorusRings::Short;
    std::optional<std::array<int, 4>> corners;

    geometry::PantsSource pants = geometry::PantsSource::Reeb;
    std::vector<std::vector<int>> loops;   // PantsSource::User only.
    std::vector<std::vector<int>> forbid;  // Ways round the surface that no cylinder may go.
    geometry::SweepFunction function = geometry::SweepFunction::Auto;
    std::optional<std::vector<double>> weights;  // Of the graph's edges; else automatic.

    std::optional<std::array<int, 2>> poles;
    std::vector<PlaceParams> near;  // Where singular points are wanted.
    std::vector<LoopParams> sources;
    std::vector<LoopParams> sinks;

    geometry::PunctureChoice puncture = geometry::PunctureChoice::Auto;
    std::vector<PunctureParams> punctures;  // PunctureChoice::Given only.
    geometry::Components components = geometry::Components::Each;
};

enum class WeavePattern { Plain, Twill2x2, DoubleWarp, DoubleWeft, Satin5, Basket2x2, Matrix };

struct WeaveParams {
    WeavePattern pattern = WeavePattern::Plain;
    std::vector<std::vector<int>> matrix;  // Matrix only: rows of 0 and 1, 1 = warp on top.
    std::optional<int> max_float;          // Cells; see float_limit (floats.h).
};

enum class ColumnRuns { PerCylinder, Through };
enum class CellMarks { Ticks, Lines, None };

// How pieces are joined end to end. Glue: a tab of `tab_mm` under the next piece. Cell: the tab is
// a whole cell. Slot: an arrow put through a slit in the next piece, which holds without glue.
enum class Joint { Glue, Cell, Slot };

struct FitParams {
    ColumnRuns columns = ColumnRuns::PerCylinder;
    double clearance_mm = 0.2;    // Taken off each long side of a strip.
    bool clearance_auto = false;  // As much as the materials' thickness needs, instead.
    bool crimp = true;            // Lengthen cells for the way over and under crossing strips.
    Joint joint = Joint::Glue;
    double tab_mm = 8.0;  // Length of glue tabs.
    double max_piece_mm = 900.0;
    bool labels = true;
    CellMarks cell_marks = CellMarks::Ticks;
    bool weave_marks = true;  // A bar on every cell that lies under its crossing strip.
    double score_deg = 15.0;  // Cells that bend further are scored on their diagonal.
    double text_mm = 4.0;     // Largest height of engraved text.
};

struct MaterialParams {
    std::string warp = "paper-160-blue";
    std::string weft = "paper-160-yellow";
};

enum class Rotation { Free, Half, Quarter, Fixed };  // Any; 0,180; 0,90,180,270; 0.

// Rotations of some pieces: of one ("W12.1"), of a strip ("W12") or of a family ("weft").
struct PieceTurns {
    std::string of;
    Rotations turns;
};

struct NestingParams {
    double time_s = 10.0;
    double spacing_mm = 1.0;
    double margin_mm = 5.0;
    Rotation rotation = Rotation::Free;
    std::optional<Rotations> turns;       // Instead of `rotation`; relative to the grain.
    std::vector<PieceTurns> piece_turns;  // Instead of both; a piece before its strip and family.
    std::vector<StockItem> stock;         // Taken before new sheets where that costs less.
    bool only_stock = false;              // No new sheets.
    std::uint32_t seed = 1;
};

struct CutParams {
    double lead_in_mm = 0.0;            // Way in the waste before a contour, where there is room.
    std::optional<double> over_cut_mm;  // Past the start of a contour; else as the material asks.
    int tabs = 0;                       // Bridges that hold each piece in its sheet,
    double tab_mm = 0.5;                // each so long.
    bool common_edges = false;          // Edges of two pieces a kerf apart are cut once.
    double heat = 0.0;  // 0: shortest way; to 1: less heat in one place for longer ways.
};

enum class Dialect { Grbl, Marlin, Smoothie };
enum class Paper { A4, A3, Letter };

struct OutputParams {
    Dialect dialect = Dialect::Grbl;
    std::string device;
    std::string machine;      // Of the materials' settings; empty: their defaults.
    Paper paper = Paper::A4;  // Of the pages for scissors.
    bool models = true;       // The woven model as STL, OBJ and glTF.
};

struct JobParams {
    ScaleParams scale;
    FoliationParams foliation;
    geometry::GridOptions grid;
    WeaveParams weave;
    FitParams fit;
    MaterialParams material;
    NestingParams nesting;
    CutParams cut;
    OutputParams output;
};

}  // namespace leafcutter::fab
