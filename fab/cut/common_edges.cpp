// Edges that face each other closely are found on a grid; the corners of one are put on the other,
// and corners that fall together become one node. Then a common edge is one that two contours walk
// between the same two nodes.

#include "fab/cut/common_edges.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <optional>

#include "fab/cut/facing_edges.h"
#include "fab/cut/path_walk.h"

namespace leafcutter::fab {

namespace {

using Eigen::Vector2d;

// Corners this near to each other become one, so that edges that overlap less share nothing.
constexpr double kSameNodeMm = 1.5 * kCommonEdgeMm;
constexpr double kLeastShareMm = kCommonEdgeMm;

// Contours as rings, without the point that closes them.
std::vector<Ring> rings_of(const std::vector<CutPath>& contours) {
    std::vector<Ring> rings;
    for (const CutPath& contour : contours) {
        rings.emplace_back(contour.points.begin(), contour.points.end() - 1);
    }
    return rings;
}

// Corners of contours, those that fall together made one.
class Nodes {
public:
    explicit Nodes(const std::vector<Ring>& rings) {
        std::size_t count = 0;
        for (const Ring& ring : rings) {
            first_.push_back(count);
            count += ring.size();
        }
        parent_.resize(count);
        std::iota(parent_.begin(), parent_.end(), std::size_t{0});
        for (std::size_t c = 0; c < rings.size(); ++c) {
            for (const Vector2d& corner : rings[c]) {
                contours_.push_back({c});
                places_.push_back({corner});
            }
        }
    }

    std::size_t root(const RingSpot& corner) const {
        return root(first_[corner.contour] + corner.index);
    }

    // The corner lies on an edge of `contour`, at `place`.
    void put_on(const RingSpot& corner, std::size_t contour, const Vector2d& place) {
        const std::size_t node = root(corner);
        contours_[node].push_back(contour);
        places_[node].push_back(place);
    }

    // Unless two corners of one contour would become one.
    void unite(const RingSpot& a, const RingSpot& b) {
        const std::size_t one = root(a);
        const std::size_t other = root(b);
        const auto has = [&](std::size_t contour) {
            const std::vector<std::size_t>& list = contours_[one];
            return std::find(list.begin(), list.end(), contour) != list.end();
        };
        if (one == other || std::any_of(contours_[other].begin(), contours_[other].end(), has)) {
            return;
        }
        parent_[other] = one;
        contours_[one].insert(contours_[one].end(), contours_[other].begin(),
                              contours_[other].end());
        places_[one].insert(places_[one].end(), places_[other].begin(), places_[other].end());
    }

    Vector2d place(std::size_t node) const {
        Vector2d sum = Vector2d::Zero();
        for (const Vector2d& place : places_[node]) {
            sum += place;
        }
        return sum / static_cast<double>(places_[node].size());
    }

private:
    std::size_t root(std::size_t node) const {
        while (parent_[node] != node) {
            node = parent_[node];
        }
        return node;
    }

    std::vector<std::size_t> first_;
    std::vector<std::size_t> parent_;
    std::vector<std::vector<std::size_t>> contours_;  // Of each root.
    std::vector<std::vector<Vector2d>> places_;
};

// A corner of another contour on an edge.
struct Inserted {
    double at_mm = 0.0;  // Along the edge.
    RingSpot corner;
};

class EdgeSharing {
public:
    explicit EdgeSharing(const std::vector<CutPath>& contours)
        : contours_(contours), rings_(rings_of(contours)), nodes_(rings_) {}

    SharedContours result() {
        find_nodes();
        walk_contours();
        for (std::size_t c = 0; c < contours_.size(); ++c) {
            emit(c);
        }
        hold_pieces();
        return std::move(result_);
    }

private:
    using EdgeKey = std::pair<std::size_t, std::size_t>;

    void find_nodes() {
        const auto pairs = facing_edges(rings_, {kCommonEdgeMm, kLeastShareMm});
        for (const auto& [a, b] : pairs) {
            for (const RingSpot& one : {a, next(a)}) {
                for (const RingSpot& other : {b, next(b)}) {
                    if ((corner(one) - corner(other)).norm() <= kSameNodeMm) {
                        nodes_.unite(one, other);
                    }
                }
            }
        }
        for (const auto& [a, b] : pairs) {
            insert(a, b);
            insert(b, a);
        }
    }

    RingSpot next(const RingSpot& edge) const {
        return {edge.contour, (edge.index + 1) % rings_[edge.contour].size()};
    }
    const Vector2d& corner(const RingSpot& spot) const { return rings_[spot.contour][spot.index]; }

    // Puts the corners of `other` that lie within `edge` on it.
    void insert(const RingSpot& edge, const RingSpot& other) {
        const Vector2d& from = corner(edge);
        const Vector2d way = corner(next(edge)) - from;
        const double length = way.norm();
        for (const RingSpot& spot : {other, next(other)}) {
            const double at = way.dot(corner(spot) - from) / length;
            const Vector2d foot = from + at / length * way;
            const std::size_t node = nodes_.root(spot);
            if (at <= 0.0 || at >= length || (corner(spot) - foot).norm() > kSameNodeMm ||
                node == nodes_.root(edge) || node == nodes_.root(next(edge))) {
                continue;
            }
            std::vector<Inserted>& list = inserted_[{edge.contour, edge.index}];
            const bool known = std::any_of(list.begin(), list.end(), [&](const Inserted& each) {
                return nodes_.root(each.corner) == node;
            });
            if (!known) {
                list.push_back({at, spot});
                nodes_.put_on(spot, edge.contour, foot);
            }
        }
    }

    // Contours as nodes, and which contours walk each edge between two nodes.
    void walk_contours() {
        for (std::size_t c = 0; c < rings_.size(); ++c) {
            std::vector<std::size_t> walk;
            const auto add = [&](std::size_t node) {
                if (walk.empty() || walk.back() != node) {
                    walk.push_back(node);
                }
            };
            for (std::size_t i = 0; i < rings_[c].size(); ++i) {
                add(nodes_.root({c, i}));
                const auto found = inserted_.find({c, i});
                if (found == inserted_.end()) {
                    continue;
                }
                std::sort(found->second.begin(), found->second.end(),
                          [](const Inserted& a, const Inserted& b) { return a.at_mm < b.at_mm; });
                for (const Inserted& each : found->second) {
                    add(nodes_.root(each.corner));
                }
            }
            while (walk.size() > 1 && walk.front() == walk.back()) {
                walk.pop_back();
            }
            for (std::size_t i = 0; i < walk.size(); ++i) {
                walkers_[key_of(walk, i)].push_back(c);
            }
            walks_.push_back(std::move(walk));
        }
    }

    static EdgeKey key_of(const std::vector<std::size_t>& walk, std::size_t edge) {
        const std::size_t a = walk[edge];
        const std::size_t b = walk[(edge + 1) % walk.size()];
        return {std::min(a, b), std::max(a, b)};
    }

    // Who else walks the edge; the contour itself if nobody does.
    std::size_t partner(std::size_t contour, std::size_t edge) const {
        for (const std::size_t other : walkers_.at(key_of(walks_[contour], edge))) {
            if (other != contour) {
                return other;
            }
        }
        return contour;
    }

    // The paths of a contour: runs of edges with one partner. A common run is emitted by the lower
    // of its two contours.
    void emit(std::size_t contour) {
        const std::vector<std::size_t>& walk = walks_[contour];
        std::vector<std::size_t> partners;
        for (std::size_t i = 0; i < walk.size(); ++i) {
            partners.push_back(partner(contour, i));
        }
        std::size_t begin = 0;
        while (begin < walk.size() &&
               partners[begin] == partners[(begin + walk.size() - 1) % walk.size()]) {
            ++begin;
        }
        if (begin == walk.size()) {  // Alone.
            result_.paths.push_back(contours_[contour]);
            result_.owners.emplace_back(contour, contour);
            return;
        }
        for (std::size_t done = 0; done < walk.size();) {
            const std::size_t other = partners[(begin + done) % walk.size()];
            CutPath path;
            path.operation = Operation::Cut;
            path.piece = contours_[contour].piece;
            path.points.push_back(nodes_.place(walk[(begin + done) % walk.size()]));
            while (done < walk.size() && partners[(begin + done) % walk.size()] == other) {
                ++done;
                path.points.push_back(nodes_.place(walk[(begin + done) % walk.size()]));
            }
            if (other < contour) {
                continue;
            }
            if (other != contour) {
                path.other_piece = contours_[other].piece;
                result_.common_mm += length_mm(path.points);
            }
            result_.paths.push_back(std::move(path));
            result_.owners.emplace_back(contour, other);
        }
    }

    // Common edges before what holds a piece to the last: the rest of its contour, or, of a piece
    // with none, an edge towards a piece that is held longer.
    void hold_pieces() {
        std::vector<std::vector<std::size_t>> paths(contours_.size());
        std::vector<std::optional<int>> distance(contours_.size());
        std::vector<std::size_t> reached;
        for (std::size_t i = 0; i < result_.paths.size(); ++i) {
            const auto& [one, other] = result_.owners[i];
            paths[one].push_back(i);
            if (one != other) {
                paths[other].push_back(i);
            } else if (!distance[one]) {
                distance[one] = 0;
                reached.push_back(one);
            }
        }
        for (std::size_t k = 0; k < reached.size(); ++k) {
            const std::size_t piece = reached[k];
            for (const std::size_t path : paths[piece]) {
                const auto& [one, other] = result_.owners[path];
                const std::size_t neighbour = one == piece ? other : one;
                if (!distance[neighbour]) {
                    distance[neighbour] = *distance[piece] + 1;
                    reached.push_back(neighbour);
                    for (const std::size_t earlier : paths[neighbour]) {
                        if (earlier != path) {
                            result_.before.emplace_back(earlier, path);
                        }
                    }
                }
            }
            for (const std::size_t path : paths[piece]) {
                for (const std::size_t last : paths[piece]) {
                    if (is_common(path) && !is_common(last)) {
                        result_.before.emplace_back(path, last);
                    }
                }
            }
        }
    }

    bool is_common(std::size_t path) const {
        return result_.owners[path].first != result_.owners[path].second;
    }

    const std::vector<CutPath>& contours_;
    std::vector<Ring> rings_;
    Nodes nodes_;
    std::map<std::pair<std::size_t, std::size_t>, std::vector<Inserted>> inserted_;
    std::vector<std::vector<std::size_t>> walks_;
    std::map<EdgeKey, std::vector<std::size_t>> walkers_;
    SharedContours result_;
};

}  // namespace

SharedContours share_edges(const std::vector<CutPath>& contours) {
    return EdgeSharing(contours).result();
}

}  // namespace leafcutter::fab
