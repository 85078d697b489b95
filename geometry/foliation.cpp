#include "geometry/foliation.h"

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "geometry/choose_foliation.h"
#include "geometry/components.h"
#include "geometry/surface_measures.h"
#include "geometry/surface_part.h"
#include "geometry/topology.h"

namespace leafcutter::geometry {
namespace {

double whole_area(const SurfacePart& part) {
    return surface_area(part.mesh) + part.removed_area;
}

// Leaves the other parts aside; returns what to say of that.
std::string keep_largest(std::vector<SurfacePart>& parts) {
    const std::size_t largest = largest_part(parts);
    double all = 0.0;
    for (const SurfacePart& part : parts) {
        all += whole_area(part);
    }
    const std::size_t others = parts.size() - 1;
    SurfacePart kept = std::move(parts[largest]);
    parts.clear();
    parts.push_back(std::move(kept));
    return fmt::format("{} smaller part{} of the model left out: {:.3g} % of its surface", others,
                       others == 1 ? " is" : "s are",
                       100.0 * (1.0 - whole_area(parts.front()) / all));
}

// Parts take their share of the progress by their number of triangles, of cells by their share of
// the surface's `area`.
std::vector<Foliation> foliate_each(const std::vector<SurfacePart>& parts,
                                    double area,
                                    const FoliationOptions& options,
                                    const Context& context) {
    std::size_t triangles = 0;
    for (const SurfacePart& part : parts) {
        triangles += part.mesh.triangles.size();
    }
    std::vector<Foliation> foliations;
    double done = 0.0;
    for (std::size_t k = 0; k < parts.size(); ++k) {
        const double share =
            static_cast<double>(parts[k].mesh.triangles.size()) / static_cast<double>(triangles);
        Context own = context;
        if (context.progress) {
            own.progress = [&, done](std::string_view stage, double fraction) {
                context.progress(stage, done + share * fraction);
            };
        }
        FoliationOptions of_part = options_of(parts[k], options);
        if (of_part.junctions) {
            of_part.junctions->cells *= whole_area(parts[k]) / area;
        }
        try {
            foliations.push_back(choose_foliation(parts[k], of_part, own));
        } catch (const Error& error) {
            if (parts.size() == 1) {
                throw;
            }
            throw Error(
                error.kind(), error.code(),
                fmt::format("part {} of {}: {} (foliation.components \"largest\" weaves the "
                            "largest part alone)",
                            k + 1, parts.size(), error.what()));
        }
        done += share;
    }
    return foliations;
}

}  // namespace

Foliation compute_foliation(const Mesh& mesh,
                            const FoliationOptions& options,
                            const Context& context) {
    context.report("foliation", 0.0);
    std::vector<Puncture> given;
    if (options.puncture == PunctureChoice::Given) {
        given = options.punctures;
    }
    std::vector<SurfacePart> parts =
        split_into_parts(to_triangle_mesh(mesh), analyse_topology(mesh), given, context);
    double area = 0.0;
    for (const SurfacePart& part : parts) {
        area += whole_area(part);
    }
    std::string left_out;
    if (options.components == Components::Largest && parts.size() > 1) {
        left_out = keep_largest(parts);
    }
    check_names(options, parts);
    Foliation foliation = join_parts(foliate_each(parts, area, options, context), parts);
    if (!left_out.empty()) {
        foliation.warnings.insert(foliation.warnings.begin(), std::move(left_out));
    }
    context.report("foliation", 1.0);
    return foliation;
}

}  // namespace leafcutter::geometry
