// The threads of a quad mesh: runs of cells along one family of leaves.
//
// A weft thread runs along F: it steps across the edges b–c and d–a. A warp thread runs along F*:
// it steps across a–b and c–d. Every quad is in exactly one thread of each family.

#pragma once

#include <vector>

#include "geometry/quads/quad_mesh.h"

namespace leafcutter::geometry {

enum class Family { Weft, Warp };

struct Thread {
    Family family = Family::Weft;
    bool closed = false;      // The last cell touches the first across the right edge.
    std::vector<int> quads;   // In walking order: growing g for weft, growing f for warp, in the
                              // cylinder where the whole run was begun.
    int next = -1;            // The quad behind the last, where a critical leaf ends the thread.
    std::vector<int> leaves;  // Places of quads with a critical leaf before them, which it crosses.
};

enum class ThreadEnds {
    AtCriticalLeaves,  // A warp thread ends at critical leaves of F; the next runs on the same way.
    Through,           // It goes on into the next cylinder where vertices are shared.
};

// All threads of a family, ordered by their smallest quad index. Follows shared edges only, so that
// any grid topology works (twisted tori, conforming junctions).
std::vector<Thread> trace_threads(const QuadMesh& mesh, Family family, ThreadEnds ends);

// The parts of `thread` between the quads at `firsts`, places in its quads in growing order. Of a
// closed thread the first part begins at the first of them, else at its own beginning. None: the
// thread itself.
std::vector<Thread> parted(Thread thread, const std::vector<int>& firsts);

void sort_by_smallest_quad(std::vector<Thread>& threads);

}  // namespace leafcutter::geometry
