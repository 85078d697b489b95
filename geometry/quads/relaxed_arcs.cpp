#include "geometry/quads/relaxed_arcs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "geometry/harmonic/chart_map.h"
#include "geometry/intrinsic_delaunay.h"
#include "geometry/laplacian.h"
#include "geometry/parallel.h"
#include "geometry/sparse_solver.h"

namespace leafcutter::geometry {
namespace {

// Columns so near to a singular point stay where they are.
constexpr double kHeldColumns = 0.5;
// Of an arc's mean step; columns that come closer change the order, or nearly.
constexpr double kLeastStep = 0.05;

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

// constant + sum of factor x unknown.
struct LinearForm {
    double constant = 0.0;
    std::array<int, 2> unknown{-1, -1};
    std::array<double, 2> factor{0.0, 0.0};
};

// A vertex of a cylinder's end by the points of the arc on its two sides.
struct PlaceOnArc {
    int arc = 0;
    std::size_t from = 0;  // Index into the arc's points.
    std::size_t to = 0;
    double part = 0.0;  // Of the way between them.
};

// Calls visit(i, use, place) for every vertex i of an end that lies on arcs.
template <typename Visit>
void for_each_place(const Cylinder& chart,
                    const ArcNetwork& network,
                    const CylinderEnd& end,
                    const Visit& visit) {
    for (std::size_t u = 0; u < end.uses.size(); ++u) {
        const ArcUse& use = end.uses[u];
        const std::vector<double>& parameter = network.arcs[at(use.arc)].parameter;
        const std::size_t last =
            u + 1 < end.uses.size() ? end.uses[u + 1].first : end.vertices.size();
        std::size_t point = 0;
        for (std::size_t i = use.first; i < last; ++i) {
            if (i > use.first && chart.critical_point[at(end.vertices[i])] >= 0) {
                ++point;
            }
            PlaceOnArc place{.arc = use.arc, .from = point, .to = point + 1, .part = 0.0};
            if (!use.forward) {
                place.from = parameter.size() - 1 - point;
                place.to = place.from - 1;
            }
            const double share = use.forward ? end.share[i] : 1.0 - end.share[i];
            const double step = parameter[place.to] - parameter[place.from];
            place.part = step != 0.0 ? (share - parameter[place.from]) / step : 0.0;
            visit(i, u, place);
        }
    }
}

class Relaxer {
public:
    Relaxer(const Foliation& foliation, const ArcNetwork& network, const JunctionCounts& counts)
        : foliation_(foliation), network_(network), counts_(counts) {
        for (std::size_t a = 0; a < network.arcs.size(); ++a) {
            number_arc(a);
        }
    }

    ArcNetwork run(const Context& context) {
        if (unknowns_ == 0) {
            return network_;
        }
        const int on_arcs = unknowns_;
        std::vector<Part> parts(network_.cylinders.size());
        for_each_task(parts.size(), context, [&](std::size_t i, const Context&) {
            parts[i] = part_of(network_.cylinders[i]);
        });
        for (Part& part : parts) {
            number_inside(part);
        }
        std::vector<MatrixEntry> lower;
        Eigen::VectorXd right = Eigen::VectorXd::Zero(unknowns_);
        for (const Part& part : parts) {
            for (const WeightedEdge& edge : part.edges) {
                add(part.forms[at(edge.from)], part.forms[at(edge.to)], edge.weight, lower, right);
            }
        }
        context.check();
        const Eigen::VectorXd found = SparseSolver(unknowns_, lower).solve(right);
        return moved(found.head(on_arcs));
    }

private:
    // A cylinder's correction of g: per vertex a form, and the weights of its energy.
    struct Part {
        std::vector<WeightedEdge> edges;
        std::vector<LinearForm> forms;
        std::vector<char> on_arc;
    };

    void number_arc(std::size_t a) {
        const CriticalArc& arc = network_.arcs[a];
        const int cells = counts_.arc_cells[a];
        std::vector<int>& numbers = number_.emplace_back(arc.points.size(), -1);
        for (std::size_t k = 1; k + 1 < numbers.size(); ++k) {
            const double place = arc.parameter[k];
            if (std::min(place, 1.0 - place) * cells > kHeldColumns) {
                numbers[k] = unknowns_++;
            }
        }
    }

    Part part_of(int cylinder) const {
        const Cylinder& chart = foliation_.cylinders[at(cylinder)];
        Part part;
        const ChartMap map = reopen_chart(chart);
        part.edges = cotangent_edges(intrinsic_delaunay(map.mesh, map.edges));
        part.forms.resize(map.gf.size());
        part.on_arc.assign(map.gf.size(), 0);
        for (std::size_t side = 0; side < 2; ++side) {
            const CylinderEnd& end = network_.ends[at(cylinder)][side];
            const double column = map.width / std::max(1, counts_.cols[at(cylinder)]);
            std::vector<double> start{side == 1 ? 1.0 * counts_.twist[at(cylinder)] : 0.0};
            for (const ArcUse& use : end.uses) {
                start.push_back(start.back() + counts_.arc_cells[at(use.arc)]);
            }
            for_each_place(chart, network_, end,
                           [&](std::size_t i, std::size_t u, const PlaceOnArc& place) {
                               const std::size_t v = at(end.vertices[i]);
                               part.on_arc[v] = 1;
                               part.forms[v] = form_at(end.uses[u], place, start[u], column);
                               part.forms[v].constant -= end.g[i];
                           });
        }
        return part;
    }

    // g of a column place that is `start` columns and a share of the arc's from the end's first.
    LinearForm form_at(const ArcUse& use,
                       const PlaceOnArc& place,
                       double start,
                       double column) const {
        const double cells = column * counts_.arc_cells[at(use.arc)];
        const double along = use.forward ? cells : -cells;
        LinearForm form;
        form.constant = column * start + (use.forward ? 0.0 : cells);
        const std::array<std::size_t, 2> points{place.from, place.to};
        const std::array<double, 2> parts{1.0 - place.part, place.part};
        for (std::size_t k = 0; k < 2; ++k) {
            form.unknown[k] = number_[at(use.arc)][points[k]];
            form.factor[k] = along * parts[k];
            if (form.unknown[k] < 0) {
                form.constant += form.factor[k] * network_.arcs[at(use.arc)].parameter[points[k]];
            }
        }
        return form;
    }

    void number_inside(Part& part) {
        for (std::size_t v = 0; v < part.forms.size(); ++v) {
            if (part.on_arc[v] == 0) {
                part.forms[v].unknown[0] = unknowns_++;
                part.forms[v].factor[0] = 1.0;
            }
        }
    }

    // weight x (a - b)² to the matrix and right side.
    static void add(const LinearForm& a,
                    const LinearForm& b,
                    double weight,
                    std::vector<MatrixEntry>& lower,
                    Eigen::VectorXd& right) {
        const std::array<int, 4> unknown{a.unknown[0], a.unknown[1], b.unknown[0], b.unknown[1]};
        const std::array<double, 4> factor{a.factor[0], a.factor[1], -b.factor[0], -b.factor[1]};
        const double constant = a.constant - b.constant;
        for (std::size_t i = 0; i < 4; ++i) {
            if (unknown[i] < 0 || factor[i] == 0.0) {
                continue;
            }
            right[unknown[i]] -= weight * factor[i] * constant;
            for (std::size_t j = 0; j < 4; ++j) {
                if (unknown[j] >= 0 && unknown[j] <= unknown[i] && factor[j] != 0.0) {
                    lower.push_back({unknown[i], unknown[j], weight * factor[i] * factor[j]});
                }
            }
        }
    }

    ArcNetwork moved(const Eigen::VectorXd& parameters) const {
        ArcNetwork network = network_;
        for (std::size_t a = 0; a < network.arcs.size(); ++a) {
            std::vector<double> wished = network.arcs[a].parameter;
            for (std::size_t k = 0; k < wished.size(); ++k) {
                if (number_[a][k] >= 0) {
                    wished[k] = parameters[number_[a][k]];
                }
            }
            if (keeps_order(network.arcs[a].parameter, wished)) {
                network.arcs[a].parameter = std::move(wished);
            }
        }
        for (const int c : network.cylinders) {
            for (std::size_t side = 0; side < 2; ++side) {
                CylinderEnd& end = network.ends[at(c)][side];
                for_each_place(foliation_.cylinders[at(c)], network_, network_.ends[at(c)][side],
                               [&](std::size_t i, std::size_t u, const PlaceOnArc& place) {
                                   const auto& parameter = network.arcs[at(place.arc)].parameter;
                                   const double share = (1.0 - place.part) * parameter[place.from] +
                                                        place.part * parameter[place.to];
                                   end.share[i] = end.uses[u].forward ? share : 1.0 - share;
                               });
            }
        }
        return network;
    }

    static bool keeps_order(const std::vector<double>& before, const std::vector<double>& after) {
        for (std::size_t k = 0; k + 1 < before.size(); ++k) {
            if (!(after[k + 1] - after[k] >= kLeastStep * (before[k + 1] - before[k]))) {
                return false;
            }
        }
        return true;
    }

    const Foliation& foliation_;
    const ArcNetwork& network_;
    const JunctionCounts& counts_;
    std::vector<std::vector<int>> number_;  // Per arc and point: its unknown, or -1.
    int unknowns_ = 0;
};

}  // namespace

ArcNetwork relax_arcs(const Foliation& foliation,
                      const ArcNetwork& network,
                      const JunctionCounts& counts,
                      const Context& context) {
    return Relaxer(foliation, network, counts).run(context);
}

}  // namespace leafcutter::geometry
