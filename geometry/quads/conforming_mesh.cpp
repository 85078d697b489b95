#include "geometry/quads/conforming_mesh.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "geometry/error.h"
#include "geometry/parallel.h"
#include "geometry/quads/conforming_charts.h"
#include "geometry/quads/critical_arcs.h"
#include "geometry/quads/graded_rows.h"
#include "geometry/quads/joined_pieces.h"
#include "geometry/quads/junction_counts.h"
#include "geometry/quads/relaxed_arcs.h"
#include "geometry/quads/shared_vertices.h"
#include "geometry/quads/strip_width.h"
#include "geometry/surface_measures.h"

namespace leafcutter::geometry {
namespace {

using Eigen::Vector3d;

// More cells than asked for by this part is another strip width: refused, not done.
constexpr double kMostExcess = 1.1;
constexpr int kMostSizes = 20;
// From a size where quads would face inwards to the next.
constexpr double kFiner = 1.25;
// With more cells than this times the wanted they won't unfold either: sharp edges of the model.
constexpr double kMostRefined = 4.0;
// Quads that may fold over at such edges.
constexpr double kFoldedShare = 0.005;
constexpr double kFewFolded = 1.0;
// The period of a plain weave: the least that a surface can carry everywhere.
constexpr int kColours = 2;
constexpr int kGradingRounds = 4;
// Mean square slant and stretch of cells that whole periods of another pattern may cost.
constexpr double kWorthPeriods = 0.1;

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

JoinedPiece make_piece(const Foliation& foliation,
                       const ArcNetwork& network,
                       const JunctionCounts& counts,
                       int cylinder,
                       const Context& context) {
    if (counts.rows[at(cylinder)] == 0) {
        JoinedPiece none;
        none.chart = foliation.cylinders[at(cylinder)];
        none.grid.shape = none.chart.shape;
        return none;
    }
    Cylinder chart = conform_chart(foliation, network, counts, cylinder, context);
    CylinderGrid grid = conforming_grid(chart, counts, cylinder);
    return sample_piece(std::move(chart), std::move(grid), cylinder, context);
}

// Gives the pieces' vertices their numbers in the whole.
class Joiner {
public:
    Joiner(const ArcNetwork& network, const SharedVertices& shared, std::vector<Vector3d>& vertices)
        : network_(network), shared_(shared), vertices_(vertices) {
        vertices_ = shared.positions();
    }

    void add(JoinedPiece& piece, int cylinder) {
        if (piece.grid.rows == 0) {
            return;
        }
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
        renumber(piece, number);
    }

private:
    const ArcNetwork& network_;
    const SharedVertices& shared_;
    std::vector<Vector3d>& vertices_;
};

// What theory says: every edge between two quads but those on open ends, Euler characteristic of
// the surface, four quads round every vertex inside but twice its prongs round a singular one, or
// as many more than four as all of them have that came together there.
void check_whole(const Foliation& foliation,
                 const ArcNetwork& network,
                 const JunctionCounts& counts,
                 const SharedVertices& shared,
                 const JoinedMesh& mesh) {
    JoinedTopology wanted;
    wanted.valences = shared.valences(foliation);
    wanted.valences.resize(mesh.vertices.size(), 4);
    for (const int c : network.cylinders) {
        for (int end = 0; end < 2; ++end) {
            wanted.open_edges += network.is_open(c, end) ? counts.cols[at(c)] : 0;
        }
    }
    wanted.doubled_euler =
        2 * (static_cast<int>(shared.singular_points()) - static_cast<int>(network.arcs.size()));
    check_topology(mesh, wanted, "cylinders");
}

JoinedMesh build(const Foliation& foliation,
                 const ArcNetwork& network,
                 const JunctionCounts& counts,
                 const GridOptions& options,
                 const Context& context) {
    std::vector<JoinedPiece> pieces(network.cylinders.size());
    for_each_task(pieces.size(), context, [&](std::size_t i, const Context& own) {
        pieces[i] = make_piece(foliation, network, counts, network.cylinders[i], own);
    });
    JoinedMesh mesh;
    mesh.cylinders = network.cylinders;
    const SharedVertices shared(foliation, network, counts);
    Joiner joiner(network, shared, mesh.vertices);
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        joiner.add(pieces[i], network.cylinders[i]);
    }
    add_parts(mesh, std::move(pieces), options);
    check_whole(foliation, network, counts, shared, mesh);
    return mesh;
}

// What a joined mesh is built from.
struct Source {
    const Foliation& foliation;
    const ArcNetwork& network;
    const GridOptions& options;
};

// The same with rows graded in the cylinders that come closer to the surface by it, or `even`.
JoinedMesh with_graded_rows(JoinedMesh even,
                            const Source& source,
                            JunctionCounts counts,
                            const Context& context) {
    const std::vector<std::vector<double>> rows = graded_rows(even, source.options, context);
    counts.f_levels.resize(source.foliation.cylinders.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
        counts.f_levels[at(even.cylinders[i])] = rows[i];
    }
    // What one cylinder's rows are shows in its neighbours too, by the half-sag offset: so again.
    for (int round = 0; round < kGradingRounds; ++round) {
        JoinedMesh graded =
            build(source.foliation, source.network, counts, source.options, context);
        const CameCloser closer = compare_distances(even, graded, context);
        bool all = true;
        for (std::size_t i = 0; i < closer.parts.size(); ++i) {
            std::vector<double>& levels = counts.f_levels[at(even.cylinders[i])];
            if (!closer.parts[i] && !levels.empty()) {
                levels.clear();
                all = false;
            }
        }
        if (all && closer.whole && graded.folded <= even.folded) {
            graded.warnings.emplace_back(
                "grid.spacing: of cylinders that are joined rows alone are graded, as they share "
                "columns");
            return graded;
        }
    }
    even.warnings.emplace_back(
        "grid.spacing: stays uniform where cylinders are joined, as no graded rows come closer to "
        "the surface");
    return even;
}

JunctionWish wish_of(const Foliation& foliation, const GridOptions& options, double area) {
    JunctionWish wish;
    wish.cells = area / (options.strip_width_mm * options.strip_width_mm);
    wish.parity = options.parity;
    wish.period = options.period;
    FixedCounts fixed = fixed_counts(options, foliation.cylinders.size());
    wish.counts = std::move(fixed.counts);
    wish.paths = std::move(fixed.paths);
    return wish;
}

// Tries ever narrower strips until the quads carry the topology and none, or few, fold over.
class SizeSearch {
public:
    SizeSearch(const Foliation& foliation, const ArcNetwork& network, const GridOptions& options)
        : foliation_(foliation),
          network_(network),
          options_(options),
          area_(joined_area(foliation, network)),
          counter_(foliation, network, wish_of(foliation, options, area_)) {}

    // What strips as wide as wanted distort; none if they can't carry the topology.
    std::optional<double> distortion(const Context& context) const {
        const JunctionCounts counts = counter_.choose(counter_.wanted_cells(), context);
        const bool fits =
            counter_.has_fixed_counts() || counts.cells <= kMostExcess * counter_.wanted_cells();
        return fits ? std::optional(counts.distortion) : std::nullopt;
    }

    JoinedMesh run(const Context& context) const {
        double size = counter_.wanted_cells();
        double most = 0.0;  // Cells, once there are enough of them for the topology.
        int tightest = -1;
        for (int tries = 0; tries < kMostSizes && (most == 0.0 || size < most); ++tries) {
            const JunctionCounts counts = counter_.choose(size, context);
            tightest = tightest < 0 ? counts.tightest : tightest;
            if (!counter_.has_fixed_counts() && counts.cells > kMostExcess * size) {
                size = counts.cells;
                continue;
            }
            most = most > 0.0 ? most : kMostRefined * size;
            ArcNetwork arcs = relax_arcs(foliation_, network_, counts, context);
            JoinedMesh mesh = build(foliation_, arcs, counts, options_, context);
            if (mesh.folded > 0) {  // Columns that stay in place may do better.
                JoinedMesh even = build(foliation_, network_, counts, options_, context);
                if (even.folded < mesh.folded) {
                    mesh = std::move(even);
                    arcs = network_;
                }
            }
            const double folded = static_cast<double>(mesh.folded);
            if (folded <= std::max(kFewFolded, kFoldedShare * counts.cells)) {
                if (options_.spacing != Spacing::Uniform) {
                    mesh = with_graded_rows(std::move(mesh), {foliation_, arcs, options_}, counts,
                                            context);
                }
                return accepted(std::move(mesh), counts, size, tightest);
            }
            if (counter_.has_fixed_counts()) {
                break;
            }
            size *= kFiner;
        }
        throw Error(ErrorKind::BadOption, "cells-fold-over",
                    fmt::format("grid.junctions: with strips of {:.4g} mm, and with narrower ones "
                                "too, cells fold over where cylinders are joined; use "
                                "\"independent\", or smooth the model",
                                options_.strip_width_mm));
    }

private:
    static double joined_area(const Foliation& foliation, const ArcNetwork& network) {
        double area = 0.0;
        for (const int c : network.cylinders) {
            area += surface_area(foliation.cylinders[at(c)].mesh);
        }
        return area;
    }

    JoinedMesh accepted(JoinedMesh mesh,
                        const JunctionCounts& counts,
                        double size,
                        int tightest) const {
        if (size > counter_.wanted_cells()) {
            const double width =
                rounded_down(options_.strip_width_mm * std::sqrt(counter_.wanted_cells() / size));
            if (!options_.may_narrow) {
                refuse(width, size, tightest);
            }
            mesh.warnings.push_back(fmt::format(
                "strips are {:.4g} mm wide: wider ones can't go on from one cylinder into the "
                "next, most of all in cylinder {}",
                width, tightest));
        }
        if (mesh.folded > 0) {
            mesh.warnings.push_back(fmt::format(
                "{} cells fold over at sharp edges of the model; crease them there, or smooth "
                "the model",
                mesh.folded));
        }
        for (const int c : network_.cylinders) {
            if (counts.rows[at(c)] == 0) {
                mesh.warnings.push_back(
                    fmt::format("cylinder {}: is thinner than a quarter of a strip and left out; "
                                "its two ends are joined",
                                c));
            }
        }
        return mesh;
    }

    [[noreturn]] void refuse(double width, double size, int tightest) const {
        throw Error(
            ErrorKind::BadOption, "strips-too-wide",
            fmt::format("grid.strip_width_mm: strips of {:.4g} mm are too wide to go on from one "
                        "cylinder into the next, most of all in cylinder {}; use at most {:.4g} mm "
                        "(about {:.0f} quads), or grid.junctions \"independent\"",
                        options_.strip_width_mm, tightest, width, size));
    }

    const Foliation& foliation_;
    const ArcNetwork& network_;
    const GridOptions& options_;
    double area_ = 0.0;
    JunctionCounter counter_;
};

}  // namespace

JoinedMesh join_cylinders(const Foliation& foliation,
                          const GridOptions& options,
                          const Context& context) {
    const ArcNetwork network = find_arcs(foliation);
    if (network.cylinders.empty()) {
        return {};
    }
    const SizeSearch search(foliation, network, options);
    if (options.parity != Parity::Even || options.period == kColours) {
        return search.run(context);
    }
    GridOptions alternating = options;
    alternating.period = kColours;
    const SizeSearch plain(foliation, network, alternating);
    const std::optional<double> whole = search.distortion(context);
    const std::optional<double> least = plain.distortion(context);
    // Else the pattern breaks along a column.
    const bool is_worth_it = whole && (!least || *whole <= *least + kWorthPeriods);
    return (is_worth_it ? search : plain).run(context);
}

}  // namespace leafcutter::geometry
