#include "geometry/cases/flow_search.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>

#include "geometry/coarse_version.h"
#include "geometry/half_edges.h"
#include "geometry/laplacian.h"
#include "geometry/pants/vertex_rings.h"
#include "geometry/reached_points.h"
#include "geometry/surface_distance.h"

namespace leafcutter::geometry {
namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();
constexpr std::size_t kCoarseVertices = 6000;
constexpr std::size_t kMostTried = 10;  // Loops of which all ways to choose are looked at.
// By how much less the squared distances must be to count.
constexpr double kBetter = 1.0 - 1e-9;

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

enum class Role : char { Source, Sink };
using Roles = std::vector<Role>;  // Per loop.

class FlowSearch {
public:
    FlowSearch(const TriangleMesh& mesh,
               const std::vector<std::vector<int>>& loops,
               std::span<const int> near,
               const Context& context)
        : context_(context), coarse_(coarse_version(mesh, kCoarseVertices, context)) {
        const int count = static_cast<int>(coarse_.mesh.positions.size());
        const HalfEdges edges = build_half_edges(coarse_.mesh.triangles, count);
        rings_ = build_vertex_rings(edges, count);
        find_loops(mesh, loops);
        solve(edges, loops.size());
        measure(mesh, near);
    }

    // The sum of the squared distances of the nearest zeros; infinite if there are too few.
    double cost(const Roles& roles) const {
        context_.check();
        const std::vector<int> zeros = zeros_of(roles);
        if (zeros.size() < distance_.size()) {
            return kFar;
        }
        Eigen::MatrixXd squares(distance_.size(), zeros.size());
        for (std::size_t k = 0; k < distance_.size(); ++k) {
            for (std::size_t z = 0; z < zeros.size(); ++z) {
                const double distance = distance_[k][at(zeros[z])];
                squares(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(z)) =
                    distance * distance;
            }
        }
        const std::vector<int> chosen = assign_columns(squares);
        double sum = 0.0;
        for (std::size_t k = 0; k < chosen.size(); ++k) {
            sum += squares(static_cast<Eigen::Index>(k), chosen[k]);
        }
        return sum;
    }

private:
    void find_loops(const TriangleMesh& mesh, const std::vector<std::vector<int>>& loops) {
        std::vector<int> of_source(mesh.positions.size(), -1);
        for (std::size_t k = 0; k < loops.size(); ++k) {
            for (const int v : loops[k]) {
                of_source[at(v)] = static_cast<int>(k);
            }
        }
        for (const int source : coarse_.source_vertex) {
            loop_of_.push_back(source < 0 ? -1 : of_source[at(source)]);
        }
    }

    // Per loop the function that is 1 there and 0 at the others.
    void solve(const HalfEdges& edges, std::size_t loops) {
        const std::vector<WeightedEdge> weighted = positive_edges(coarse_.mesh, edges);
        std::vector<char> held;
        for (const int loop : loop_of_) {
            held.push_back(loop >= 0 ? 1 : 0);
        }
        const HarmonicSolver solver(weighted, held);
        for (std::size_t k = 0; k < loops; ++k) {
            context_.check();
            Eigen::VectorXd values = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(held.size()));
            for (std::size_t v = 0; v < held.size(); ++v) {
                values[static_cast<Eigen::Index>(v)] =
                    loop_of_[v] == static_cast<int>(k) ? 1.0 : 0.0;
            }
            share_.push_back(solver.solve(std::move(values)));
        }
    }

    void measure(const TriangleMesh& mesh, std::span<const int> near) {
        SurfaceDistance search(coarse_.mesh);
        for (const int wanted : near) {
            context_.check();
            const Eigen::Vector3d& place = mesh.positions[at(wanted)];
            const auto& positions = coarse_.mesh.positions;
            const auto closest = std::min_element(
                positions.begin(), positions.end(), [&](const auto& a, const auto& b) {
                    return (a - place).squaredNorm() < (b - place).squaredNorm();
                });
            std::vector<double>& distances = distance_.emplace_back(positions.size(), kFar);
            const std::array<int, 1> start{static_cast<int>(closest - positions.begin())};
            for (const SurfaceDistance::Reached& reached : search.from(start)) {
                distances[at(reached.vertex)] = reached.distance;
            }
        }
    }

    // Vertices round which f is higher and lower in turn more than once, as often as that.
    std::vector<int> zeros_of(const Roles& roles) const {
        Eigen::VectorXd f = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(loop_of_.size()));
        for (std::size_t k = 0; k < roles.size(); ++k) {
            if (roles[k] == Role::Sink) {
                f += share_[k];
            }
        }
        std::vector<int> zeros;
        for (int v = 0; v < static_cast<int>(loop_of_.size()); ++v) {
            if (loop_of_[at(v)] >= 0) {
                continue;
            }
            int changes = 0;
            bool was_higher = is_higher(f, rings_.slots[at(rings_.begin[at(v) + 1] - 1)], v);
            for (int k = rings_.begin[at(v)]; k < rings_.begin[at(v) + 1]; ++k) {
                const bool now = is_higher(f, rings_.slots[at(k)], v);
                changes += now != was_higher ? 1 : 0;
                was_higher = now;
            }
            for (; changes > 2; changes -= 2) {
                zeros.push_back(v);
            }
        }
        return zeros;
    }

    static bool is_higher(const Eigen::VectorXd& f, const RingSlot& slot, int v) {
        return std::pair(f[slot.neighbour], slot.neighbour) > std::pair(f[v], v);
    }

    const Context& context_;
    CoarseVersion coarse_;
    VertexRings rings_;
    std::vector<int> loop_of_;  // Per vertex, or -1.
    std::vector<Eigen::VectorXd> share_;
    std::vector<std::vector<double>> distance_;  // Per wanted place, per vertex.
};

bool has_both(const Roles& roles) {
    return std::find(roles.begin(), roles.end(), Role::Source) != roles.end() &&
           std::find(roles.begin(), roles.end(), Role::Sink) != roles.end();
}

// All ways to choose the free loops, as bits.
Roles best_of_all(const FlowSearch& search, const std::vector<std::size_t>& free, Roles roles) {
    Roles best;
    double least = kFar;
    for (std::uint32_t choice = 0; choice < (std::uint32_t{1} << free.size()); ++choice) {
        for (std::size_t k = 0; k < free.size(); ++k) {
            roles[free[k]] = ((choice >> k) & 1U) != 0 ? Role::Sink : Role::Source;
        }
        const double cost = has_both(roles) ? search.cost(roles) : kFar;
        if (cost < kBetter * least) {
            least = cost;
            best = roles;
        }
    }
    return best;
}

// Changes one loop after the other while that helps.
Roles best_by_changes(const FlowSearch& search, const std::vector<std::size_t>& free, Roles roles) {
    double least = search.cost(roles);
    bool helped = true;
    while (helped) {
        helped = false;
        for (const std::size_t k : free) {
            Roles other = roles;
            other[k] = roles[k] == Role::Sink ? Role::Source : Role::Sink;
            const double cost = has_both(other) ? search.cost(other) : kFar;
            if (cost < kBetter * least) {
                least = cost;
                roles = std::move(other);
                helped = true;
            }
        }
    }
    return least < kFar ? roles : Roles{};
}

}  // namespace

FlowEnds nearest_flow(const TriangleMesh& mesh,
                      const std::vector<std::vector<int>>& loops,
                      const FlowEnds& given,
                      std::span<const int> near,
                      const Context& context) {
    Roles roles(loops.size(), Role::Sink);
    std::vector<char> is_given(loops.size(), 0);
    for (const int k : given.sources) {
        roles[at(k)] = Role::Source;
        is_given[at(k)] = 1;
    }
    for (const int k : given.sinks) {
        is_given[at(k)] = 1;
    }
    std::vector<std::size_t> free;
    for (std::size_t k = 0; k < loops.size(); ++k) {
        if (is_given[k] == 0) {
            free.push_back(k);
        }
    }
    if (given.sources.empty() && given.sinks.empty() && !free.empty()) {
        roles.front() = Role::Source;  // All the other way round is the same.
        free.erase(free.begin());
    }
    const FlowSearch search(mesh, loops, near, context);
    const Roles best = free.size() <= kMostTried ? best_of_all(search, free, roles)
                                                 : best_by_changes(search, free, roles);
    if (best.empty()) {
        return given;
    }
    FlowEnds ends;
    for (std::size_t k = 0; k < best.size(); ++k) {
        (best[k] == Role::Source ? ends.sources : ends.sinks).push_back(static_cast<int>(k));
    }
    return ends;
}

}  // namespace leafcutter::geometry
