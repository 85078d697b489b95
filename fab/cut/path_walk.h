// Places on a cut path by their distance along it, in mm from its first point.

#pragma once

#include <vector>

#include <Eigen/Core>

#include "fab/cut/cut_program.h"

namespace leafcutter::fab {

bool is_closed(const CutPath& path);

double length_mm(const Polyline& points);

// Distance along the points for each of them.
std::vector<double> stations_mm(const Polyline& points);

// `stations_mm` of these points; `at_mm` in [0, length].
Eigen::Vector2d point_at(const Polyline& points,
                         const std::vector<double>& stations_mm,
                         double at_mm);

// From one distance to a larger one, with the corners between.
Polyline stretch(const Polyline& points, double from_mm, double to_mm);

// A closed path that begins `at_mm`; an open one as it is. Lead-in and over-cut are not moved:
// they belong to the start. `at_mm` lies in no tab.
CutPath started_at(CutPath path, double at_mm);

// The same burnt the other way round.
CutPath reversed(CutPath path);

// The parts of the path between its tabs, in order: all of it if there is none.
std::vector<Polyline> burnt_runs(const CutPath& path);

// The same for drawings: a closed path's last run goes on with its first, whatever its start.
std::vector<Polyline> drawn_runs(const CutPath& path);

}  // namespace leafcutter::fab
