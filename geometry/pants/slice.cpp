#include "geometry/pants/slice.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <iterator>
#include <string>
#include <unordered_map>
#include <utility>

#include <fmt/format.h>

namespace leafcutter::geometry {
namespace {

// Cuts stay this part of an edge away from its ends: no slivers, and vertices exactly on a node
// need no care.
constexpr double kFromEnd = 0.05;

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

// Names of a point that a piece may hold several copies of: both sides of a cut can belong to it.
enum class PointKind : std::uint64_t { EdgeCut, Centre };

std::uint64_t name_of(PointKind kind, int id, int end, int side) {
    return (static_cast<std::uint64_t>(id) << 4U) | (static_cast<std::uint64_t>(kind) << 2U) |
           (static_cast<std::uint64_t>(end) << 1U) | static_cast<std::uint64_t>(side);
}

struct CurvePoint {
    int number = 0;  // As CurveJoiner counts.
    Eigen::Vector3d position;
};

// A piece under construction.
struct Builder {
    Piece piece;
    std::vector<char> at_end;  // Per vertex: 0 inside, 1 at t = 0, 2 at t = weight.
    std::unordered_map<std::uint64_t, int> index;

    int add(const Eigen::Vector3d& position, int source, char end) {
        piece.mesh.positions.push_back(position);
        piece.source_vertex.push_back(source);
        piece.critical_point.push_back(-1);
        at_end.push_back(end);
        return static_cast<int>(piece.mesh.positions.size()) - 1;
    }

    // A point of a cut, by name; `critical` is its place on the critical graph.
    int point(std::uint64_t name, const CurvePoint& critical, char end) {
        const auto [found, fresh] =
            index.emplace(name, static_cast<int>(piece.mesh.positions.size()));
        if (fresh) {
            add(critical.position, -1, end);
            piece.critical_point.back() = critical.number;
        }
        return found->second;
    }
};

// Joins segments to curves. Points are named by numbers; those that more than two segments meet in
// are the curves' ends.
class CurveJoiner {
public:
    int point(std::uint64_t name, const Eigen::Vector3d& position) {
        const auto [found, fresh] = index_.emplace(name, static_cast<int>(points_.size()));
        if (fresh) {
            points_.push_back(position);
            neighbours_.emplace_back();
        }
        return found->second;
    }

    void join(int a, int b) {
        neighbours_[at(a)].push_back(b);
        neighbours_[at(b)].push_back(a);
    }

    const std::vector<Eigen::Vector3d>& points() const { return points_; }

    std::vector<std::vector<Eigen::Vector3d>> curves() {
        std::transform(neighbours_.begin(), neighbours_.end(), std::back_inserter(is_end_),
                       [](const std::vector<int>& list) { return list.size() != 2; });
        std::vector<std::vector<Eigen::Vector3d>> curves;
        for (const bool from_ends : {true, false}) {
            for (int p = 0; p < static_cast<int>(points_.size()); ++p) {
                while (!neighbours_[at(p)].empty() && (!from_ends || is_end_[at(p)])) {
                    curves.push_back(follow(p));
                }
            }
        }
        return curves;
    }

private:
    void part(int a, int b) {
        const auto drop = [](std::vector<int>& list, int value) {
            list.erase(std::find(list.begin(), list.end(), value));
        };
        drop(neighbours_[at(a)], b);
        drop(neighbours_[at(b)], a);
    }

    std::vector<Eigen::Vector3d> follow(int start) {
        std::vector<Eigen::Vector3d> curve{points_[at(start)]};
        int p = start;
        do {
            const int next = neighbours_[at(p)].back();
            part(p, next);
            p = next;
            curve.push_back(points_[at(p)]);
        } while (p != start && !is_end_[at(p)]);
        return curve;
    }

    std::unordered_map<std::uint64_t, int> index_;
    std::vector<Eigen::Vector3d> points_;
    std::vector<std::vector<int>> neighbours_;
    std::vector<bool> is_end_;  // Per point: a curve ends here.
};

class Slicer {
public:
    Slicer(const TriangleMesh& mesh, const VertexRings& rings, const GraphMap& map)
        : mesh_(mesh),
          rings_(rings),
          map_(map),
          builders_(map.graph.edges.size()),
          local_(mesh.positions.size(), -1) {}

    Sliced run() {
        for (int t = 0; t < static_cast<int>(mesh_.triangles.size()); ++t) {
            cut(t);
        }
        for (Builder& builder : builders_) {
            find_loops(builder);
            sliced_.pieces.push_back(std::move(builder.piece));
        }
        sliced_.critical_arcs = curves_.curves();
        for (const Eigen::Vector3d& position : curves_.points()) {
            sliced_.critical_points.push_back({.position = position, .prongs = 2});
        }
        for (const int meeting : meetings_) {
            sliced_.critical_points[at(meeting)].prongs = 3;
        }
        return std::move(sliced_);
    }

private:
    // Mesh edge along side k of triangle t, and whether it runs that way.
    std::pair<int, bool> side_of(int t, int k) const {
        const int edge = rings_.edge_of_half_edge[at(3 * t + k)];
        return {edge, rings_.edges[at(edge)].from == mesh_.triangles[at(t)][at(k)]};
    }

    // First dart of the word of side k, read from corner `from_start ? k : k + 1`.
    Dart first_dart(int t, int k, bool from_start) const {
        const auto [edge, forward] = side_of(t, k);
        const Word& word = map_.words[at(edge)];
        return forward == from_start ? word.front() : reversed(word.back());
    }

    bool is_cut(int t, int k) const { return !map_.words[at(side_of(t, k).first)].empty(); }

    void cut(int t) {
        int cuts = 0;
        for (int k = 0; k < 3; ++k) {
            cuts += is_cut(t, k) ? 1 : 0;
        }
        if (cuts == 0) {
            keep_whole(t);
        } else if (cuts == 2) {
            cut_off_corner(t);
        } else if (cuts == 3) {
            cut_in_three(t);
        } else {
            throw Error(ErrorKind::SelfCheck, "broken-cylinder",
                        "slicing: triangle " + std::to_string(t) + " has one cut side");
        }
    }

    Builder& builder_of(int vertex) { return builders_[at(map_.graph_edge[at(vertex)])]; }

    int corner(int t, int k) {
        const int v = mesh_.triangles[at(t)][at(k)];
        if (local_[at(v)] < 0) {
            char end = 0;
            if (map_.fixed[at(v)] != 0) {
                end = map_.t[at(v)] > 0.5 * map_.weight(map_.graph_edge[at(v)]) ? 2 : 1;
            }
            local_[at(v)] = builder_of(v).add(mesh_.positions[at(v)], v, end);
        }
        return local_[at(v)];
    }

    double distance_to_node(int vertex, Dart dart) const { return map_.remaining(vertex, dart); }

    Eigen::Vector3d cut_position(int edge) const {
        const MeshEdge& ends = rings_.edges[at(edge)];
        const Word& word = map_.words[at(edge)];
        const double a = distance_to_node(ends.from, word.front());
        const double b = distance_to_node(ends.to, reversed(word.back()));
        const double ratio = std::clamp(a + b > 0.0 ? a / (a + b) : 0.5, kFromEnd, 1.0 - kFromEnd);
        return (1.0 - ratio) * mesh_.positions[at(ends.from)] +
               ratio * mesh_.positions[at(ends.to)];
    }

    CurvePoint curve_point(int t, int k) {
        const int edge = side_of(t, k).first;
        const Eigen::Vector3d position = cut_position(edge);
        return {.number = curves_.point(name_of(PointKind::EdgeCut, edge, 0, 0), position),
                .position = position};
    }

    // The cut point on side k, in the piece of the corner it is seen from.
    int cut_point(int t, int k, bool from_start) {
        const auto [edge, forward] = side_of(t, k);
        const MeshEdge& ends = rings_.edges[at(edge)];
        const bool from_edge_start = forward == from_start;
        const Dart dart = first_dart(t, k, from_start);
        const int side = runs_forward(dart) ? 1 : 0;
        const int seen_from = from_edge_start ? ends.from : ends.to;
        return builder_of(seen_from).point(
            name_of(PointKind::EdgeCut, edge, from_edge_start ? 0 : 1, side), curve_point(t, k),
            static_cast<char>(1 + side));
    }

    void keep_whole(int t) {
        const int v = mesh_.triangles[at(t)][0];
        builder_of(v).piece.mesh.triangles.push_back({corner(t, 0), corner(t, 1), corner(t, 2)});
    }

    void cut_off_corner(int t) {
        int whole = 0;
        while (is_cut(t, whole)) {
            ++whole;
        }
        // Side `whole` runs from b to c, and a is the corner cut off.
        const int b = whole;
        const int c = (whole + 1) % 3;
        const int a = (whole + 2) % 3;
        auto& tip = builder_of(mesh_.triangles[at(t)][at(a)]).piece.mesh.triangles;
        const std::array<int, 3> small{corner(t, a), cut_point(t, a, true), cut_point(t, c, false)};
        tip.push_back(small);
        curves_.join(curve_point(t, a).number, curve_point(t, c).number);
        auto& rest = builder_of(mesh_.triangles[at(t)][at(b)]).piece;
        const int p = cut_point(t, a, false);
        const int q = cut_point(t, c, true);
        const int vb = corner(t, b);
        const int vc = corner(t, c);
        const auto length = [&](int i, int j) {
            return (rest.mesh.positions[at(i)] - rest.mesh.positions[at(j)]).norm();
        };
        if (length(p, vc) <= length(q, vb)) {
            rest.mesh.triangles.push_back({p, vb, vc});
            rest.mesh.triangles.push_back({p, vc, q});
        } else {
            rest.mesh.triangles.push_back({p, vb, q});
            rest.mesh.triangles.push_back({vb, vc, q});
        }
    }

    void cut_in_three(int t) {
        std::array<double, 3> share{};
        double sum = 0.0;
        for (int k = 0; k < 3; ++k) {
            const int v = mesh_.triangles[at(t)][at(k)];
            const double d = distance_to_node(v, first_dart(t, k, true));
            share[at(k)] = 1.0 / std::max(d, 1e-12);
            sum += share[at(k)];
        }
        double clamped = 0.0;
        for (double& s : share) {
            s = std::clamp(s / sum, kFromEnd, 0.9);
            clamped += s;
        }
        Eigen::Vector3d centre = Eigen::Vector3d::Zero();
        for (int k = 0; k < 3; ++k) {
            centre += share[at(k)] / clamped * mesh_.positions[at(mesh_.triangles[at(t)][at(k)])];
        }
        sliced_.three_prongs.push_back(centre);
        const int meeting = curves_.point(name_of(PointKind::Centre, t, 0, 0), centre);
        meetings_.push_back(meeting);
        for (int k = 0; k < 3; ++k) {
            curves_.join(meeting, curve_point(t, k).number);
        }
        for (int k = 0; k < 3; ++k) {
            const int v = mesh_.triangles[at(t)][at(k)];
            const int side = runs_forward(first_dart(t, k, true)) ? 1 : 0;
            Builder& builder = builder_of(v);
            const int m =
                builder.point(name_of(PointKind::Centre, 3 * t + k, 0, side),
                              {.number = meeting, .position = centre}, static_cast<char>(1 + side));
            const int tip = corner(t, k);
            const int p = cut_point(t, k, true);
            const int q = cut_point(t, (k + 2) % 3, false);
            builder.piece.mesh.triangles.push_back({tip, p, m});
            builder.piece.mesh.triangles.push_back({tip, m, q});
        }
    }

    [[noreturn]] void broken(const Builder& builder, const std::string& what) const {
        throw Error(ErrorKind::SelfCheck, "broken-cylinder",
                    fmt::format("slicing: cylinder {} {}", &builder - builders_.data(), what));
    }

    void find_loops(Builder& builder) {
        const auto& mesh = builder.piece.mesh;
        const int count = static_cast<int>(mesh.positions.size());
        if (mesh.triangles.empty()) {
            throw Error(ErrorKind::SelfCheck, "collapsed-edge",
                        fmt::format("slicing: nothing of the surface is mapped to cylinder {}: its "
                                    "edge has collapsed",
                                    &builder - builders_.data()));
        }
        const HalfEdges half_edges = build_half_edges(mesh.triangles, count);
        std::vector<int> next(at(count), -1);
        int boundary = 0;
        for (int h = 0; h < half_edges.size(); ++h) {
            if (half_edges.twin_of(h) < 0) {
                next[at(half_edges.from_of(h))] = half_edges.to_of(h);
                ++boundary;
            }
        }
        const int interior = (half_edges.size() - boundary) / 2;
        if (count - interior - boundary + half_edges.size() / 3 != 0) {
            broken(builder, fmt::format("is no annulus: Euler characteristic {}",
                                        count - interior - boundary + half_edges.size() / 3));
        }
        int loops = 0;
        for (int v = 0; v < count; ++v) {
            if (next[at(v)] < 0) {
                continue;
            }
            const int end = static_cast<unsigned char>(builder.at_end[at(v)]);
            if (end == 0 || !builder.piece.loops[at(end - 1)].empty()) {
                broken(builder, "has no single loop at each end");
            }
            for (int w = v; next[at(w)] >= 0;) {
                builder.piece.loops[at(end - 1)].push_back(w);
                w = std::exchange(next[at(w)], -1);
            }
            ++loops;
        }
        if (loops != 2) {
            broken(builder, fmt::format("has {} boundary loops instead of 2", loops));
        }
    }

    const TriangleMesh& mesh_;
    const VertexRings& rings_;
    const GraphMap& map_;
    std::vector<Builder> builders_;
    std::vector<int> local_;  // Per vertex: its number in its piece.
    CurveJoiner curves_;
    std::vector<int> meetings_;  // Points of `curves_` where three legs meet.
    Sliced sliced_;
};

}  // namespace

Sliced slice_surface(const TriangleMesh& mesh, const VertexRings& rings, const GraphMap& map) {
    return Slicer(mesh, rings, map).run();
}

}  // namespace leafcutter::geometry
