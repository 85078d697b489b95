// What thickness asks of a weave: longer strips, gaps between neighbours, bends that a material
// takes. All lengths are mm.
//
// The way of a strip's middle from over to under, in the plane along it: flat, an arc, an arc back,
// flat again. It climbs by half of both thicknesses: at each crossing the two middles lie the mean
// thickness apart, and both families share that evenly, as in Peirce, "The geometry of cloth
// structure", J. Textile Inst. 28 (1937), where the heights of both crimps add up to the sum of
// both diameters. Peirce's round threads touch along arcs; strips lie flat on each other, so that
// all of the climb is between the edge of one crossing strip and that of the next. The arcs are as
// wide as this gap allows. Where the material does not bend that tightly they reach over the
// crossing strips, whose edges give way by `lift_mm`.

#pragma once

#include <span>
#include <vector>

#include "fab/strips/crossings.h"

namespace leafcutter::fab {

struct CrimpRule {
    double own_mm = 0.0;         // Thickness of the strip,
    double crossed_mm = 0.0;     // of those that it crosses,
    double gap_mm = 0.0;         // and how far those are apart: twice the clearance.
    double min_radius_mm = 0.0;  // Tightest bend of the strip's middle that its material takes.
};

// One way from a side to the other.
struct CrimpPath {
    double climb_mm = 0.0;
    double run_mm = 0.0;       // Along the surface.
    double radius_mm = 0.0;    // Of both arcs, of the strip's middle. 0: there is no climb.
    double angle_rad = 0.0;    // Of each arc.
    double straight_mm = 0.0;  // Between them; upright, and only where the climb exceeds the run.
    double lift_mm = 0.0;      // How far the crossing strips' edges are in its way.

    double length_mm() const { return 2.0 * radius_mm * angle_rad + straight_mm; }
    double extra_mm() const { return length_mm() - run_mm; }
};

// `spacing_mm` lies between the middles of the two crossings: no run is longer, even if the bend is
// too tight then.
CrimpPath crimp_path(const CrimpRule& rule, double spacing_mm);

// The least gap between crossing strips in which arcs of the least radius have room: the strip then
// lies flat on what it crosses. Does not look at rule.gap_mm.
double flat_gap_mm(const CrimpRule& rule);

// How much longer each cell of a strip has to be for its way over and under. `crossings` are the
// strip's, in walking order, `cell_lengths_mm` along its middle line. Only a change of side between
// one crossing and the next costs length, half of it in either cell; floats and double layers cost
// none. In a closed strip the last crossing comes before the first.
std::vector<double> crimp_extra_mm(std::span<const Crossing> crossings,
                                   std::span<const double> cell_lengths_mm,
                                   const CrimpRule& rule,
                                   bool closed);

// The least clearances, taken off each long side of every strip, with which two materials can be
// woven.
struct ClearanceNeed {
    double pass_mm = 0.0;  // A strip fits through the gap at all; a little more than its thickness.
    double joint_mm = 0.0;  // So do joints, where a strip lies doubled.
    double flat_mm = 0.0;   // Strips lie flat on each other, bent no tighter than they may.
};

struct SheetFeel {
    double thickness_mm = 0.0;
    double min_radius_mm = 0.0;
};

ClearanceNeed clearance_need(const SheetFeel& weft, const SheetFeel& warp);

// The clearance for strips of this width if nobody names one: flat, if that takes no more than a
// twentieth of the width, but always enough for joints to pass.
double automatic_clearance_mm(const ClearanceNeed& need, double strip_width_mm);

}  // namespace leafcutter::fab
