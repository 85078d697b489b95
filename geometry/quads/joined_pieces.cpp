#include "geometry/quads/joined_pieces.h"

#include <array>
#include <cstddef>
#include <utility>

#include <fmt/format.h>

#include "geometry/error.h"
#include "geometry/quads/quad_edges.h"
#include "geometry/surface_measures.h"

namespace leafcutter::geometry {
namespace {

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

}  // namespace

JoinedPiece sample_piece(Cylinder chart, CylinderGrid grid, int cylinder, const Context& context) {
    JoinedPiece piece;
    piece.chart = std::move(chart);
    piece.grid = std::move(grid);
    const ChartGrid own(piece.chart, piece.grid);
    const ChartSampler sampler(piece.chart);
    piece.patch = sample_patch(own, sampler, context);
    piece.regions = cut_regions(piece.chart, own);
    check_regions(at(cylinder), piece.regions, surface_area(piece.chart.mesh));
    piece.cells = sag_cells(piece.patch, piece.regions, own, sampler);
    return piece;
}

void renumber(JoinedPiece& piece, const std::vector<int>& number) {
    for (std::size_t i = 0; i < piece.patch.quads.size(); ++i) {
        for (int& corner : piece.patch.quads[i]) {
            corner = number[at(corner)];
        }
        piece.cells[i].corners = piece.patch.quads[i];
    }
}

void add_parts(JoinedMesh& mesh, std::vector<JoinedPiece> pieces, const GridOptions& options) {
    if (options.half_sag_offset) {
        std::vector<SagCell> cells;
        for (const JoinedPiece& piece : pieces) {
            cells.insert(cells.end(), piece.cells.begin(), piece.cells.end());
        }
        offset_by_half_sag(mesh.vertices, cells);
    }
    for (JoinedPiece& piece : pieces) {
        mesh.folded += count_inverted({mesh.vertices, piece.patch.quads}, piece.regions);
        mesh.parts.push_back({.chart = std::move(piece.chart),
                              .grid = std::move(piece.grid),
                              .quads = std::move(piece.patch.quads),
                              .surface_area = std::move(piece.regions.area)});
    }
}

void check_topology(const JoinedMesh& mesh, const JoinedTopology& wanted, std::string_view parts) {
    std::vector<std::array<int, 4>> quads;
    for (const JoinedCylinder& part : mesh.parts) {
        quads.insert(quads.end(), part.quads.begin(), part.quads.end());
    }
    const QuadNeighbours found = find_neighbours(quads);
    std::vector<int> valences(mesh.vertices.size(), 0);
    for (std::size_t q = 0; q < quads.size(); ++q) {
        for (std::size_t side = 0; side < 4; ++side) {
            ++valences[at(quads[q][side])];
            if (found.across[q][side].quad < 0) {  // Two quads meet at each boundary vertex.
                ++valences[at(quads[q][side])];
                ++valences[at(quads[q][(side + 1) % 4])];
            }
        }
    }
    const int euler =
        static_cast<int>(mesh.vertices.size()) - found.edges + static_cast<int>(quads.size());
    if (found.faults != 0 || found.boundary_edges != wanted.open_edges ||
        2 * euler != wanted.doubled_euler || valences != wanted.valences) {
        throw Error(ErrorKind::SelfCheck, "quads-topology",
                    fmt::format("quads: joined {} have {} faulty edges, Euler characteristic {} "
                                "instead of {} and {} boundary edges instead of {}, or wrong "
                                "valences",
                                parts, found.faults, euler, wanted.doubled_euler / 2,
                                found.boundary_edges, wanted.open_edges));
    }
}

FixedCounts fixed_counts(const GridOptions& options, std::size_t cylinders) {
    FixedCounts fixed{std::vector<RowsCols>(cylinders, options.all),
                      std::vector<std::string>(cylinders, "grid")};
    for (std::size_t c = 0; c < options.per_cylinder.size(); ++c) {
        const RowsCols& own = options.per_cylinder[c];
        if (own.rows || own.cols) {
            fixed.counts[c] = own;
            fixed.paths[c] = fmt::format("grid.cylinders[{}]", c);
        }
    }
    return fixed;
}

}  // namespace leafcutter::geometry
