#include "geometry/pants/near_points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include <Eigen/Dense>
#include <fmt/format.h>

#include "geometry/pants/prong_places.h"
#include "geometry/parallel.h"
#include "geometry/reached_points.h"
#include "geometry/surface_distance.h"

namespace leafcutter::geometry {
namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();
constexpr std::size_t kMostStarts = 6;    // Maps whose weights are searched a little …
constexpr std::size_t kMostFollowed = 2;  // … and to the end.
constexpr int kFirstSteps = 4;
constexpr int kMostSteps = 30;
constexpr double kMostChange = 1.6;   // Of the logarithm of a weight: a factor of 5.
constexpr double kProbe = 0.1;        // Change of that logarithm for differences.
constexpr double kLongestStep = 0.7;  // In one of them, of one step.
// Part of the mean square slope that is added for caution; how it changes after a step that helped
// and after one that didn't.
constexpr double kLeastCaution = 1e-2;
constexpr double kBolder = 0.2;
constexpr double kMoreCautious = 5.0;
constexpr double kMostCaution = 10.0;
constexpr double kLeastGain = 0.01;  // Part of the cost that a step must take away to go on.
constexpr double kGoodGain = 0.9;    // After less the slope is no longer that of the place.
// No cylinder may become shorter than this part of its circumference, unless it was.
constexpr double kLeastAspect = 0.01;
// Places are known to about an edge of the level.
constexpr double kSameEdges = 1.0;
constexpr double kThereEdges = 0.25;

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

double mean_edge(const Hierarchy::Level& level) {
    double sum = 0.0;
    for (const MeshEdge& edge : level.rings.edges) {
        sum += (level.surface.mesh.positions[at(edge.from)] -
                level.surface.mesh.positions[at(edge.to)])
                   .norm();
    }
    return sum / static_cast<double>(level.rings.edges.size());
}

// Where the nearest points of a map lie, one for each wanted place.
struct Nearest {
    std::vector<ProngPlace> places;
    std::vector<double> distances;
    double cost = kFar;  // Sum of the squared distances.
};

// A solved map and how near it comes.
struct Candidate {
    CoarseMap map;
    Nearest nearest;
    Eigen::VectorXd origin;  // Logarithms of the weights that a search began with.
};

class NearSearch {
public:
    NearSearch(const Hierarchy& hierarchy, std::span<const int> wanted, const Context& context)
        : level_(hierarchy.levels.back()), edge_(mean_edge(level_)) {
        SurfaceDistance search(level_.surface.mesh);
        for (int vertex : wanted) {
            context.check();
            for (const Hierarchy::Level& level : hierarchy.levels) {
                vertex = level.representative.empty() ? vertex : level.representative[at(vertex)];
            }
            wanted_.push_back(level_.surface.mesh.positions[at(vertex)]);
            std::vector<double>& distances =
                distances_.emplace_back(level_.surface.mesh.positions.size(), kFar);
            for (const SurfaceDistance::Reached& reached : search.from(std::array{vertex})) {
                distances[at(reached.vertex)] = reached.distance;
            }
        }
    }

    Nearest nearest(const GraphMap& map) const {
        const std::vector<ProngPlace> places = prong_places(level_, map);
        if (places.size() < wanted_.size()) {
            throw Error(ErrorKind::BadOption, "too-many-near",
                        fmt::format("foliation.singularities: {} wanted, but pants of this surface "
                                    "have {}; ask for fewer",
                                    wanted_.size(), places.size()));
        }
        Eigen::MatrixXd squares(wanted_.size(), places.size());
        for (std::size_t k = 0; k < wanted_.size(); ++k) {
            for (std::size_t p = 0; p < places.size(); ++p) {
                const double distance = distance_of(k, places[p]);
                squares(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(p)) =
                    distance * distance;
            }
        }
        Nearest nearest;
        nearest.cost = 0.0;
        const std::vector<int> chosen = assign_columns(squares);
        for (std::size_t k = 0; k < wanted_.size(); ++k) {
            const double square = squares(static_cast<Eigen::Index>(k), chosen[k]);
            nearest.cost += square;
            nearest.places.push_back(places[at(chosen[k])]);
            nearest.distances.push_back(std::sqrt(square));
        }
        return nearest;
    }

    // Root mean square of the distances, in edges of the level.
    double edges_away(const Nearest& nearest) const {
        return std::sqrt(nearest.cost / static_cast<double>(wanted_.size())) / edge_;
    }

    // Damped Gauss-Newton steps on the logarithms of the weights. Broyden's updates save most of
    // the solves that differences take.
    Candidate improve(Candidate best, int most_steps, const Context& context) const {
        const double aspect = std::min(kLeastAspect, least_aspect(best.map.map));
        Eigen::MatrixXd slope;
        bool is_fresh = false;
        double caution = kLeastCaution;
        for (int step = 0; step < most_steps && edges_away(best.nearest) > kThereEdges; ++step) {
            if (slope.size() == 0) {
                slope = slope_at(best, context);
                is_fresh = true;
                caution = kLeastCaution;
            }
            const Eigen::VectorXd logs = log_weights(best.map);
            const Eigen::VectorXd goal =
                (logs + damped_step(slope, residual_of(best.nearest), caution))
                    .cwiseMax((best.origin.array() - kMostChange).matrix())
                    .cwiseMin((best.origin.array() + kMostChange).matrix());
            Candidate moved = solve(best, goal, context);
            const double gain = 1.0 - moved.nearest.cost / best.nearest.cost;
            if (gain > 0.0 && least_aspect(moved.map.map) >= aspect) {
                update(slope, best.nearest, moved, goal - logs);
                best = std::move(moved);
                is_fresh = is_fresh && gain > kGoodGain;
                caution *= kBolder;
            } else {
                caution *= kMoreCautious;
            }
            if (caution > kMostCaution || (gain > 0.0 && gain < kLeastGain)) {
                if (is_fresh) {
                    break;
                }
                slope.resize(0, 0);
            }
        }
        return best;
    }

    // A few steps from each of the first candidates, then on from those that come nearest.
    std::vector<Candidate> from_several(std::span<const Candidate> candidates,
                                        const Context& context) const {
        std::vector<Candidate> moved;
        for (const Candidate& candidate :
             candidates.first(std::min(candidates.size(), kMostStarts))) {
            moved.push_back(candidate);
            moved.back().map.name += ", moved";
            moved.back().origin = log_weights(candidate.map);
        }
        const auto go_on = [&](int steps) {
            for_each_task(moved.size(), context, [&](std::size_t i, const Context& own) {
                moved[i] = improve(std::move(moved[i]), steps, own);
            });
            std::stable_sort(moved.begin(), moved.end(), [](const auto& a, const auto& b) {
                return a.nearest.cost < b.nearest.cost;
            });
        };
        go_on(kFirstSteps);
        moved.resize(std::min(moved.size(), kMostFollowed));
        go_on(kMostSteps);
        return moved;
    }

private:
    static Eigen::VectorXd log_weights(const CoarseMap& map) {
        const std::vector<MetricGraph::Edge>& edges = map.map.graph.edges;
        Eigen::VectorXd logs(edges.size());
        for (std::size_t e = 0; e < edges.size(); ++e) {
            logs[static_cast<Eigen::Index>(e)] = std::log(edges[e].weight);
        }
        return logs;
    }

    // Height over circumference of the flattest cylinder. Its energy is their product.
    double least_aspect(const GraphMap& map) const {
        const VertexRings& rings = level_.flipped.rings;
        std::vector<double> energy(map.graph.edges.size(), 0.0);
        for (std::size_t e = 0; e < rings.edges.size(); ++e) {
            const MeshEdge& edge = rings.edges[e];
            const double d = map.distance(edge.from, edge.to, map.words[e]);
            for (const int v : {edge.from, edge.to}) {
                energy[at(map.graph_edge[at(v)])] += 0.5 * level_.flipped.weights[e] * d * d;
            }
        }
        double least = kFar;
        for (std::size_t e = 0; e < energy.size(); ++e) {
            const double height = map.graph.edges[e].weight;
            least = std::min(least, height * height / std::max(energy[e], 1e-12 * height * height));
        }
        return least;
    }

    double distance_of(std::size_t wanted, const ProngPlace& place) const {
        std::array<Eigen::Vector3d, 3> corners;
        std::array<double, 3> distances{};
        for (std::size_t i = 0; i < 3; ++i) {
            corners[i] = level_.surface.mesh.positions[at(place.corners[i])];
            distances[i] = distances_[wanted][at(place.corners[i])];
        }
        return distance_inside(corners, distances, place.position);
    }

    // From the wanted place to the point: as long as the way along the surface, in the direction
    // in which it arrives.
    Eigen::Vector3d way_to(std::size_t wanted, const ProngPlace& place, double length) const {
        const Eigen::Vector3d straight = place.position - wanted_[wanted];
        const Eigen::Vector3d& a = level_.surface.mesh.positions[at(place.corners[0])];
        Eigen::Matrix<double, 3, 2> sides;
        Eigen::Vector2d rise;
        for (Eigen::Index i = 0; i < 2; ++i) {
            const int v = place.corners[static_cast<std::size_t>(i) + 1];
            sides.col(i) = level_.surface.mesh.positions[at(v)] - a;
            rise[i] = distances_[wanted][at(v)] - distances_[wanted][at(place.corners[0])];
        }
        const Eigen::Vector3d gradient =
            sides * (sides.transpose() * sides).colPivHouseholderQr().solve(rise);
        const bool is_near = length < 2.0 * edge_ || !(gradient.norm() > 0.1);
        return length * (is_near ? straight : gradient).stableNormalized();
    }

    Eigen::VectorXd residual_of(const Nearest& nearest) const {
        Eigen::VectorXd residual(3 * nearest.places.size());
        for (std::size_t k = 0; k < nearest.places.size(); ++k) {
            residual.segment<3>(3 * static_cast<Eigen::Index>(k)) =
                way_to(k, nearest.places[k], nearest.distances[k]);
        }
        return residual;
    }

    Candidate solve(const Candidate& start,
                    const Eigen::VectorXd& log_weights,
                    const Context& context) const {
        std::vector<double> weights(at(static_cast<int>(log_weights.size())));
        for (std::size_t e = 0; e < weights.size(); ++e) {
            weights[e] = std::exp(log_weights[static_cast<Eigen::Index>(e)]);
        }
        Candidate solved{with_other_weights(level_, start.map, weights, context), {}, start.origin};
        solved.nearest = nearest(solved.map.map);
        return solved;
    }

    // Moves of the points by changes of the logarithms. All weights together move nothing, so the
    // last one stays.
    Eigen::MatrixXd slope_at(const Candidate& here, const Context& context) const {
        const Eigen::VectorXd logs = log_weights(here.map);
        Eigen::MatrixXd slope =
            Eigen::MatrixXd::Zero(3 * static_cast<Eigen::Index>(wanted_.size()), logs.size());
        for (Eigen::Index e = 0; e + 1 < logs.size(); ++e) {
            Eigen::VectorXd probe = logs;
            probe[e] += kProbe;
            const CoarseMap moved = solve(here, probe, context).map;
            const std::vector<ProngPlace> places = prong_places(level_, moved.map);
            for (std::size_t k = 0; k < wanted_.size(); ++k) {
                const Eigen::Vector3d& old = here.nearest.places[k].position;
                slope.block<3, 1>(3 * static_cast<Eigen::Index>(k), e) =
                    (closest_to(old, places) - old) / kProbe;
            }
        }
        return slope;
    }

    // Broyden's: the slope that explains the last move, else as before.
    void update(Eigen::MatrixXd& slope,
                const Nearest& old,
                const Candidate& moved,
                const Eigen::VectorXd& move) const {
        const std::vector<ProngPlace> places = prong_places(level_, moved.map.map);
        for (std::size_t k = 0; k < wanted_.size(); ++k) {
            const auto row = 3 * static_cast<Eigen::Index>(k);
            const Eigen::Vector3d& before = old.places[k].position;
            const Eigen::Vector3d surprise =
                closest_to(before, places) - before - slope.middleRows<3>(row) * move;
            slope.middleRows<3>(row) +=
                surprise * move.transpose() / std::max(move.squaredNorm(), 1e-12);
        }
    }

    static Eigen::Vector3d closest_to(const Eigen::Vector3d& old,
                                      const std::vector<ProngPlace>& places) {
        return std::min_element(places.begin(), places.end(),
                                [&](const ProngPlace& a, const ProngPlace& b) {
                                    return (a.position - old).squaredNorm() <
                                           (b.position - old).squaredNorm();
                                })
            ->position;
    }

    static Eigen::VectorXd damped_step(const Eigen::MatrixXd& slope,
                                       const Eigen::VectorXd& residual,
                                       double caution) {
        Eigen::MatrixXd normal = slope.transpose() * slope;
        const double scale = normal.trace() / static_cast<double>(normal.rows());
        normal.diagonal().array() += caution * std::max(scale, 1e-300);
        const Eigen::VectorXd step = normal.ldlt().solve(-(slope.transpose() * residual));
        const double longest = step.cwiseAbs().maxCoeff();
        return longest > kLongestStep ? Eigen::VectorXd(step * (kLongestStep / longest)) : step;
    }

    const Hierarchy::Level& level_;
    double edge_;
    std::vector<Eigen::Vector3d> wanted_;
    std::vector<std::vector<double>> distances_;  // Per wanted place, per vertex of the level.
};

// Nearest first; what differs by less than an edge is equally near.
void sort_by_distance(std::vector<Candidate>& candidates, const NearSearch& search) {
    const auto edges = [&](const Candidate& c) {
        return std::round(search.edges_away(c.nearest) / kSameEdges);
    };
    std::stable_sort(candidates.begin(), candidates.end(), [&](const auto& a, const auto& b) {
        return std::pair(edges(a), a.map.score) < std::pair(edges(b), b.map.score);
    });
}

}  // namespace

std::vector<CoarseMap> nearest_maps(const Hierarchy& hierarchy,
                                    std::vector<CoarseMap> maps,
                                    const NearOptions& options,
                                    const Context& context) {
    const NearSearch search(hierarchy, options.wanted, context);
    std::vector<Candidate> candidates;
    for (CoarseMap& map : maps) {
        Nearest nearest = search.nearest(map.map);
        candidates.push_back({std::move(map), std::move(nearest), {}});
    }
    sort_by_distance(candidates, search);
    const bool is_there = search.edges_away(candidates.front().nearest) <= kSameEdges;
    if (!options.weights_are_fixed && !is_there) {
        for (Candidate& moved : search.from_several(candidates, context)) {
            candidates.push_back(std::move(moved));
        }
        sort_by_distance(candidates, search);
    }
    maps.clear();
    for (Candidate& candidate : candidates) {
        maps.push_back(std::move(candidate.map));
    }
    return maps;
}

}  // namespace leafcutter::geometry
