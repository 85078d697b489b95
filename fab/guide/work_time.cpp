#include "fab/guide/work_time.h"

namespace leafcutter::fab::guide {

double working_time_s(const JobResult& job, const HandTimes& times) {
    double seconds = times.per_piece * static_cast<double>(job.pieces.size()) +
                     times.per_crossing * static_cast<double>(job.quads.quads.size());
    for (const AssemblyMove& move : job.assembly.moves) {
        const bool joins = move.kind == MoveKind::Close || move.kind == MoveKind::Join;
        seconds +=
            joins ? times.per_joint : times.per_threaded * static_cast<double>(move.held.size());
    }
    return seconds;
}

}  // namespace leafcutter::fab::guide
