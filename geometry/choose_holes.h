// Tries holes at the tips of limbs on a coarse version of a surface. Internal to the choice of a
// foliation.

#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "geometry/foliation.h"
#include "geometry/surface_part.h"

namespace leafcutter::geometry {

// A foliation with holes, as far as it was tried.
struct Trial {
    std::size_t holes = 0;  // Wanted; fewer are opened where they don't fit.
    FoliationMode mode = FoliationMode::Auto;
    std::string name;
    CellSpread spread;
    double removed_area = 0.0;
    std::optional<Foliation> result;  // If it was tried on the surface itself.
};

class HoleSearch {
public:
    // Keeps `part` and `options` by reference.
    HoleSearch(const SurfacePart& part, const FoliationOptions& options, const Context& context);

    std::size_t long_limbs() const { return long_limbs_; }

    // Holes at the tips of all long limbs, at least `least`; then at more tips, as long as cells
    // are far too large somewhere. Mode Auto is that of the surface with its holes. Best first;
    // those that fail are left out.
    std::vector<Trial> run(std::size_t least, FoliationMode mode, const Context& context);

    // The same with just `holes`.
    std::optional<Trial> attempt(std::size_t holes, FoliationMode mode, const Context& context);

    // Between two poles; nothing if that fails or the surface is no closed sphere.
    std::optional<Trial> attempt_polar(const Context& context) const;

    // The trial at full resolution.
    Foliation finish(const Trial& trial, const Context& context) const;

private:
    void fill_up(std::size_t holes, const Context& context);

    const SurfacePart& part_;
    const FoliationOptions& options_;
    SurfacePart coarse_;
    std::vector<Puncture> tips_;  // Vertices of `coarse_`. Longest limb first, then filled up.
    std::size_t limbs_ = 0;       // Of tips_, those found.
    std::size_t long_limbs_ = 0;  // Of those, the ones that count from the start.
};

// The largest cells are larger than one would like to cut.
bool has_large_cells(const CellSpread& spread);

// "pants with 5 holes"
std::string name_with_holes(FoliationMode mode, std::size_t holes);

}  // namespace leafcutter::geometry
