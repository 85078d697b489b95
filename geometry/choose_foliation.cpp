#include "geometry/choose_foliation.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <exception>
#include <iterator>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "geometry/choose_holes.h"
#include "geometry/foliate_part.h"
#include "geometry/surface_measures.h"

namespace leafcutter::geometry {
namespace {

// A pillowcase needs no hole and weaves the whole surface with closed threads: it may be this much
// less even than other foliations.
constexpr double kPillowcaseVariation = 2.0;
constexpr double kPillowcaseLargest = 9.0;
// Holes must make the logarithm of the largest cells smaller by this factor.
constexpr double kWorthHoles = 0.6;
// Parts of the progress.
constexpr double kWhole = 0.45;
constexpr double kTried = 0.55;

Context section(const Context& context, double from, double to) {
    Context part = context;
    if (context.progress) {
        part.progress = [&context, from, to](std::string_view stage, double fraction) {
            context.progress(stage, from + (to - from) * fraction);
        };
    }
    return part;
}

// What the options ask for, also without saying it.
FoliationMode wished_mode(const SurfacePart& part, const FoliationOptions& options) {
    const bool may_be_disk =
        options.mode == FoliationMode::Auto || options.mode == FoliationMode::Disk;
    if (options.corners && (natural_mode(part) != FoliationMode::Disk || !may_be_disk)) {
        throw Error(ErrorKind::BadOption, "bad-corners",
                    fmt::format("foliation.corners: only a disk has corners, the model is {}",
                                describe(part)));
    }
    if (options.mode != FoliationMode::Auto) {
        return options.mode;
    }
    if (options.corners) {
        return FoliationMode::Disk;
    }
    if (!options.sources.empty() || !options.sinks.empty()) {
        return FoliationMode::OneForm;
    }
    if (part.euler == 2 && options.poles) {
        return FoliationMode::SpherePolar;
    }
    if (part.euler == 2 && !options.near.empty()) {
        return FoliationMode::SpherePillowcase;
    }
    const bool is_fixed = options.puncture != PunctureChoice::Auto || options.weights ||
                          options.pants == PantsSource::User || !options.near.empty() ||
                          !options.forbidden_loops.empty();
    return is_fixed ? natural_mode(part) : FoliationMode::Auto;
}

bool is_even(FoliationMode mode, const CellSpread& spread) {
    if (mode == FoliationMode::SpherePillowcase) {
        return spread.variation <= kPillowcaseVariation && spread.largest <= kPillowcaseLargest;
    }
    return !has_large_cells(spread);
}

bool is_worth_holes(const CellSpread& without, const CellSpread& with) {
    return std::log(with.largest) <= kWorthHoles * std::log(without.largest);
}

std::string percent_of(double area, const SurfacePart& part) {
    return fmt::format("{:.2g} % of the surface",
                       100.0 * area / (surface_area(part.mesh) + part.removed_area));
}

// The foliation without further holes, or why there is none.
struct Whole {
    std::optional<Foliation> foliation;
    std::exception_ptr failure;
    std::string reason;
};

Whole without_holes(const SurfacePart& part,
                    const FoliationOptions& options,
                    const Context& context) {
    Whole whole;
    try {
        whole.foliation = foliate_part(part, natural_mode(part), options, context);
    } catch (const Error& error) {
        if (error.kind() != ErrorKind::SelfCheck && error.kind() != ErrorKind::NotSupported) {
            throw;
        }
        whole.failure = std::current_exception();
        whole.reason = error.what();
    }
    return whole;
}

Alternative as_alternative(const Trial& trial) {
    return {trial.name, trial.spread, trial.removed_area, false};
}

double removed_area(const Foliation& foliation, const SurfacePart& part) {
    double area = surface_area(part.mesh) + part.removed_area;
    for (const Cylinder& cylinder : foliation.cylinders) {
        area -= surface_area(cylinder.mesh);
    }
    return std::max(area, 0.0);
}

// Puts the chosen foliation's own figures into the list, and what its mode has tried at the end.
void set_alternatives(Foliation& foliation,
                      const SurfacePart& part,
                      std::vector<Alternative> alternatives,
                      std::size_t chosen) {
    alternatives[chosen].spread = foliation.spread;
    alternatives[chosen].removed_area = removed_area(foliation, part);
    alternatives[chosen].chosen = true;
    const std::string prefix = alternatives[chosen].name + ": ";
    for (Alternative& own : foliation.alternatives) {
        if (!own.chosen) {
            own.name = prefix + own.name;
            alternatives.push_back(std::move(own));
        }
    }
    foliation.alternatives = std::move(alternatives);
}

// With holes, where they are worth it and work at full resolution, too.
std::optional<Foliation> with_holes_if_better(const SurfacePart& part,
                                              const Whole& whole,
                                              const HoleSearch& search,
                                              const std::vector<Trial>& trials,
                                              const Context& context) {
    std::vector<Alternative> alternatives;
    if (whole.foliation) {
        alternatives.push_back(
            {name_of(natural_mode(part)), whole.foliation->spread, part.removed_area, false});
    }
    for (const Trial& trial : trials) {
        alternatives.push_back(as_alternative(trial));
    }
    for (std::size_t k = 0; k < trials.size(); ++k) {
        if (whole.foliation && !is_worth_holes(whole.foliation->spread, trials[k].spread)) {
            continue;
        }
        try {
            Foliation foliation = search.finish(trials[k], section(context, kTried, 1.0));
            if (whole.foliation && !is_worth_holes(whole.foliation->spread, foliation.spread)) {
                continue;
            }
            set_alternatives(foliation, part, alternatives, k + (whole.foliation ? 1U : 0U));
            return foliation;
        } catch (const Error& error) {
            if (error.kind() == ErrorKind::BadOption) {
                throw;
            }
        }
    }
    return std::nullopt;
}

void tell_of_holes(Foliation& foliation, const Whole& whole, const SurfacePart& part) {
    const std::size_t holes = foliation.punctures.size();
    const std::string without =
        whole.foliation
            ? fmt::format("without, the largest cells would have edges {:.3g} times the mean",
                          whole.foliation->spread.largest)
            : fmt::format("without, it can't be woven ({})", whole.reason);
    foliation.warnings.insert(
        foliation.warnings.begin(),
        fmt::format("{} hole{} at the tips of limbs ({}): {}, now {:.3g} times; "
                    "foliation.punctures \"none\" keeps the surface whole",
                    holes, holes == 1 ? " is opened" : "s are opened",
                    percent_of(removed_area(foliation, part), part), without,
                    foliation.spread.largest));
}

void tell_of_large_cells(Foliation& foliation) {
    if (!is_even(foliation.mode, foliation.spread)) {
        foliation.warnings.insert(
            foliation.warnings.begin(),
            fmt::format("cells are uneven: the largest have edges {:.3g} times the mean",
                        foliation.spread.largest));
    }
}

Foliation choose(const SurfacePart& part, const FoliationOptions& options, const Context& context) {
    const FoliationMode natural = natural_mode(part);
    Whole whole = without_holes(part, options, section(context, 0.0, kWhole));
    const bool is_sphere = natural == FoliationMode::SpherePillowcase;
    const bool is_good = whole.foliation && is_even(natural, whole.foliation->spread);
    if (is_good && !is_sphere) {
        return std::move(*whole.foliation);
    }
    HoleSearch search(part, options, context);
    std::vector<Trial> trials;
    if (!is_good) {
        trials = search.run(is_sphere ? 2 : 1, FoliationMode::Auto, context);
    } else if (std::optional<Trial> trial = search.attempt(
                   std::max<std::size_t>(2, search.long_limbs()), FoliationMode::Auto, context)) {
        trials.push_back(std::move(*trial));
    }
    context.report("foliation", kTried);
    if (!is_good) {
        if (std::optional<Foliation> opened =
                with_holes_if_better(part, whole, search, trials, context)) {
            tell_of_holes(*opened, whole, part);
            return std::move(*opened);
        }
    }
    if (!whole.foliation) {
        std::rethrow_exception(whole.failure);
    }
    std::vector<Alternative> alternatives{{name_of(natural), {}, 0.0, false}};
    std::transform(trials.begin(), trials.end(), std::back_inserter(alternatives), as_alternative);
    if (const std::optional<Trial> polar = search.attempt_polar(context)) {
        alternatives.push_back(as_alternative(*polar));
    }
    set_alternatives(*whole.foliation, part, std::move(alternatives), 0);
    return std::move(*whole.foliation);
}

// A mode that asks for more holes than there are.
Foliation open_for_mode(const SurfacePart& part,
                        FoliationMode mode,
                        const FoliationOptions& options,
                        const Context& context) {
    const auto needed = static_cast<std::size_t>(holes_needed(part, mode));
    HoleSearch search(part, options, context);
    std::vector<Trial> trials;
    if (mode == FoliationMode::Pants || mode == FoliationMode::OneForm) {
        trials = search.run(needed, mode, context);
    } else if (std::optional<Trial> only = search.attempt(needed, mode, context)) {
        trials.push_back(std::move(*only));
    }
    context.report("foliation", kTried);
    for (std::size_t k = 0; k < trials.size(); ++k) {
        const bool is_last = k + 1 == trials.size();
        try {
            Foliation foliation = search.finish(trials[k], section(context, kTried, 1.0));
            std::vector<Alternative> alternatives;
            std::transform(trials.begin(), trials.end(), std::back_inserter(alternatives),
                           as_alternative);
            set_alternatives(foliation, part, std::move(alternatives), k);
            return foliation;
        } catch (const Error&) {
            if (is_last) {
                throw;
            }
        }
    }
    throw Error(ErrorKind::SelfCheck, "no-holes",
                fmt::format("foliation ({}): no choice of holes gives a sound foliation; name "
                            "punctures in foliation.punctures",
                            name_of(mode)));
}

}  // namespace

Foliation choose_foliation(const SurfacePart& part,
                           const FoliationOptions& options,
                           const Context& context) {
    const FoliationMode mode = wished_mode(part, options);
    Foliation foliation;
    if (mode == FoliationMode::Auto) {
        foliation = choose(part, options, context);
    } else if (options.puncture == PunctureChoice::Auto && holes_needed(part, mode) > 0) {
        foliation = open_for_mode(part, mode, options, context);
    } else {
        foliation = foliate_part(part, mode, options, context);
    }
    tell_of_large_cells(foliation);
    return foliation;
}

}  // namespace leafcutter::geometry
