#include "fab/even_cells.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "geometry/error.h"

namespace leafcutter::fab {

namespace {

// Standard deviation of the areas that quads stand for, over their mean.
double variation(const geometry::QuadMesh& quads) {
    double sum = 0.0;
    double squares = 0.0;
    for (const double area : quads.surface_area) {
        sum += area;
        squares += area * area;
    }
    const auto count = static_cast<double>(quads.surface_area.size());
    const double mean = sum / count;
    return std::sqrt(std::max(0.0, squares / count - mean * mean)) / mean;
}

}  // namespace

EvenedOut even_out(const geometry::Mesh& mesh,
                   const geometry::FoliationOptions& options,
                   const geometry::GridOptions& grid,
                   const geometry::Context& context) {
    EvenedOut even;
    even.foliation = geometry::compute_foliation(mesh, options, context);
    const double after = variation(geometry::build_quad_mesh(even.foliation, grid, context));
    geometry::EvenedCells found{.before = after, .after = after};
    geometry::FoliationOptions plain_options = options;
    geometry::GridOptions plain_grid = grid;
    plain_options.even_cells = false;
    plain_grid.even_cells = false;
    geometry::Context quiet = context;
    quiet.progress = nullptr;
    try {
        geometry::Foliation plain = geometry::compute_foliation(mesh, plain_options, quiet);
        found.before = variation(geometry::build_quad_mesh(plain, plain_grid, quiet));
        even.is_evened = found.after < found.before;
        if (!even.is_evened) {
            found.after = found.before;
            even.foliation = std::move(plain);
            even.foliation.warnings.emplace_back(
                "grid.even_cells: nothing evens out the cells of this model further");
        }
    } catch (const geometry::Error&) {
        even.is_evened = true;  // Without, there is nothing to compare with.
    }
    even.foliation.evened = found;
    return even;
}

}  // namespace leafcutter::fab
