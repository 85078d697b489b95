// Whether strips of real thickness can be bent and passed as the weave wants it, told before
// anything is cut. Lengths are mm.

#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "fab/strips/crossings.h"
#include "fab/strips/strip.h"
#include "fab/weave/assembly.h"
#include "fab/weave/thickness.h"
#include "fab/weave/woven_model.h"
#include "geometry/quads/quad_mesh.h"

namespace leafcutter::fab {

// A radius of 0 says: not bent at all.
struct StripBend {
    int changes = 0;                 // Of side.
    double crimp_mm = 0.0;           // Longer by this for them.
    double surface_radius_mm = 0.0;  // Tightest bend that the surface asks of it, and of its folds.
    int surface_cell = 0;            // Where.
    double radius_mm = 0.0;          // The tightest with the way over and under.
    int cell = 0;
    bool too_tight = false;  // Tighter than its material takes.
    bool too_short = false;  // Somewhere two crossings are too near to get from over to under.
};

struct FamilyThickness {
    double thickness_mm = 0.0;
    double crossed_mm = 0.0;     // Thickness of what it crosses.
    double min_radius_mm = 0.0;  // Of its material.
    double gap_mm = 0.0;         // Between strips that it crosses,
    double needed_gap_mm = 0.0;  // what it needs to get through,
    double flat_gap_mm = 0.0;    // and to lie flat on what it crosses.
    double joint_mm = 0.0;       // Thickness of its joints, 0 without any.
    double lift_mm = 0.0;        // Else edges of crossing strips give way by this.
    int changes = 0;             // Of side, of all strips.
    double crimp_mm = 0.0;       // What they cost in all.
    double least_radius_mm = 0.0;
    std::string tightest;  // The strip bent to it.
};

struct ThicknessReport {
    double clearance_mm = 0.0;
    ClearanceNeed need;
    std::array<FamilyThickness, 2> families;  // Weft, warp.
    std::vector<StripBend> strips;
};

struct ThicknessRules {
    std::array<SheetFeel, 2> feel;  // Of weft and warp.
    std::array<bool, 2> joined{};   // Pieces lie doubled at joints.
    double clearance_mm = 0.0;
};

ThicknessReport judge_thickness(const geometry::QuadMesh& mesh,
                                std::span<const Strip> strips,
                                const Crossings& crossings,
                                const ThicknessRules& rules);

// What of it hands will not be able to do, strips named: empty if all is well.
std::vector<std::string> thickness_warnings(const ThicknessReport& report,
                                            std::span<const Strip> strips,
                                            const WovenModel& model);

// Strips that must be pushed through holes for which parts of them are much too wide. A hole is as
// wide as the cell in which it lies.
std::vector<std::string> threading_warnings(const geometry::QuadMesh& mesh,
                                            std::span<const Strip> strips,
                                            const Assembly& assembly,
                                            double clearance_mm);

}  // namespace leafcutter::fab
