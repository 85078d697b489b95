// Cuts the disks of punctures out of a surface. Internal to punctures.

#pragma once

#include <array>
#include <map>
#include <utility>
#include <vector>

#include "geometry/puncture_site.h"
#include "geometry/punctures.h"

namespace leafcutter::geometry {

// Cuts the triangles on the rim of each hole and leaves out those inside.
class PunctureCutter {
public:
    // Keeps the site by reference.
    PunctureCutter(const PunctureSite& site,
                   const std::vector<Ball>& balls,
                   const std::vector<Disk>& disks);

    void cut();

    // Of each hole, the vertices on its rim in any order.
    const std::vector<std::vector<int>>& rims() const { return rims_; }

    // The surface cut. Throws Error(SelfCheck, "broken-hole") if a rim is not one simple loop.
    OpenedMesh finish();

private:
    bool is_inside(int vertex) const;
    int crossing(int inside, int outside);
    void keep_two(const std::array<int, 3>& triangle);
    void drop_unused();

    const PunctureSite& site_;
    std::vector<int> hole_;         // Per vertex the hole it lies in, or -1.
    std::vector<double> distance_;  // Per vertex, from the middle of the hole nearby.
    std::map<std::pair<int, int>, int> crossings_;
    std::vector<std::vector<int>> rims_;
    OpenedMesh out_;
};

}  // namespace leafcutter::geometry
