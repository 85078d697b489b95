// In which order hands (or a robot) put strips together, so that each can be placed when its turn
// comes, and a check of any such order.
//
// The model. Strips lie on the surface, seen from outside; what comes is laid from outside. Where a
// new strip lies over one that is there, it just lies on it. Where it lies under one, that one must
// be folded back from the crossing to one of its ends, the new one laid, and the other folded over
// it. A strip T can be folded back from a cell if between there and a free end of it no other strip
// that is placed lies over it ("holds" it): what lies under it is left behind. An end is free until
// it is joined to something. So a closed ring, or one held on both sides, can't be folded back:
// there the new strip has to be threaded, pushed through lengthwise.
//
// What is laid in one move is a run of pieces of a strip, joined on the table before. It is laid
// cell by cell from one end to the other, so that a strip may cross another one several times.
//
// A joint is made on the table (before either piece is laid), or in place. In place its tab goes
// under the first cells of the piece that it is joined to; where something there can't be folded
// back, the tab is tucked in between: possible, as the end that it is pushed under is free.

#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "fab/parts.h"
#include "fab/strips/crossings.h"
#include "fab/strips/strip.h"
#include "fab/weave/weave.h"
#include "geometry/quads/quad_mesh.h"

namespace leafcutter::fab {

enum class MoveKind {
    Lay,     // Pieces are laid over and under what is there; all of that is folded back first.
    Thread,  // The same, but at the `held` cells they are pushed through lengthwise.
    Close,   // The last joint of a closed strip: it becomes a ring.
    Join,    // Any other joint: of two pieces of a strip, of a strip with the next one or a rim.
};

struct AssemblyMove {
    MoveKind kind = MoveKind::Lay;
    int region = 0;  // Into Assembly::regions.
    int strip = 0;   // Into the list of strips. Joints: the strip whose end has the tab.

    // Lay, Thread:
    std::vector<std::string> pieces;  // Laid together, in walking order.
    std::vector<int> cells;           // The strip's cells whose crossings come to be, in the order
                                      // in which they are laid; runs down if laid from the end.
    std::vector<int> held;            // Those of `cells` that have to be threaded.

    // Close, Join:
    std::string piece;      // Its end is joined
    std::string onto;       // to the start of this one. Where cylinders are only glued to each
                            // other (GluedEnd): to this one's rim; empty: to several.
    bool at_start = false;  // Glued only: the start of `piece` is joined, not its end.
    bool in_place = false;  // Else on the table, before either piece is laid.
    int tucked = 0;         // Crossing strips under which the tab has to be pushed.
};

// What is woven in one go: a cylinder, or all those that strips run through.
struct AssemblyRegion {
    std::vector<int> cylinders;
    int part = 0;                // Of the model; 0 if parts are not known.
    Family base = Family::Warp;  // Laid first, side by side; the other family is woven into it.
};

struct Assembly {
    std::vector<AssemblyRegion> regions;  // In the order of work: neighbours follow each other.
    std::vector<AssemblyMove> moves;      // Region after region, then the joints between them.
    int laid = 0;                         // Moves that lay without threading,
    int threaded = 0;                     // those that need it,
    int threaded_crossings = 0;           // over how many crossings in all,
    int longest_thread = 0;               // and at most in one move.
    int table_joints = 0;
    int place_joints = 0;  // Closed rings among them.
    int tucked_joints = 0;
};

// Every crossing is made exactly once, every piece laid once, every joint made once. Moves that lay
// come as few that thread as the search finds; none is impossible. `parts` may be empty.
Assembly plan_assembly(const geometry::QuadMesh& mesh,
                       std::span<const Strip> strips,
                       std::span<const Piece> pieces,
                       const Crossings& crossings,
                       std::span<const Part> parts = {});

struct AssemblyFault {
    int move = -1;  // Into Assembly::moves; their number if something is missing at the end.
    std::string what;
};

// Plays the moves on a model of pieces and ends that shares nothing with the planner, and returns
// the first that hands can't make as it says, or what is missing at the end.
std::optional<AssemblyFault> check_assembly(std::span<const Strip> strips,
                                            std::span<const Piece> pieces,
                                            const Crossings& crossings,
                                            const Assembly& assembly);

}  // namespace leafcutter::fab
