#include "geometry/pants/harmonic_map.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/pants/frozen_system.h"
#include "geometry/pants/local_step.h"

namespace leafcutter::geometry {
namespace {

constexpr int kMostIterations = 40;
constexpr int kColdSweeps = 8;
constexpr int kWarmSweeps = 1;
constexpr int kRescueSweeps = 5;
constexpr int kHalvings = 8;
// A step that gains less than this part of the energy ends the iteration.
constexpr double kLeastGain = 1e-11;
// Blocked vertices may free themselves in the next steps; after so many they won't.
constexpr int kQuietIfBlocked = 4;
constexpr double kDraftGain = 1e-4;
constexpr int kDraftIterations = 15;

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
          system_(rings, weights, map.t.size()),
          standing_(map.t.size(), Standing::Free) {}

    HarmonicMapReport run(const MapOptions& options) {
        const bool draft = options.accuracy == MapAccuracy::Draft;
        const int most_iterations = draft ? kDraftIterations : kMostIterations;
        const double least_gain = draft ? kDraftGain : kLeastGain;
        const int sweeps = options.start == MapStart::Cold ? kColdSweeps : kWarmSweeps;
        for (int sweep = 0; sweep < sweeps; ++sweep) {
            sweep_all();
        }
        HarmonicMapReport report;
        report.energies.push_back(energy());
        int quiet = 0;
        while (report.iterations < most_iterations && !report.converged) {
            context_.check();
            const double before = report.energies.back();
            newton_step(before);
            report.energies.push_back(energy());
            ++report.iterations;
            const bool small = before - report.energies.back() < least_gain * before;
            quiet = small ? quiet + 1 : 0;
            report.converged = small && (draft || !any_blocked() || quiet >= kQuietIfBlocked);
        }
        report.energy = report.energies.back();
        report.factorizations = system_.factorizations();
        report.solves = system_.solves();
        report.residual = draft ? 0.0 : residual();
        return report;
    }

private:
    double energy() const { return map_energy(map_, rings_, weights_); }

    bool any_blocked() const {
        return std::find(standing_.begin(), standing_.end(), Standing::Blocked) != standing_.end();
    }

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
        const Saved before = save();
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
        restore(before);
        step_.journal().on = false;
        return move / longest;
    }

    bool is_active(int v) const {
        return map_.fixed[at(v)] == 0 && standing_[at(v)] == Standing::Free;
    }

    // What a step may change, but for words, which the journal keeps.
    struct Saved {
        std::vector<int> graph_edge;
        std::vector<double> t;
        std::vector<Standing> standing;
        std::vector<signed char> gauge;
    };

    Saved save() {
        step_.journal().on = true;
        step_.journal().words.clear();
        return {map_.graph_edge, map_.t, standing_, step_.journal().gauge};
    }

    void restore(const Saved& saved) {
        map_.graph_edge = saved.graph_edge;
        map_.t = saved.t;
        standing_ = saved.standing;
        StepJournal& journal = step_.journal();
        journal.gauge = saved.gauge;
        for (auto change = journal.words.rbegin(); change != journal.words.rend(); ++change) {
            map_.words[at(change->first)] = std::move(change->second);
        }
        journal.words.clear();
    }

    void newton_step(double before) {
        std::vector<char> active(map_.t.size());
        for (std::size_t v = 0; v < active.size(); ++v) {
            active[v] = is_active(static_cast<int>(v)) ? 1 : 0;
        }
        const Eigen::VectorXd direction =
            system_.newton_direction(map_, active, step_.journal().gauge, context_);
        const Saved saved = save();
        double length = 1.0;
        for (int halving = 0; halving < kHalvings; ++halving) {
            apply(direction, length);
            if (energy() <= before) {
                step_.journal().on = false;
                return;
            }
            restore(saved);
            length *= 0.5;
        }
        step_.journal().on = false;
        for (int sweep = 0; sweep < kRescueSweeps; ++sweep) {
            sweep_all();
        }
    }

    struct Overshoot {
        double by = 0.0;
        int vertex = 0;
        Dart dart = 0;
    };

    void apply(const Eigen::VectorXd& direction, double length) {
        std::vector<Overshoot> over;
        for (int v = 0; v < static_cast<int>(direction.size()); ++v) {
            if (!is_active(v)) {
                continue;
            }
            const double weight = map_.weight(map_.graph_edge[at(v)]);
            const double target = map_.t[at(v)] + length * direction[v];
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
    FrozenSystem system_;
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
                                     const MapOptions& options,
                                     const Context& context) {
    return Solver(map, rings, weights, context).run(options);
}

void settle_vertices(GraphMap& map,
                     const VertexRings& rings,
                     std::span<const double> weights,
                     std::span<const int> vertices,
                     int passes) {
    LocalStep step(map, rings, weights);
    const auto settle = [&](int v) {
        if (map.fixed[at(v)] == 0) {
            step.centre(v);
        }
    };
    for (int pass = 0; pass < passes; ++pass) {
        std::for_each(vertices.begin(), vertices.end(), settle);
        std::for_each(vertices.rbegin(), vertices.rend(), settle);
    }
}

}  // namespace leafcutter::geometry
