#include "geometry/pants/harmonic_map.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/pants/local_step.h"
#include "geometry/sparse_solver.h"

namespace leafcutter::geometry {
namespace {

constexpr int kMostIterations = 80;
constexpr int kColdSweeps = 50;
constexpr int kWarmSweeps = 3;
constexpr int kRescueSweeps = 5;
constexpr int kHalvings = 8;
// Two steps in a row that gain less than this part of the energy end the iteration.
constexpr double kLeastGain = 1e-12;

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

class Solver {
public:
    Solver(GraphMap& map,
           const VertexRings& rings,
           std::span<const double> weights,
           const Context& context)
        : map_(map),
          rings_(rings),
          weights_(weights),
          context_(context),
          step_(map, rings, weights),
          standing_(map.t.size(), Standing::Free) {}

    HarmonicMapReport run(int first_sweeps) {
        for (int sweep = 0; sweep < first_sweeps; ++sweep) {
            sweep_all();
        }
        HarmonicMapReport report;
        report.energy = energy();
        int quiet = 0;
        while (report.iterations < kMostIterations && quiet < 2) {
            context_.check();
            const double before = report.energy;
            newton_step(before);
            report.energy = energy();
            ++report.iterations;
            const bool blocked =
                std::count(standing_.begin(), standing_.end(), Standing::Blocked) > 0;
            quiet = before - report.energy < kLeastGain * before && !blocked ? quiet + 1 : 0;
        }
        report.converged = quiet >= 2;
        report.residual = residual();
        return report;
    }

private:
    double energy() const { return map_energy(map_, rings_, weights_); }

    void settle(int v) {
        if (map_.fixed[at(v)] == 0) {
            standing_[at(v)] = step_.centre(v);
        }
    }

    void sweep_all() {
        context_.check();
        const int count = static_cast<int>(map_.t.size());
        for (int v = 0; v < count; ++v) {
            settle(v);
        }
        for (int v = count - 1; v >= 0; --v) {
            settle(v);
        }
    }

    double residual() {
        const GraphMap before = map_;
        double move = 0.0;
        double longest = 0.0;
        for (const MetricGraph::Edge& edge : map_.graph.edges) {
            longest = std::max(longest, edge.weight);
        }
        for (int v = 0; v < static_cast<int>(map_.t.size()); ++v) {
            settle(v);
            if (map_.graph_edge[at(v)] == before.graph_edge[at(v)]) {
                move = std::max(move, std::abs(map_.t[at(v)] - before.t[at(v)]));
            }
        }
        map_ = before;
        return move / longest;
    }

    bool is_active(int v) const {
        return map_.fixed[at(v)] == 0 && standing_[at(v)] == Standing::Free;
    }

    // Positions that minimise the energy with all words as they are.
    std::vector<double> frozen_minimum() const {
        std::vector<int> unknown(map_.t.size(), -1);
        int unknowns = 0;
        for (std::size_t v = 0; v < unknown.size(); ++v) {
            if (is_active(static_cast<int>(v))) {
                unknown[v] = unknowns++;
            }
        }
        std::vector<MatrixEntry> matrix;
        matrix.reserve(rings_.edges.size() * 3);
        Eigen::VectorXd right = Eigen::VectorXd::Zero(unknowns);
        for (std::size_t e = 0; e < rings_.edges.size(); ++e) {
            add_edge(e, unknown, matrix, right);
        }
        std::vector<double> target = map_.t;
        if (unknowns == 0) {
            return target;
        }
        const Eigen::VectorXd solution = SparseSolver(unknowns, matrix).solve(right);
        for (std::size_t v = 0; v < unknown.size(); ++v) {
            if (unknown[v] >= 0) {
                target[v] = solution[unknown[v]];
            }
        }
        return target;
    }

    // The term w (constant - sa ta + sb tb)^2 of one mesh edge a -> b.
    void add_edge(std::size_t e,
                  const std::vector<int>& unknown,
                  std::vector<MatrixEntry>& matrix,
                  Eigen::VectorXd& right) const {
        const MeshEdge& edge = rings_.edges[e];
        const Word& word = map_.words[e];
        double constant = 0.0;
        double sa = 1.0;
        double sb = 1.0;
        if (!word.empty()) {
            const bool leaves_forward = runs_forward(word.front());
            const bool enters_forward = runs_forward(word.back());
            sa = leaves_forward ? 1.0 : -1.0;
            sb = enters_forward ? 1.0 : -1.0;
            constant = map_.inner_length(word) +
                       (leaves_forward ? map_.weight(edge_of(word.front())) : 0.0) +
                       (enters_forward ? 0.0 : map_.weight(edge_of(word.back())));
        }
        const double w = weights_[e];
        const int a = unknown[at(edge.from)];
        const int b = unknown[at(edge.to)];
        const double ta = map_.t[at(edge.from)];
        const double tb = map_.t[at(edge.to)];
        if (a >= 0) {
            matrix.push_back({a, a, w});
            right[a] += w * sa * (constant + (b < 0 ? sb * tb : 0.0));
        }
        if (b >= 0) {
            matrix.push_back({b, b, w});
            right[b] += w * sb * ((a < 0 ? sa * ta : 0.0) - constant);
        }
        if (a >= 0 && b >= 0) {
            matrix.push_back({std::max(a, b), std::min(a, b), -w * sa * sb});
        }
    }

    void newton_step(double before) {
        std::vector<double> direction = frozen_minimum();
        for (std::size_t v = 0; v < direction.size(); ++v) {
            direction[v] -= map_.t[v];
        }
        const GraphMap saved = map_;
        const std::vector<Standing> saved_standing = standing_;
        double length = 1.0;
        for (int halving = 0; halving < kHalvings; ++halving) {
            apply(direction, length);
            if (energy() <= before) {
                return;
            }
            map_ = saved;
            standing_ = saved_standing;
            length *= 0.5;
        }
        for (int sweep = 0; sweep < kRescueSweeps; ++sweep) {
            sweep_all();
        }
    }

    struct Overshoot {
        double by = 0.0;
        int vertex = 0;
        Dart dart = 0;
    };

    void apply(const std::vector<double>& direction, double length) {
        std::vector<Overshoot> over;
        for (int v = 0; v < static_cast<int>(direction.size()); ++v) {
            if (!is_active(v)) {
                continue;
            }
            const double weight = map_.weight(map_.graph_edge[at(v)]);
            const double target = map_.t[at(v)] + length * direction[at(v)];
            map_.t[at(v)] = std::clamp(target, 0.0, weight);
            const double by = std::max(target - weight, -target);
            if (by > 0.0) {
                over.push_back({by, v, 2 * map_.graph_edge[at(v)] + (target > weight ? 0 : 1)});
            }
        }
        std::sort(over.begin(), over.end(), [](const Overshoot& a, const Overshoot& b) {
            return a.by != b.by ? a.by > b.by : a.vertex < b.vertex;
        });
        std::vector<char> touched(map_.t.size(), 0);
        push_over(over, touched);
        relax_near_nodes(touched);
    }

    void push_over(std::vector<Overshoot> over, std::vector<char>& touched) {
        for (int pass = 0; pass < 3 && !over.empty(); ++pass) {
            std::vector<Overshoot> later;
            for (const Overshoot& one : over) {
                const int runs = step_.push_through(one.vertex, one.dart, one.by);
                touched[at(one.vertex)] = 1;
                if (runs == 0) {
                    later.push_back(one);
                } else if (runs > 1) {
                    standing_[at(one.vertex)] = Standing::Blocked;
                }
            }
            over = std::move(later);
        }
    }

    // Exact one-vertex steps where words may change: at the nodes and in one ring round them.
    void relax_near_nodes(std::vector<char>& touched) {
        std::vector<char> near = touched;
        for (std::size_t e = 0; e < rings_.edges.size(); ++e) {
            if (!map_.words[e].empty()) {
                near[at(rings_.edges[e].from)] = 1;
                near[at(rings_.edges[e].to)] = 1;
            }
        }
        for (std::size_t v = 0; v < near.size(); ++v) {
            near[v] = near[v] != 0 || standing_[v] != Standing::Free ? 1 : 0;
        }
        const std::vector<char> core = near;
        for (const MeshEdge& edge : rings_.edges) {
            if (core[at(edge.from)] != 0 || core[at(edge.to)] != 0) {
                near[at(edge.from)] = 1;
                near[at(edge.to)] = 1;
            }
        }
        const int count = static_cast<int>(near.size());
        for (int pass = 0; pass < 2; ++pass) {
            for (int v = 0; v < count; ++v) {
                if (near[at(v)] != 0) {
                    settle(v);
                }
            }
            for (int v = count - 1; v >= 0; --v) {
                if (near[at(v)] != 0) {
                    settle(v);
                }
            }
        }
    }

    GraphMap& map_;
    const VertexRings& rings_;
    std::span<const double> weights_;
    const Context& context_;
    LocalStep step_;
    std::vector<Standing> standing_;
};

}  // namespace

double map_energy(const GraphMap& map, const VertexRings& rings, std::span<const double> weights) {
    double energy = 0.0;
    for (std::size_t e = 0; e < rings.edges.size(); ++e) {
        const double d = map.distance(rings.edges[e].from, rings.edges[e].to, map.words[e]);
        energy += 0.5 * weights[e] * d * d;
    }
    return energy;
}

HarmonicMapReport solve_harmonic_map(GraphMap& map,
                                     const VertexRings& rings,
                                     std::span<const double> weights,
                                     MapStart start,
                                     const Context& context) {
    return Solver(map, rings, weights, context)
        .run(start == MapStart::Cold ? kColdSweeps : kWarmSweeps);
}

}  // namespace leafcutter::geometry
