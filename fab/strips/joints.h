// Where a joint of a strip shows least.

#pragma once

#include <array>
#include <span>
#include <vector>

#include "fab/strips/crossings.h"
#include "fab/strips/strip.h"
#include "fab/strips/unfold.h"
#include "geometry/quads/quad_mesh.h"

namespace leafcutter::fab {

// The joints made so far on a mesh, so that those of neighbouring strips don't line up; and its
// irregular vertices, next to which strips have kinks. Strips share the vertices of their sides.
class JointMap {
public:
    explicit JointMap(const geometry::QuadMesh& mesh);

    bool irregular(int vertex) const { return irregular_[static_cast<std::size_t>(vertex)] != 0; }

    // From 0, no joint near, to 1: one of the same family ends at this vertex.
    double crowding(Family family, int vertex) const {
        return crowding_[index(family)][static_cast<std::size_t>(vertex)];
    }

    // A joint before cell `cell` of `cells`.
    void add(const Strip& strip, const std::vector<WalkedCell>& cells, int cell);

private:
    static std::size_t index(Family family) { return family == Family::Weft ? 0 : 1; }

    std::vector<char> irregular_;
    std::array<std::vector<double>, 2> crowding_;
};

struct JointPlace {
    const Strip& strip;
    const std::vector<WalkedCell>& cells;
    const Unfolded& whole;  // All cells of the strip, of a closed one its first once more.
    std::span<const Crossing> crossings;  // Per cell; may be empty.
    double tab_mm = 0.0;                  // Laid on the cells behind the joint.
    const JointMap* joints = nullptr;
};

// Per cell of the strip what a joint before it costs; about 1 for each thing that speaks against
// it: its tab lies where the strip is on top and seen, a turn of 20 degrees, a kink, a joint beside
// it.
std::vector<double> joint_costs(const JointPlace& place);

// Turning of the middle line at rung `rung` of an unfolding, degrees, to the left; 0 at its ends.
double turning_deg(const Unfolded& flat, std::size_t rung);

}  // namespace leafcutter::fab
