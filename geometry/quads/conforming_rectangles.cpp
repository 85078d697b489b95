#include "geometry/quads/conforming_rectangles.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include <fmt/format.h>

#include "geometry/error.h"
#include "geometry/parallel.h"
#include "geometry/quads/critical_sides.h"
#include "geometry/quads/flank_vertices.h"
#include "geometry/quads/joined_pieces.h"
#include "geometry/quads/rectangle_charts.h"
#include "geometry/quads/rectangle_counts.h"
#include "geometry/quads/rectangle_rows.h"
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
constexpr double kFewFolded = 1.0;
constexpr double kFoldedShare = 0.005;

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

JoinedPiece make_piece(const RectanglePlan& plan, int cylinder, const Context& context) {
    Cylinder chart = bend_chart(plan, cylinder, context);
    CylinderGrid grid = rectangle_grid(plan, chart, cylinder);
    return sample_piece(std::move(chart), std::move(grid), cylinder, context);
}

// Gives a piece's vertices their numbers in the whole.
void number_piece(const RectanglePlan& plan,
                  const FlankVertices& shared,
                  int cylinder,
                  JoinedPiece& piece,
                  std::vector<Vector3d>& vertices) {
    const auto& flanks = plan.network.flanks[at(cylinder)];
    const ChartGrid grid(piece.chart, piece.grid);
    const std::vector<int> left = shared.along(flanks[SideNetwork::Left]);
    const std::vector<int> right = shared.along(flanks[SideNetwork::Right]);
    std::vector<int> number(piece.patch.vertices.size(), -1);
    for (int row = 0; row <= piece.grid.rows; ++row) {
        number[at(grid.vertex(row, 0))] = left.at(at(row));
        number[at(grid.vertex(row, piece.grid.cols))] = right.at(at(row));
        for (int col = 1; col < piece.grid.cols; ++col) {
            number[at(grid.vertex(row, col))] = static_cast<int>(vertices.size());
            vertices.push_back(piece.patch.vertices[at(grid.vertex(row, col))]);
        }
    }
    renumber(piece, number);
}

// Edges that only one quad has: at sources, sinks and natural loops.
int open_edges(const RectanglePlan& plan) {
    int edges = 0;
    for (const int c : plan.network.cylinders) {
        edges += 2 * plan.counts.cols[at(c)];
        for (const Flank& flank : plan.network.flanks[at(c)]) {
            for (const SideUse& use : flank.uses) {
                const CriticalSide& side = plan.network.sides[at(use.side)];
                if (side.left < 0 || side.right < 0) {
                    const int low = plan.network.zero_of(side.points.front());
                    const int high = plan.network.zero_of(side.points.back());
                    edges += plan.rows.rows_below(c, high) -
                             (low < 0 ? 0 : plan.rows.rows_below(c, low));
                }
            }
        }
    }
    return edges;
}

// What theory says: every edge between two quads but those on loops, Euler characteristic by the
// zeros' prongs, four quads round every vertex inside but twice its prongs round a zero.
void check_whole(const RectanglePlan& plan, const FlankVertices& shared, const JoinedMesh& mesh) {
    JoinedTopology wanted;
    wanted.valences.assign(mesh.vertices.size(), 4);
    for (const FormZeroPlace& zero : plan.network.zeros) {
        const int prongs = plan.foliation.critical_points[at(zero.point)].prongs;
        wanted.valences[at(shared.stops().at(zero.point))] = 2 * prongs;
        wanted.doubled_euler -= prongs - 2;
    }
    wanted.open_edges = open_edges(plan);
    check_topology(mesh, wanted, "rectangles");
}

JoinedMesh build(const RectanglePlan& plan, const GridOptions& options, const Context& context) {
    std::vector<JoinedPiece> pieces(plan.network.cylinders.size());
    for_each_task(pieces.size(), context, [&](std::size_t i, const Context& own) {
        pieces[i] = make_piece(plan, plan.network.cylinders[i], own);
    });
    JoinedMesh mesh;
    mesh.cylinders = plan.network.cylinders;
    const FlankVertices shared(plan);
    mesh.vertices = shared.positions();
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        number_piece(plan, shared, plan.network.cylinders[i], pieces[i], mesh.vertices);
    }
    add_parts(mesh, std::move(pieces), options);
    check_whole(plan, shared, mesh);
    return mesh;
}

RectangleWish wish_of(const Foliation& foliation, const GridOptions& options, double area) {
    RectangleWish wish;
    wish.cells = area / (options.strip_width_mm * options.strip_width_mm);
    wish.parity = options.parity;
    FixedCounts fixed = fixed_counts(options, foliation.cylinders.size());
    wish.counts = std::move(fixed.counts);
    wish.paths = std::move(fixed.paths);
    return wish;
}

// Tries ever narrower strips until the quads carry the topology and none, or few, fold over.
class SizeSearch {
public:
    SizeSearch(const Foliation& foliation, const SideNetwork& network, const GridOptions& options)
        : foliation_(foliation),
          network_(network),
          options_(options),
          area_(joined_area(foliation, network)),
          counter_(foliation, network, wish_of(foliation, options, area_)) {}

    JoinedMesh run(const Context& context) {
        double size = counter_.wanted_cells();
        double most = 0.0;  // Cells, once there are enough of them for the topology.
        for (int tries = 0; tries < kMostSizes && (most == 0.0 || size < most); ++tries) {
            RectangleCounts counts = counter_.choose(size, context);
            tightest_ = tightest_ < 0 ? counts.tightest : tightest_;
            if (!counter_.has_fixed_counts() && counts.cells > kMostExcess * size) {
                size = counts.cells;
                continue;
            }
            most = most > 0.0 ? most : kMostRefined * size;
            const RectangleRows rows(network_, counter_, counts);
            JoinedMesh mesh = build({foliation_, network_, counts, rows}, options_, context);
            if (static_cast<double>(mesh.folded) <=
                std::max(kFewFolded, kFoldedShare * counts.cells)) {
                return accepted(std::move(mesh), size);
            }
            if (counter_.has_fixed_counts()) {
                break;
            }
            size *= kFiner;
        }
        throw Error(ErrorKind::BadOption, "cells-fold-over",
                    fmt::format("grid.junctions: with strips of {:.4g} mm, and with narrower ones "
                                "too, cells fold over where rectangles are joined; use "
                                "\"independent\", or smooth the model",
                                options_.strip_width_mm));
    }

private:
    static double joined_area(const Foliation& foliation, const SideNetwork& network) {
        double area = 0.0;
        for (const int c : network.cylinders) {
            area += surface_area(foliation.cylinders[at(c)].mesh);
        }
        return area;
    }

    JoinedMesh accepted(JoinedMesh mesh, double size) const {
        if (size > counter_.wanted_cells()) {
            const double width = rounded_down(std::sqrt(area_ / size));
            if (!options_.may_narrow) {
                refuse(width, size);
            }
            mesh.warnings.push_back(fmt::format(
                "strips are {:.4g} mm wide: wider ones can't go on from one rectangle into the "
                "next, most of all in cylinder {}",
                width, tightest_));
        }
        if (mesh.folded > 0) {
            mesh.warnings.push_back(fmt::format(
                "{} cells fold over at sharp edges of the model; crease them there, or smooth "
                "the model",
                mesh.folded));
        }
        return mesh;
    }

    [[noreturn]] void refuse(double width, double size) const {
        throw Error(
            ErrorKind::BadOption, "strips-too-wide",
            fmt::format("grid.strip_width_mm: strips of {:.4g} mm are too wide to go on from one "
                        "rectangle into the next, most of all in cylinder {}; use at most {:.4g} "
                        "mm (about {:.0f} quads), or grid.junctions \"independent\"",
                        options_.strip_width_mm, tightest_, width, size));
    }

    const Foliation& foliation_;
    const SideNetwork& network_;
    const GridOptions& options_;
    double area_ = 0.0;
    RectangleCounter counter_;
    int tightest_ = -1;  // At the wanted size.
};

}  // namespace

void merge_joined(JoinedMesh& mesh, JoinedMesh&& more) {
    const int base = static_cast<int>(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), more.vertices.begin(), more.vertices.end());
    mesh.folded += more.folded;
    mesh.warnings.insert(mesh.warnings.end(), more.warnings.begin(), more.warnings.end());
    for (std::size_t i = 0; i < more.parts.size(); ++i) {
        for (std::array<int, 4>& quad : more.parts[i].quads) {
            for (int& corner : quad) {
                corner += base;
            }
        }
        const auto place =
            std::lower_bound(mesh.cylinders.begin(), mesh.cylinders.end(), more.cylinders[i]) -
            mesh.cylinders.begin();
        mesh.cylinders.insert(mesh.cylinders.begin() + place, more.cylinders[i]);
        mesh.parts.insert(mesh.parts.begin() + place, std::move(more.parts[i]));
    }
}

JoinedMesh join_rectangles(const Foliation& foliation,
                           const GridOptions& options,
                           const Context& context) {
    const SideNetwork network = find_sides(foliation);
    if (network.cylinders.empty()) {
        return {};
    }
    return SizeSearch(foliation, network, options).run(context);
}

}  // namespace leafcutter::geometry
