// The vertices that cylinders share: singular points, and those along critical arcs.

#pragma once

#include <cstddef>
#include <map>
#include <vector>

#include <Eigen/Core>

#include "geometry/foliation.h"
#include "geometry/quads/critical_arcs.h"
#include "geometry/quads/junction_counts.h"

namespace leafcutter::geometry {

// Numbers them. Both ends of a cylinder that is left out (without rows) have the same ones.
class SharedVertices {
public:
    // Refers to network and counts, which must outlive it.
    SharedVertices(const Foliation& foliation,
                   const ArcNetwork& network,
                   const JunctionCounts& counts);

    const std::vector<Eigen::Vector3d>& positions() const { return positions_; }

    // The vertex of a column at a critical end: 0 for f = 0, 1 for f = height.
    int vertex(int cylinder, std::size_t side, int col) const;

    // How many quads lie round each of them: four, at a singular point twice its prongs, and where
    // vertices came together as many more than four as all of them had.
    std::vector<int> valences(const Foliation& foliation) const;

    std::size_t singular_points() const { return singular_.size(); }

private:
    void number_all(const Foliation& foliation);
    void add_singular(int point, const Foliation& foliation);
    void join_ends();
    int first_number(int cylinder, std::size_t side, int col) const;
    int on_arc(int arc, int place) const;

    const ArcNetwork& network_;
    const JunctionCounts& counts_;
    std::vector<Eigen::Vector3d> positions_;
    std::map<int, int> singular_;  // Critical point to vertex,
    std::vector<int> first_;       // and per arc its first inner vertex, before ends are joined.
    std::vector<int> number_;      // Per vertex before, the vertex.
};

}  // namespace leafcutter::geometry
