#include "geometry/cases/finish.h"

#include <array>
#include <cstdio>
#include <string>
#include <utility>

namespace leafcutter::geometry {
namespace {

// Above this gap the mesh doesn't resolve the surface's shape.
constexpr double kLargestGap = 0.05;

std::string percent(double ratio) {
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%.1f %%", 100.0 * ratio);
    return text.data();
}

std::vector<std::string> gap_warnings(const Cylinder& cylinder) {
    std::vector<std::string> warnings;
    if (cylinder.conformal_gap > kLargestGap) {
        warnings.push_back(
            "the mesh is coarse for its shape: the foliation's modulus is certain to " +
            percent(cylinder.conformal_gap) + " only, so angles may be off; refine the mesh");
    }
    return warnings;
}

}  // namespace

std::vector<std::string> repair_warnings(const FlipReport& repair) {
    std::vector<std::string> warnings;
    if (repair.opened_limbs) {
        warnings.emplace_back(
            "the model has limbs too long for one chart: a few cells swallow each of them; cut a "
            "hole "
            "into their tips or weave them apart");
    }
    if (repair.whole_chart) {
        warnings.push_back("flipped triangles were too many to mend one by one (" +
                           std::to_string(repair.flipped_as_solved) +
                           "); the whole parameterisation was made again with even weights, which "
                           "costs right angles; remesh the model");
    }
    return warnings;
}

Foliation finish_foliation(SolvedChart solved,
                           const std::vector<Rail>& rails,
                           const Context& context) {
    const FlipReport repair = make_bijective(solved.map, rails, context);
    lift_into_domain(solved.map);
    Cylinder cylinder = finish_cylinder(std::move(solved.map));
    cylinder.energy = 0.5 * solved.upper;
    cylinder.conformal_gap = solved.gap();
    cylinder.flux_mismatch = solved.flux_mismatch;
    Foliation foliation;
    foliation.energy = cylinder.energy;
    foliation.iterations = 1;
    foliation.warnings = gap_warnings(cylinder);
    for (std::string& warning : repair_warnings(repair)) {
        foliation.warnings.push_back(std::move(warning));
    }
    foliation.cylinders.push_back(std::move(cylinder));
    return foliation;
}

}  // namespace leafcutter::geometry
