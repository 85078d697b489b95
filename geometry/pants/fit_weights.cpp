#include "geometry/pants/fit_weights.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/QR>

#include "geometry/pants/harmonic_map.h"
#include "geometry/parallel.h"

namespace leafcutter::geometry {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Of a weight, for differences.
constexpr double kDifference = 0.03;
constexpr int kMostSteps = 5;
// Columns: nearer than this is near enough.
constexpr double kNearEnough = 2e-3;

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

VectorXd logarithms(const std::vector<double>& values) {
    VectorXd result(static_cast<Index>(values.size()));
    for (std::size_t i = 0; i < values.size(); ++i) {
        result[static_cast<Index>(i)] = std::log(values[i]);
    }
    return result;
}

VectorXd centred(VectorXd values) {
    values.array() -= values.mean();
    return values;
}

std::vector<double> exponentials(const VectorXd& values) {
    std::vector<double> result;
    for (const double value : values) {
        result.push_back(std::exp(value));
    }
    return result;
}

// Logarithms of weights, and how far the circumferences they give are off, in logarithms.
struct Trial {
    GraphMap map;
    VectorXd weights;
    VectorXd off;
};

class Fitter {
public:
    Fitter(const Hierarchy::Level& level, const CircumferenceWish& wish, const Context& context)
        : level_(level),
          context_(context),
          wanted_(logarithms(wish.circumferences)),
          home_(logarithms(wish.weights)),
          columns_(Eigen::Map<const VectorXd>(wish.columns.data(),
                                              static_cast<Index>(wish.columns.size()))),
          most_(0.5 * std::log1p(wish.most_change)) {}

    GraphMap run(const GraphMap& map) {
        Trial here;
        here.map = map;
        here.weights = logarithms(weights_of(map.graph));
        measure(here);
        Trial best = here;
        MatrixXd slope = differences(here);
        for (int step = 0; step < kMostSteps && error(best) > kNearEnough; ++step) {
            Trial next;
            next.map = here.map;
            next.weights = within_limits(here.weights + newton_step(slope, here.off));
            const VectorXd moved = next.weights - here.weights;
            if (moved.norm() < 1e-9) {
                break;
            }
            solve(next, context_);
            slope +=
                ((next.off - here.off) - slope * moved) * moved.transpose() / moved.squaredNorm();
            here = std::move(next);
            if (error(here) < error(best)) {
                best = here;
            }
        }
        return std::move(best.map);
    }

private:
    void measure(Trial& trial) const {
        const std::vector<double> found =
            circumferences(trial.map, level_.flipped.rings, level_.flipped.weights);
        trial.off = centred(logarithms(found) - wanted_);
    }

    void solve(Trial& trial, const Context& context) const {
        set_weights(trial.map, exponentials(trial.weights));
        solve_harmonic_map(trial.map, level_.flipped.rings, level_.flipped.weights, MapStart::Warm,
                           context);
        measure(trial);
    }

    // The cylinder that is furthest off, in columns.
    double error(const Trial& trial) const {
        return trial.off.cwiseProduct(columns_).cwiseAbs().maxCoeff();
    }

    MatrixXd differences(const Trial& here) const {
        const Index count = here.weights.size();
        MatrixXd slope(count, count);
        for_each_task(static_cast<std::size_t>(count), context_,
                      [&](std::size_t k, const Context& own) {
                          const auto column = static_cast<Index>(k);
                          Trial trial{here.map, here.weights, {}};
                          trial.weights[column] += kDifference;
                          solve(trial, own);
                          slope.col(column) = (trial.off - here.off) / kDifference;
                      });
        return slope;
    }

    // Scale changes nothing: the step's mean is 0.
    static VectorXd newton_step(const MatrixXd& slope, const VectorXd& off) {
        const Index count = off.size();
        MatrixXd system(count + 1, count);
        system << slope, Eigen::RowVectorXd::Ones(count);
        VectorXd right(count + 1);
        right << -off, 0.0;
        return system.colPivHouseholderQr().solve(right);
    }

    // Twice the limit is how far two weights can move against each other.
    VectorXd within_limits(const VectorXd& weights) const {
        const VectorXd change = centred(weights - home_);
        return home_ + centred(change.cwiseMax(-most_).cwiseMin(most_));
    }

    const Hierarchy::Level& level_;
    const Context& context_;
    VectorXd wanted_;
    VectorXd home_;
    VectorXd columns_;
    double most_;
};

}  // namespace

void set_weights(GraphMap& map, const std::vector<double>& weights) {
    for (std::size_t v = 0; v < map.t.size(); ++v) {
        const std::size_t e = at(map.graph_edge[v]);
        map.t[v] *= weights[e] / map.graph.edges[e].weight;
    }
    for (std::size_t e = 0; e < weights.size(); ++e) {
        map.graph.edges[e].weight = weights[e];
    }
}

std::vector<double> weights_of(const MetricGraph& graph) {
    std::vector<double> weights;
    for (const MetricGraph::Edge& edge : graph.edges) {
        weights.push_back(edge.weight);
    }
    return weights;
}

std::vector<double> circumferences(const GraphMap& map,
                                   const VertexRings& rings,
                                   std::span<const double> weights) {
    std::vector<double> result(map.graph.edges.size(), 0.0);
    for (std::size_t e = 0; e < rings.edges.size(); ++e) {
        const auto [from, to] = std::pair{rings.edges[e].from, rings.edges[e].to};
        const Word& word = map.words[e];
        const double pull = weights[e] * map.distance(from, to, word);
        const auto add = [&](int edge, double length) {
            result[at(edge)] += pull * length / map.weight(edge);
        };
        if (word.empty()) {
            add(map.graph_edge[at(from)], std::abs(map.t[at(from)] - map.t[at(to)]));
            continue;
        }
        add(edge_of(word.front()), map.remaining(from, word.front()));
        for (std::size_t k = 1; k + 1 < word.size(); ++k) {
            add(edge_of(word[k]), map.weight(edge_of(word[k])));
        }
        add(edge_of(word.back()), map.remaining(to, reversed(word.back())));
    }
    return result;
}

GraphMap fit_weights(const Hierarchy::Level& level,
                     const GraphMap& map,
                     const CircumferenceWish& wish,
                     const Context& context) {
    return Fitter(level, wish, context).run(map);
}

}  // namespace leafcutter::geometry
