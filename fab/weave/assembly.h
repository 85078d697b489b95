// In which order hands (or a robot) put strips together, so that each can be placed when its turn
// comes.
//
// A strip lies in the weave from its first crossing on. It can be laid where every strip it crosses
// still has a free end on that side: that strip is folded back, the new one laid, the other folded
// over it ("frontier"). Else it has to be threaded: pushed through lengthwise, under and over what
// lies there already. A closed strip stays open until its own move to close it; joints between
// regions come last.

#pragma once

#include <span>
#include <string>
#include <vector>

#include "fab/strips/crossings.h"
#include "fab/strips/strip.h"
#include "fab/weave/weave.h"
#include "geometry/quads/quad_mesh.h"

namespace leafcutter::fab {

enum class MoveKind {
    Lay,     // The strip is laid over and under what is there; all of that is folded back first.
    Thread,  // The strip is pushed through lengthwise.
    Close,   // The two ends of a piece or strip are joined.
    Join,    // A piece's tab is joined to another piece: of the same strip or the next one.
};

struct AssemblyMove {
    MoveKind kind = MoveKind::Lay;
    int region = 0;          // Into Assembly::regions.
    int strip = 0;           // Into the list of strips.
    std::vector<int> cells;  // Lay, Thread: the strip's cells whose crossings come to be, in order.
    std::string piece;       // Close, Join: the piece whose tab is joined,
    std::string onto;        // and the one that it is joined to.
};

// What is woven in one go: usually one cylinder.
struct AssemblyRegion {
    std::vector<int> cylinders;
    int part = 0;  // Of the model.
};

struct Assembly {
    std::vector<AssemblyRegion> regions;
    std::vector<AssemblyMove> moves;  // Region after region, then the joints between them.
    int threaded = 0;                 // Moves that need threading,
    int longest_thread = 0;           // and over how many crossings at most.
};

Assembly plan_assembly(const geometry::QuadMesh& mesh,
                       std::span<const Strip> strips,
                       std::span<const Piece> pieces,
                       const Crossings& crossings);

}  // namespace leafcutter::fab
