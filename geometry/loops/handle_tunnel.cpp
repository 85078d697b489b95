#include "geometry/loops/handle_tunnel.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <queue>
#include <string>
#include <utility>

#include <Eigen/LU>
#include <fmt/format.h>

#include "geometry/error.h"
#include "geometry/half_edges.h"
#include "geometry/loops/linking.h"
#include "geometry/loops/short_loops.h"
#include "geometry/loops/tree_cotree.h"

namespace leafcutter::geometry {
namespace {

// Places spread over the surface that loops are searched from,
constexpr std::size_t kRoots = 64;
// and places on the best loop found that are tried afterwards, so many times over.
constexpr std::size_t kRootsOnLoop = 6;
constexpr int kRefinements = 2;

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

// A closed surface: boundary loops have got fans.
struct ClosedSurface {
    std::vector<std::array<int, 3>> triangles;
    std::vector<Eigen::Vector3d> positions;
    HalfEdges half_edges;
};

ClosedSurface close_up(const DecompositionSurface& surface) {
    ClosedSurface closed;
    closed.triangles.assign(surface.triangles.begin(), surface.triangles.end());
    closed.positions.assign(surface.positions.begin(), surface.positions.end());
    for (const std::vector<int>& loop : surface.boundary_loops) {
        const int apex = static_cast<int>(closed.positions.size());
        Eigen::Vector3d centre = Eigen::Vector3d::Zero();
        for (std::size_t i = 0; i < loop.size(); ++i) {
            centre += surface.positions[at(loop[i])] / static_cast<double>(loop.size());
            closed.triangles.push_back({loop[(i + 1) % loop.size()], loop[i], apex});
        }
        closed.positions.push_back(centre);
    }
    closed.half_edges =
        build_half_edges(closed.triangles, static_cast<int>(closed.positions.size()));
    return closed;
}

// The intersection numbers of the basis cycles, up to one sign for all: the inverse of those of
// their duals, which are cup products of the cochains.
IntegerMatrix intersections(const HalfEdges& edges, const std::vector<Cochain>& cochains) {
    const auto rank = static_cast<Eigen::Index>(cochains.size());
    Eigen::MatrixXd products = Eigen::MatrixXd::Zero(rank, rank);
    for (Eigen::Index j = 0; j < rank; ++j) {
        for (Eigen::Index k = 0; k < j; ++k) {
            const Cochain& a = cochains[static_cast<std::size_t>(j)];
            const Cochain& b = cochains[static_cast<std::size_t>(k)];
            long doubled = 0;
            for (std::size_t h = 0; h < edges.from.size(); h += 3) {
                doubled += static_cast<long>(a[h]) * b[h + 1] - static_cast<long>(a[h + 1]) * b[h];
            }
            products(j, k) = 0.5 * static_cast<double>(doubled);
            products(k, j) = -products(j, k);
        }
    }
    const Eigen::MatrixXd inverse = products.inverse().array().round();
    if (!(products * inverse).isIdentity(1e-9)) {
        throw Error(ErrorKind::SelfCheck, "handle-loops",
                    "loops: the intersection form of the surface is not unimodular");
    }
    return inverse.transpose().cast<int>();
}

// As many columns as the matrix has rank, each independent of those before.
IntegerMatrix independent_columns(const IntegerMatrix& matrix) {
    std::vector<Eigen::Index> kept;
    for (Eigen::Index j = 0; j < matrix.cols(); ++j) {
        kept.push_back(j);
        const Eigen::MatrixXd some = matrix(Eigen::all, kept).cast<double>();
        if (some.fullPivLu().rank() < static_cast<Eigen::Index>(kept.size())) {
            kept.pop_back();
        }
    }
    return matrix(Eigen::all, kept);
}

// Places far apart from each other, the first the farthest from vertex 0.
std::vector<int> spread_places(const VertexRings& rings, const std::vector<double>& length) {
    std::vector<double> distance(rings.begin.size() - 1, std::numeric_limits<double>::infinity());
    std::vector<int> places;
    int next = 0;
    while (places.size() <= std::min(kRoots, distance.size() - 1)) {
        using Entry = std::pair<double, int>;
        std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
        distance[at(next)] = 0.0;
        queue.emplace(0.0, next);
        while (!queue.empty()) {
            const auto [d, v] = queue.top();
            queue.pop();
            if (d > distance[at(v)]) {
                continue;
            }
            for (int k = rings.begin[at(v)]; k < rings.begin[at(v) + 1]; ++k) {
                const RingSlot& slot = rings.slots[at(k)];
                const double through = d + length[at(slot.edge)];
                if (through < distance[at(slot.neighbour)]) {
                    distance[at(slot.neighbour)] = through;
                    queue.emplace(through, slot.neighbour);
                }
            }
        }
        places.push_back(next);
        next =
            static_cast<int>(std::max_element(distance.begin(), distance.end()) - distance.begin());
    }
    places.erase(places.begin());
    return places;
}

class LoopFinder {
public:
    LoopFinder(const DecompositionSurface& surface, const Context& context)
        : surface_(surface), context_(context), closed_(close_up(surface)) {
        const int count = static_cast<int>(surface.positions.size());
        rings_ = build_vertex_rings(build_half_edges(surface.triangles, count), count);
        basis_ = dual_basis(closed_.half_edges, static_cast<int>(closed_.positions.size()));
        edges_.rank = basis_.cochains.size();
        for (const MeshEdge& edge : rings_.edges) {
            edges_.length.push_back(
                (surface.positions[at(edge.from)] - surface.positions[at(edge.to)]).norm());
            HomologyClass value;
            for (const Cochain& cochain : basis_.cochains) {
                value.push_back(cochain[at(edge.half_edge)]);
            }
            const bool any = std::any_of(value.begin(), value.end(), [](int x) { return x != 0; });
            edges_.value.push_back(any ? std::move(value) : HomologyClass{});
        }
        places_ = spread_places(rings_, edges_.length);
    }

    LoopSystem find() {
        LoopSystem system;
        const std::size_t genus = edges_.rank / 2;
        if (genus == 0) {
            return system;
        }
        const IntegerMatrix meets = intersections(closed_.half_edges, basis_.cochains);
        const auto linking = linking_matrix(basis_.cycles, closed_.positions,
                                            pushed_out(closed_.triangles, closed_.positions));
        context_.check();
        system.embedded = linking && is_seifert(*linking, meets);
        const auto rank = static_cast<Eigen::Index>(edges_.rank);
        IntegerMatrix inside(rank, 0);   // What annihilates classes contractible inside,
        IntegerMatrix outside(rank, 0);  // and outside.
        if (system.embedded) {
            inside = independent_columns(*linking);
            outside = independent_columns(linking->transpose());
        }
        const std::vector<ClassedLoop> handles = find_kind(inside, {});
        const std::vector<ClassedLoop> tunnels =
            find_kind(outside, system.embedded ? std::vector<ClassedLoop>{} : handles);
        if (system.embedded) {
            check_duality(handles, tunnels, meets);
        }
        for (std::size_t k = 0; k < genus; ++k) {
            system.handle.push_back(handles[k].vertices);
            system.tunnel.push_back(tunnels[k].vertices);
        }
        return system;
    }

private:
    // Pushing out instead of in changes linking by intersections; each half of the classes bounds
    // on one side.
    bool is_seifert(const IntegerMatrix& linking, const IntegerMatrix& meets) const {
        const IntegerMatrix skew = linking - linking.transpose();
        const auto rank = linking.cast<double>().eval().fullPivLu().rank();
        return (skew == meets || skew == -meets) &&
               2 * static_cast<std::size_t>(rank) == edges_.rank;
    }

    // Disjoint loops whose classes are independent of each other and of `others`.
    std::vector<ClassedLoop> find_kind(const IntegerMatrix& annihilator,
                                       const std::vector<ClassedLoop>& others) {
        LoopSearch search(rings_, edges_, annihilator);
        std::vector<char> blocked(surface_.positions.size(), 0);
        block(surface_.boundary_loops, blocked);
        std::vector<HomologyClass> classes;
        classes.reserve(edges_.rank);
        for (const ClassedLoop& other : others) {
            classes.push_back(other.homology);
        }
        std::vector<ClassedLoop> found;
        while (found.size() < edges_.rank / 2) {
            std::map<HomologyClass, bool> known;
            const auto independent = [&](const HomologyClass& homology) {
                const auto [place, fresh] = known.emplace(homology, false);
                if (fresh) {
                    place->second = is_independent(classes, homology);
                }
                return place->second;
            };
            std::optional<ClassedLoop> loop = shortest(search, blocked, independent);
            if (!loop) {
                throw Error(ErrorKind::SelfCheck, "handle-loops",
                            fmt::format("loops: only {} of {} disjoint loops of a kind found: the "
                                        "mesh is too coarse between handles; refine it",
                                        found.size(), edges_.rank / 2));
            }
            block({loop->vertices}, blocked);
            classes.push_back(loop->homology);
            found.push_back(std::move(*loop));
        }
        return found;
    }

    static void block(const std::vector<std::vector<int>>& lines, std::vector<char>& blocked) {
        for (const std::vector<int>& line : lines) {
            for (const int v : line) {
                blocked[at(v)] = 1;
            }
        }
    }

    static bool is_independent(const std::vector<HomologyClass>& classes,
                               const HomologyClass& homology) {
        Eigen::MatrixXd all(static_cast<Eigen::Index>(classes.size() + 1),
                            static_cast<Eigen::Index>(homology.size()));
        for (Eigen::Index i = 0; i < all.rows(); ++i) {
            const HomologyClass& row =
                i + 1 < all.rows() ? classes[static_cast<std::size_t>(i)] : homology;
            for (Eigen::Index k = 0; k < all.cols(); ++k) {
                all(i, k) = row[static_cast<std::size_t>(k)];
            }
        }
        return all.fullPivLu().rank() == all.rows();
    }

    std::optional<ClassedLoop> shortest(LoopSearch& search,
                                        const std::vector<char>& blocked,
                                        const std::function<bool(const HomologyClass&)>& wanted) {
        std::optional<ClassedLoop> best;
        const auto try_at = [&](int root) {
            if (blocked[at(root)] == 0) {
                const double bound = best ? best->length : std::numeric_limits<double>::infinity();
                auto loop = search.loop_through(root, blocked, {wanted, bound}, context_);
                if (loop) {
                    best = std::move(loop);
                }
            }
        };
        for (const int root : places_) {
            try_at(root);
        }
        for (int k = 0; best && k < kRefinements; ++k) {
            const std::vector<int> on = best->vertices;
            const std::size_t step = std::max<std::size_t>(1, on.size() / kRootsOnLoop);
            for (std::size_t i = 0; i < on.size(); i += step) {
                try_at(on[i]);
            }
        }
        return best;
    }

    // Each kind bounds on its side, so a kind's loops can't meet in homology; together they are a
    // basis, so their intersection numbers are unimodular.
    static void check_duality(const std::vector<ClassedLoop>& handles,
                              const std::vector<ClassedLoop>& tunnels,
                              const IntegerMatrix& meets) {
        const auto matrix = [](const std::vector<ClassedLoop>& loops) {
            Eigen::MatrixXd rows(static_cast<Eigen::Index>(loops.size()),
                                 static_cast<Eigen::Index>(loops.front().homology.size()));
            for (Eigen::Index i = 0; i < rows.rows(); ++i) {
                for (Eigen::Index k = 0; k < rows.cols(); ++k) {
                    rows(i, k) =
                        loops[static_cast<std::size_t>(i)].homology[static_cast<std::size_t>(k)];
                }
            }
            return rows;
        };
        const Eigen::MatrixXd h = matrix(handles);
        const Eigen::MatrixXd t = matrix(tunnels);
        const Eigen::MatrixXd form = meets.cast<double>();
        const double unit = std::abs((h * form * t.transpose()).determinant());
        if (std::abs(unit - 1.0) > 1e-6 || !(h * form * h.transpose()).isZero(1e-9) ||
            !(t * form * t.transpose()).isZero(1e-9)) {
            throw Error(ErrorKind::SelfCheck, "handle-loops",
                        "loops: handle and tunnel loops are not dual to each other");
        }
    }

    const DecompositionSurface& surface_;
    const Context& context_;
    ClosedSurface closed_;
    VertexRings rings_;
    DualBasis basis_;
    ClassedEdges edges_;
    std::vector<int> places_;
};

}  // namespace

LoopSystem find_loops(const DecompositionSurface& surface, const Context& context) {
    return LoopFinder(surface, context).find();
}

}  // namespace leafcutter::geometry
