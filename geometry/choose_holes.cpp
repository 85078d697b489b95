#include "geometry/choose_holes.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "geometry/foliate_part.h"
#include "geometry/limb_tips.h"
#include "geometry/surface_measures.h"

namespace leafcutter::geometry {
namespace {

// Trials are made on this many vertices.
constexpr std::size_t kTrialVertices = 6000;
// Holes have this radius, by the diagonal of the bounding box …
constexpr double kRadius = 0.02;
// … but at most this part of their limb's, and at least that part of the ordinary radius: what
// looks like a thin limb may be the point of a cone.
constexpr double kLimbPart = 1.0 / 3.0;
constexpr double kLeastPart = 0.35;
// Limbs that stick out by this part of the diagonal get holes first.
constexpr double kLongLimb = 0.04;
constexpr std::size_t kMostTrials = 6;
// Edge of the largest cells, in mean edges.
constexpr double kLarge = 5.0;

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

double hole_radius(const SurfacePart& part, int vertex, double size) {
    const double usual = kRadius * size;
    const double limb = limb_radius(part.mesh, vertex, usual / kLimbPart);
    return std::clamp(kLimbPart * limb, kLeastPart * usual, usual);
}

}  // namespace

bool has_large_cells(const CellSpread& spread) {
    return !(spread.largest <= kLarge);
}

std::string name_with_holes(FoliationMode mode, std::size_t holes) {
    return fmt::format("{} with {} hole{}", name_of(mode), holes, holes == 1 ? "" : "s");
}

HoleSearch::HoleSearch(const SurfacePart& part,
                       const FoliationOptions& options,
                       const Context& context)
    : part_(part), options_(options), coarse_(coarse_part(part, kTrialVertices, context)) {
    const double size = diagonal(coarse_.mesh);
    for (const LimbTip& tip : find_limb_tips(coarse_.mesh, {}, context)) {
        tips_.push_back({tip.vertex, hole_radius(coarse_, tip.vertex, size)});
        long_limbs_ += tip.persistence >= kLongLimb ? 1 : 0;
    }
    limbs_ = tips_.size();
}

// Surfaces without enough limbs get holes far from one another.
void HoleSearch::fill_up(std::size_t holes, const Context& context) {
    if (tips_.size() >= holes) {
        return;
    }
    const double size = diagonal(coarse_.mesh);
    std::vector<int> taken;
    for (const Puncture& tip : tips_) {
        taken.push_back(tip.vertex);
    }
    for (const int v : farthest_vertices(coarse_.mesh, taken, holes - tips_.size(), context)) {
        tips_.push_back({v, kRadius * size});
    }
}

std::optional<Trial> HoleSearch::attempt(std::size_t holes,
                                         FoliationMode mode,
                                         const Context& context) {
    context.check();
    fill_up(holes, context);
    Context quiet = context;
    quiet.progress = nullptr;
    try {
        const SurfacePart opened = with_holes(coarse_, std::span(tips_).first(holes), quiet);
        Trial trial;
        trial.holes = holes;
        trial.mode = mode == FoliationMode::Auto ? natural_mode(opened) : mode;
        trial.name = name_with_holes(trial.mode, opened.punctures.size() - part_.punctures.size());
        trial.removed_area = opened.removed_area;
        const bool is_final = coarse_.mesh.positions.size() == part_.mesh.positions.size();
        FoliationOptions options = options_;
        if (!is_final) {  // What is done for the grid costs time and hardly moves the spread.
            options.junctions.reset();
            options.even_cells = false;
            options.near.clear();  // The coarse surface need not have these vertices.
            options.forbidden_loops.clear();
        }
        Foliation foliation = foliate_part(opened, trial.mode, options, quiet);
        trial.spread = foliation.spread;
        if (is_final) {
            trial.result = std::move(foliation);
        }
        return trial;
    } catch (const Error& error) {
        if (error.kind() == ErrorKind::BadOption) {
            throw;
        }
        return std::nullopt;
    }
}

std::optional<Trial> HoleSearch::attempt_polar(const Context& context) const {
    if (coarse_.euler != 2) {
        return std::nullopt;
    }
    Context quiet = context;
    quiet.progress = nullptr;
    try {
        const Foliation polar = foliate_part(coarse_, FoliationMode::SpherePolar, options_, quiet);
        Trial trial;
        trial.mode = FoliationMode::SpherePolar;
        trial.name = name_of(trial.mode);
        trial.spread = polar.spread;
        trial.removed_area = surface_area(coarse_.mesh);
        for (const Cylinder& cylinder : polar.cylinders) {
            trial.removed_area -= surface_area(cylinder.mesh);
        }
        return trial;
    } catch (const Error&) {
        return std::nullopt;
    }
}

std::vector<Trial> HoleSearch::run(std::size_t least, FoliationMode mode, const Context& context) {
    std::vector<Trial> trials;
    const std::size_t first = std::max(least, long_limbs_);
    const std::size_t last = std::max(first, limbs_);
    const std::size_t step = 1 + (last - first) / kMostTrials;
    for (std::size_t holes = first; holes <= last; holes += step) {
        std::optional<Trial> trial = attempt(holes, mode, context);
        if (!trial) {
            continue;
        }
        trials.push_back(std::move(*trial));
        if (!has_large_cells(trials.back().spread)) {
            break;
        }
    }
    std::stable_sort(trials.begin(), trials.end(), [](const Trial& a, const Trial& b) {
        return a.spread.largest < b.spread.largest;
    });
    return trials;
}

Foliation HoleSearch::finish(const Trial& trial, const Context& context) const {
    if (trial.result) {
        return *trial.result;
    }
    // Vertices of the coarse version are vertices of the part: find them by name.
    std::vector<int> by_name;
    for (std::size_t v = 0; v < part_.source_vertex.size(); ++v) {
        if (part_.source_vertex[v] >= 0) {
            by_name.resize(std::max(by_name.size(), at(part_.source_vertex[v]) + 1), -1);
            by_name[at(part_.source_vertex[v])] = static_cast<int>(v);
        }
    }
    std::vector<Puncture> punctures(tips_.begin(),
                                    tips_.begin() + static_cast<std::ptrdiff_t>(trial.holes));
    for (Puncture& puncture : punctures) {
        puncture.vertex = by_name[at(coarse_.source_vertex[at(puncture.vertex)])];
    }
    const SurfacePart opened = with_holes(part_, punctures, context);
    return foliate_part(opened, trial.mode, options_, context);
}

}  // namespace leafcutter::geometry
