// Strips and the flat pieces they are cut from. All lengths are millimetres.

#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <Eigen/Core>

#include "geometry/quads/threads.h"

namespace leafcutter::fab {

using geometry::Family;
using Ring =
    std::vector<Eigen::Vector2d>;  // Simple, counter-clockwise, closing point not repeated.
using Polyline = std::vector<Eigen::Vector2d>;

// An end that meets another cylinder without sharing vertices with it.
struct GluedEnd {
    bool has_tab = false;     // The tab is on this side of the joint.
    std::string onto;         // The strip that it lies on; empty: on several.
    bool onto_start = false;  // On its first piece, else on its last.
};

struct Strip {
    std::string id;  // "W12" for weft, "P7" for warp; numbered from 1 in each family.
    Family family = Family::Weft;
    std::vector<int> cylinders;
    bool closed = false;
    std::vector<int> quads;   // In walking order.
    std::string next;         // The strip that its end is joined to, across a critical leaf,
    std::vector<int> beyond;  // and quads there, going on, for the tab to lie on.
    bool follows = false;     // Another strip's `next` is this one.
    GluedEnd glued_start;
    GluedEnd glued_end;
    std::vector<std::string> pieces;  // Ids, in walking order.
};

// The diagonal on which a cell folds; None: the quad is planar to 1e-6 of its size.
enum class Bend { None, Ac, Bd };

enum class Operation { Engrave, Score, Cut };

// Something burnt that does not cut: a line, or text drawn with the stroke font.
struct Mark {
    Operation operation = Operation::Engrave;
    Polyline path;                                 // Empty for text.
    std::string text;                              // Empty for a line.
    Eigen::Vector2d at = Eigen::Vector2d::Zero();  // Text: left end of its base line.
    double angle_deg = 0.0;
    double height_mm = 0.0;
};

// Material past an end of a piece that is joined to another.
struct Tab {
    double length_mm = 0.0;      // 0: there is none.
    std::string onto;            // The piece that it is joined to; empty: several, or not known.
    double slit_at_mm = 0.0;     // Joint::Slot: how far behind the joint its slit lies there,
    double slit_width_mm = 0.0;  // and how wide; 0: it is glued.
};

struct Piece {
    std::string id;  // "W12.1"
    std::string strip;
    Family family = Family::Weft;
    int first_cell = 0;  // Into the strip's quads; closed strips wrap.
    int cell_count = 0;
    Polyline left;  // cell_count + 1 rung ends: exact unfolding, isometric over `bend`.
    Polyline right;
    std::vector<Bend> bend;        // Per cell.
    std::vector<double> fold_deg;  // Per cell: how far it bends on its diagonal.
    std::vector<char> fold_rises;  // Per cell: on the diagonal from its first right rung end.
    Tab start_tab;                 // Before the first rung.
    Tab end_tab;                   // Behind the last one.
    Ring outline;                  // What is cut, before kerf: with clearance, crimp, tabs.
    Polyline cut_left;             // The rung ends as they come to lie on the outline.
    Polyline cut_right;
    std::vector<Mark> marks;     // Inside the outline.
    std::vector<Polyline> cuts;  // Slits inside it: the beam's way, kerf counted.
};

}  // namespace leafcutter::fab
