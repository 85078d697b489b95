// The cuts of a sheet in the order they are made: common edges, tabs, where each contour starts,
// and the ways in and past its start.

#pragma once

#include <map>
#include <string>
#include <vector>

#include "fab/cut/cut_heat.h"
#include "fab/cut/cut_program.h"
#include "fab/job_params.h"
#include "fab/layout.h"
#include "fab/nest/collision.h"
#include "geometry/context.h"

namespace leafcutter::fab {

// What there is to cut, in sheet mm.
struct CutContours {
    std::vector<CutPath> outer;  // Round pieces, counter-clockwise; waste on their right.
    std::vector<CutPath> inner;  // Slits and holes of pieces.
    std::vector<Ring> outlines;  // Of the pieces themselves, before kerf.
    std::map<std::string, std::vector<Segment>> marks;  // Lines on each piece, slits too.
};

struct CutWishes {
    CutParams params;
    double over_cut_mm = 0.0;
    double kerf_mm = 0.0;
    HeatOptions cooling;
    Eigen::Vector2d from = Eigen::Vector2d::Zero();  // Where the beam stands.
};

struct PlannedCuts {
    std::vector<CutPath> paths;
    CutFacts facts;
};

PlannedCuts plan_cuts(const Sheet& sheet,
                      CutContours contours,
                      const CutWishes& wishes,
                      const geometry::Context& context);

}  // namespace leafcutter::fab
