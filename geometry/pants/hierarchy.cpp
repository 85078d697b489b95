#include "geometry/pants/hierarchy.h"

#include <algorithm>
#include <utility>

namespace leafcutter::geometry {
namespace {

// Vertices of a level by those of the next finer one.
constexpr std::size_t kCoarsening = 4;
constexpr int kSettlePasses = 3;

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

Hierarchy::Level make_level(LinedSurface surface) {
    Hierarchy::Level level;
    level.surface = std::move(surface);
    const int count = static_cast<int>(level.surface.mesh.positions.size());
    level.rings = build_vertex_rings(build_half_edges(level.surface.mesh.triangles, count), count);
    level.flipped = flip_to_delaunay(level.surface, level.rings);
    return level;
}

}  // namespace

Hierarchy build_hierarchy(LinedSurface finest,
                          int boundary_lines,
                          std::size_t coarsest,
                          const Context& context) {
    Hierarchy hierarchy;
    hierarchy.boundary_lines = boundary_lines;
    hierarchy.levels.push_back(make_level(std::move(finest)));
    while (true) {
        context.check();
        Hierarchy::Level& level = hierarchy.levels.back();
        const std::size_t vertices = level.surface.mesh.positions.size();
        if (2 * vertices <= 3 * coarsest) {
            break;
        }
        const LinedSurface flipped{
            {level.surface.mesh.positions, triangles_of(level.flipped.half_edges)},
            level.surface.line_of_vertex};
        Coarser coarser = coarsen(
            flipped, {.target_vertices = std::max(vertices / kCoarsening, coarsest)}, context);
        if (10 * coarser.surface.mesh.positions.size() > 9 * vertices) {
            break;  // Nothing much left to collapse.
        }
        level.representative = std::move(coarser.representative);
        hierarchy.levels.push_back(make_level(std::move(coarser.surface)));
    }
    return hierarchy;
}

FineMap refine_map(const Hierarchy& hierarchy, const GraphMap& coarse, const Context& context) {
    FineMap fine{coarse, {}};
    const auto improve = [&](const Hierarchy::Level& level) {
        const HarmonicMapReport report = solve_harmonic_map(
            fine.map, level.flipped.rings, level.flipped.weights, MapStart::Warm, context);
        fine.report.energy = report.energy;
        fine.report.iterations += report.iterations;
        fine.report.factorizations += report.factorizations;
        fine.report.solves += report.solves;
        fine.report.residual = report.residual;
        fine.report.converged = report.converged;
        fine.report.energies = report.energies;
    };
    improve(hierarchy.levels.back());
    for (std::size_t k = hierarchy.levels.size() - 1;; --k) {
        const Hierarchy::Level& level = hierarchy.levels[k];
        undo_flips(fine.map, level.flipped, level.surface, level.rings);
        if (k == 0) {
            return fine;
        }
        const Hierarchy::Level& finer = hierarchy.levels[k - 1];
        fine.map = prolong(fine.map, level.rings, finer.representative, finer.flipped.rings);
        std::vector<int> inserted;
        for (std::size_t v = 0; v < finer.representative.size(); ++v) {
            if (finer.surface.mesh.positions[v] !=
                level.surface.mesh.positions[at(finer.representative[v])]) {
                inserted.push_back(static_cast<int>(v));
            }
        }
        settle_vertices(fine.map, finer.flipped.rings, finer.flipped.weights, inserted,
                        kSettlePasses);
        improve(finer);
    }
}

}  // namespace leafcutter::geometry
