// The vertices that rectangles share: zeros, those along sides, and the ends of sides at loops.

#pragma once

#include <map>
#include <vector>

#include <Eigen/Core>

#include "geometry/quads/rectangle_charts.h"

namespace leafcutter::geometry {

class FlankVertices {
public:
    // Keeps the plan by reference.
    // Throws Error(SelfCheck, "quads-topology") unless rows are the same from both sides.
    explicit FlankVertices(const RectanglePlan& plan);

    const std::vector<Eigen::Vector3d>& positions() const { return positions_; }
    // Of zeros and ends of sides: by critical point.
    const std::map<int, int>& stops() const { return stops_; }

    // Of a flank's rows, from the lower loop to the upper.
    std::vector<int> along(const Flank& flank) const;

private:
    void add_side(int cylinder, int number, const std::vector<double>& levels);
    void add_stop(int point);

    const RectanglePlan& plan_;
    std::vector<Eigen::Vector3d> positions_;
    std::map<int, int> stops_;
    std::vector<int> first_;  // Per side its first inner vertex,
    std::vector<int> rows_;   // and its rows.
};

}  // namespace leafcutter::geometry
