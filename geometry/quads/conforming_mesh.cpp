#include "geometry/quads/conforming_mesh.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <numeric>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "geometry/error.h"
#include "geometry/parallel.h"
#include "geometry/quads/conforming_charts.h"
#include "geometry/quads/critical_arcs.h"
#include "geometry/quads/junction_counts.h"
#include "geometry/quads/patch.h"
#include "geometry/quads/quad_edges.h"
#include "geometry/quads/relaxed_arcs.h"
#include "geometry/surface_measures.h"

namespace leafcutter::geometry {
namespace {

using Eigen::Vector3d;

// More cells than asked for by this part is another strip width: refused, not done.
constexpr double kMostExcess = 1.1;
constexpr int kMostSizes = 20;
// From a size where quads would face inwards to the next.
constexpr double kFiner = 1.25;
// With more cells than this times the wanted they won't unfold either: sharp edges of the model. Of
// those so many quads may fold over.
constexpr double kMostRefined = 4.0;
constexpr double kFoldedShare = 0.005;

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

int floor_mod(int value, int modulus) {
    const int rest = value % modulus;
    return rest < 0 ? rest + modulus : rest;
}

// A cylinder's own grid, before its vertices are shared.
struct Piece {
    Cylinder chart;
    CylinderGrid grid;
    Patch patch;
    CellRegions regions;
    std::vector<SagCell> cells;
};

Piece make_piece(const Foliation& foliation,
                 const ArcNetwork& network,
                 const JunctionCounts& counts,
                 int cylinder,
                 const Context& context) {
    Piece piece;
    piece.chart = conform_chart(foliation, network, counts, cylinder, context);
    piece.grid = conforming_grid(piece.chart, counts, cylinder);
    const ChartGrid grid(piece.chart, piece.grid);
    const ChartSampler sampler(piece.chart);
    piece.patch = sample_patch(grid, sampler, context);
    piece.regions = cut_regions(piece.chart, grid);
    check_regions(at(cylinder), piece.regions, surface_area(piece.chart.mesh));
    piece.cells = sag_cells(piece.patch, piece.regions, grid, sampler);
    return piece;
}

// Numbers of the shared vertices: singular points, and those along arcs.
class SharedVertices {
public:
    SharedVertices(const Foliation& foliation,
                   const ArcNetwork& network,
                   const JunctionCounts& counts)
        : network_(network), counts_(counts) {
        for (std::size_t a = 0; a < network.arcs.size(); ++a) {
            const CriticalArc& arc = network.arcs[a];
            add_singular(arc.points.front(), foliation);
            add_singular(arc.points.back(), foliation);
            first_.push_back(static_cast<int>(positions_.size()));
            const int cells = counts.arc_cells[a];
            for (int k = 1; k < cells; ++k) {
                positions_.push_back(point_on(arc, foliation, static_cast<double>(k) / cells));
            }
        }
    }

    const std::vector<Vector3d>& positions() const { return positions_; }
    const std::map<int, int>& singular() const { return singular_; }

    // The vertex of a column at a critical end.
    int vertex(int cylinder, std::size_t side, int col) const {
        const int twist = side == 1 ? counts_.twist[at(cylinder)] : 0;
        int place = floor_mod(col - twist, counts_.cols[at(cylinder)]);
        for (const ArcUse& use : network_.ends[at(cylinder)][side].uses) {
            const int cells = counts_.arc_cells[at(use.arc)];
            if (place < cells) {
                return on_arc(use.arc, use.forward ? place : cells - place);
            }
            place -= cells;
        }
        throw Error(ErrorKind::SelfCheck, "quads-topology",
                    fmt::format("quads: an end of cylinder {} is too short", cylinder));
    }

private:
    void add_singular(int point, const Foliation& foliation) {
        if (singular_.emplace(point, static_cast<int>(positions_.size())).second) {
            positions_.push_back(foliation.critical_points[at(point)].position);
        }
    }

    int on_arc(int arc, int place) const {
        const std::vector<int>& points = network_.arcs[at(arc)].points;
        if (place == 0) {
            return singular_.at(points.front());
        }
        if (place == counts_.arc_cells[at(arc)]) {
            return singular_.at(points.back());
        }
        return first_[at(arc)] + place - 1;
    }

    const ArcNetwork& network_;
    const JunctionCounts& counts_;
    std::vector<Vector3d> positions_;
    std::map<int, int> singular_;  // Critical point to vertex.
    std::vector<int> first_;       // Per arc its first inner vertex.
};

// Gives the pieces' vertices their numbers in the whole.
class Joiner {
public:
    Joiner(const ArcNetwork& network, const SharedVertices& shared, std::vector<Vector3d>& vertices)
        : network_(network), shared_(shared), vertices_(vertices) {
        vertices_ = shared.positions();
    }

    void add(Piece& piece, int cylinder) {
        const ChartGrid grid(piece.chart, piece.grid);
        std::vector<int> number(piece.patch.vertices.size(), -1);
        for (int row = 0; row <= piece.grid.rows; ++row) {
            const bool lower = row == 0 && !network_.is_open(cylinder, 0);
            const bool upper = row == piece.grid.rows && !network_.is_open(cylinder, 1);
            for (int col = 0; col < piece.grid.cols; ++col) {
                const int own = grid.vertex(row, col);
                if (lower || upper) {
                    number[at(own)] = shared_.vertex(cylinder, lower ? 0 : 1, col);
                } else {
                    number[at(own)] = static_cast<int>(vertices_.size());
                    vertices_.push_back(piece.patch.vertices[at(own)]);
                }
            }
        }
        for (std::size_t i = 0; i < piece.patch.quads.size(); ++i) {
            for (int& corner : piece.patch.quads[i]) {
                corner = number[at(corner)];
            }
            piece.cells[i].corners = piece.patch.quads[i];
        }
    }

private:
    const ArcNetwork& network_;
    const SharedVertices& shared_;
    std::vector<Vector3d>& vertices_;
};

// What theory says: every edge between two quads but those on open ends, Euler characteristic of
// the surface, four quads round every vertex inside but twice its prongs round a singular one.
void check_whole(const Foliation& foliation,
                 const ArcNetwork& network,
                 const JunctionCounts& counts,
                 const SharedVertices& shared,
                 const JoinedMesh& mesh) {
    std::vector<std::array<int, 4>> quads;
    for (const JoinedCylinder& part : mesh.parts) {
        quads.insert(quads.end(), part.quads.begin(), part.quads.end());
    }
    std::vector<int> wanted(mesh.vertices.size(), 4);
    for (const auto& [point, vertex] : shared.singular()) {
        wanted[at(vertex)] = 2 * foliation.critical_points[at(point)].prongs;
    }
    const QuadNeighbours found = find_neighbours(quads);
    int open_edges = 0;
    for (const int c : network.cylinders) {
        for (int end = 0; end < 2; ++end) {
            open_edges += network.is_open(c, end) ? counts.cols[at(c)] : 0;
        }
    }
    std::vector<int> valence(mesh.vertices.size(), 0);
    for (std::size_t q = 0; q < quads.size(); ++q) {
        for (std::size_t side = 0; side < 4; ++side) {
            ++valence[at(quads[q][side])];
            if (found.across[q][side].quad < 0) {  // Two quads meet at each boundary vertex.
                ++valence[at(quads[q][side])];
                ++valence[at(quads[q][(side + 1) % 4])];
            }
        }
    }
    const int euler =
        static_cast<int>(mesh.vertices.size()) - found.edges + static_cast<int>(quads.size());
    const int wanted_euler =
        static_cast<int>(shared.singular().size()) - static_cast<int>(network.arcs.size());
    if (found.faults != 0 || found.boundary_edges != open_edges || euler != wanted_euler ||
        valence != wanted) {
        throw Error(
            ErrorKind::SelfCheck, "quads-topology",
            fmt::format("quads: joined cylinders have {} faulty edges, Euler "
                        "characteristic {} instead of {} and {} boundary edges instead "
                        "of {}, or wrong valences",
                        found.faults, euler, wanted_euler, found.boundary_edges, open_edges));
    }
}

JoinedMesh build(const Foliation& foliation,
                 const ArcNetwork& network,
                 const JunctionCounts& counts,
                 const GridOptions& options,
                 const Context& context) {
    std::vector<Piece> pieces(network.cylinders.size());
    for_each_task(pieces.size(), context, [&](std::size_t i, const Context& own) {
        pieces[i] = make_piece(foliation, network, counts, network.cylinders[i], own);
    });
    JoinedMesh mesh;
    mesh.cylinders = network.cylinders;
    const SharedVertices shared(foliation, network, counts);
    Joiner joiner(network, shared, mesh.vertices);
    std::vector<SagCell> cells;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        joiner.add(pieces[i], network.cylinders[i]);
        cells.insert(cells.end(), pieces[i].cells.begin(), pieces[i].cells.end());
    }
    if (options.half_sag_offset) {
        offset_by_half_sag(mesh.vertices, cells);
    }
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        Piece& piece = pieces[i];
        mesh.folded += count_inverted({mesh.vertices, piece.patch.quads}, piece.regions);
        mesh.parts.push_back({.chart = std::move(piece.chart),
                              .grid = std::move(piece.grid),
                              .quads = std::move(piece.patch.quads),
                              .surface_area = std::move(piece.regions.area)});
    }
    check_whole(foliation, network, counts, shared, mesh);
    return mesh;
}

JunctionWish wish_of(const Foliation& foliation, const GridOptions& options, double area) {
    JunctionWish wish;
    wish.cells = area / (options.strip_width_mm * options.strip_width_mm);
    wish.parity = options.parity;
    wish.counts.assign(foliation.cylinders.size(), options.all);
    wish.paths.assign(foliation.cylinders.size(), "grid");
    for (std::size_t c = 0; c < options.per_cylinder.size(); ++c) {
        const RowsCols& own = options.per_cylinder[c];
        if (own.rows || own.cols) {
            wish.counts[c] = own;
            wish.paths[c] = fmt::format("grid.cylinders[{}]", c);
        }
    }
    return wish;
}

// Two digits more than a ruler shows, downwards: so wide is still all right.
double rounded_down(double width) {
    const double digit = std::pow(10.0, std::floor(std::log10(width)) - 3.0);
    return std::floor(width / digit) * digit;
}

[[noreturn]] void refuse_width(const GridOptions& options, double area, int quads, int tightest) {
    throw Error(ErrorKind::BadOption, "strips-too-wide",
                fmt::format("grid.strip_width_mm: strips of {:.4g} mm are too wide to go on from "
                            "one cylinder into the next, most of all in cylinder {}; use at most "
                            "{:.4g} mm (about {} quads), or grid.junctions \"independent\"",
                            options.strip_width_mm, tightest, rounded_down(std::sqrt(area / quads)),
                            quads));
}

}  // namespace

JoinedMesh join_cylinders(const Foliation& foliation,
                          const GridOptions& options,
                          const Context& context) {
    const ArcNetwork network = find_arcs(foliation);
    if (network.cylinders.empty()) {
        return {};
    }
    double area = 0.0;
    for (const int c : network.cylinders) {
        area += surface_area(foliation.cylinders[at(c)].mesh);
    }
    const JunctionCounter counter(foliation, network, wish_of(foliation, options, area));
    double size = counter.wanted_cells();
    int tightest = -1;
    std::optional<JoinedMesh> folded;  // The first, if only a few of its quads face inwards.
    double most = 0.0;                 // Cells, once there are enough of them for the topology.
    for (int tries = 0; tries < kMostSizes && (most == 0.0 || size < most); ++tries) {
        const JunctionCounts counts = counter.choose(size, context);
        if (tightest < 0) {
            tightest = counts.tightest;
        }
        if (!counter.has_fixed_counts() && counts.cells > kMostExcess * size) {
            size = counts.cells;
            continue;
        }
        most = most > 0.0 ? most : kMostRefined * size;
        const ArcNetwork arcs = relax_arcs(foliation, network, counts, context);
        JoinedMesh mesh = build(foliation, arcs, counts, options, context);
        if (mesh.folded == 0) {
            if (size > counter.wanted_cells()) {
                refuse_width(options, area, static_cast<int>(std::lround(size)), tightest);
            }
            return mesh;
        }
        if (size <= counter.wanted_cells() &&
            static_cast<double>(mesh.folded) <= std::max(1.0, kFoldedShare * counts.cells)) {
            folded = std::move(mesh);
        }
        if (counter.has_fixed_counts()) {
            break;
        }
        size *= kFiner;
    }
    if (folded) {
        return std::move(*folded);
    }
    throw Error(ErrorKind::SelfCheck, "quads-inverted",
                "quads: too many face inwards where cylinders are joined; use narrower strips "
                "(grid.strip_width_mm), or grid.junctions \"independent\"");
}

}  // namespace leafcutter::geometry
