#include "geometry/pants/decomposition.h"

#include <utility>

#include <fmt/format.h>

#include "geometry/error.h"
#include "geometry/pants/initial_map.h"
#include "geometry/pants/reeb_graph.h"
#include "geometry/pants/sweep_function.h"

namespace leafcutter::geometry {
namespace {

const char* name_of(SweepFunction function) {
    switch (function) {
        case SweepFunction::X:
            return "x";
        case SweepFunction::Y:
            return "y";
        case SweepFunction::Z:
            return "z";
        case SweepFunction::Fiedler:
            return "fiedler";
        case SweepFunction::Auto:
        case SweepFunction::Harmonic:
            break;
    }
    return "harmonic";
}

std::vector<SweepFunction> functions_of(SweepFunction function) {
    if (function != SweepFunction::Auto) {
        return {function};
    }
    return {SweepFunction::Harmonic, SweepFunction::X, SweepFunction::Y, SweepFunction::Z,
            SweepFunction::Fiedler};
}

GraphMap reeb_map(const DecompositionSurface& surface, SweepFunction function, int attempt) {
    const SweepValues sweep = sweep_values(surface, function, attempt);
    const ReebGraph reeb = build_reeb_graph(surface.triangles, sweep.values, surface.boundary_loops,
                                            sweep.loop_is_low, attempt);
    return initial_map(reeb, surface.rings, surface.boundary_loops);
}

}  // namespace

std::vector<PantsCandidate> pants_candidates(const DecompositionSurface& surface,
                                             PantsSource source,
                                             SweepFunction function,
                                             int attempt,
                                             const Context& context) {
    if (source != PantsSource::Reeb || !surface.cuts.empty()) {
        throw Error(ErrorKind::NotSupported, "pants-cuts",
                    "pants: cutting along loops is not built yet");
    }
    std::vector<PantsCandidate> candidates;
    std::string reasons;
    for (const SweepFunction one : functions_of(function)) {
        context.check();
        try {
            candidates.push_back(
                {fmt::format("reeb-{}", name_of(one)), reeb_map(surface, one, attempt)});
        } catch (const Error& error) {
            reasons += fmt::format("; {}: {}", name_of(one), error.what());
        }
    }
    if (candidates.empty()) {
        throw Error(ErrorKind::SelfCheck, "pants-graph",
                    fmt::format("pants: no function gives a sound graph{}", reasons));
    }
    return candidates;
}

}  // namespace leafcutter::geometry
