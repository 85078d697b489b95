#include "fab/cut/planar_faces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "geometry/plane.h"

namespace leafcutter::fab {

using geometry::signed_area;
using geometry::turn_of;

namespace {

using Eigen::Vector2d;
using Spot = std::array<std::int64_t, 2>;
using EdgeKey = std::pair<std::size_t, std::size_t>;

constexpr double kStraightSine = 0.02;
constexpr std::size_t kBridge = std::numeric_limits<std::size_t>::max();

class Drawing {
public:
    Drawing(std::span<const Segment> lines, double bridge_mm) : bridge_mm_(bridge_mm) {
        for (std::size_t i = 0; i < lines.size(); ++i) {
            add(node_at(lines[i].from), node_at(lines[i].to), i);
        }
    }

    std::vector<PlanarFace> faces() {
        bridge();
        prune();
        sort_round();
        std::vector<PlanarFace> faces;
        for (std::size_t from = 0; from < places_.size(); ++from) {
            for (const std::size_t to : next_[from]) {
                if (walked_.count({from, to}) == 0) {
                    walk(from, to, faces);
                }
            }
        }
        return faces;
    }

private:
    static EdgeKey key(std::size_t a, std::size_t b) { return {std::min(a, b), std::max(a, b)}; }

    std::size_t node_at(const Vector2d& point) {
        const Spot spot{std::llround(point.x() * 1e3), std::llround(point.y() * 1e3)};
        const auto [found, is_new] = nodes_.emplace(spot, places_.size());
        if (is_new) {
            places_.push_back(point);
            next_.emplace_back();
        }
        return found->second;
    }

    void add(std::size_t a, std::size_t b, std::size_t line) {
        if (a == b) {
            return;
        }
        std::vector<std::size_t>& drawn = edges_[key(a, b)];
        if (drawn.empty()) {
            next_[a].push_back(b);
            next_[b].push_back(a);
        }
        drawn.push_back(line);
    }

    void bridge() {
        std::vector<std::size_t> ends;
        for (std::size_t i = 0; i < next_.size(); ++i) {
            if (next_[i].size() == 1) {
                ends.push_back(i);
            }
        }
        std::vector<std::pair<double, EdgeKey>> gaps;
        for (std::size_t i = 0; i < ends.size(); ++i) {
            for (std::size_t k = i + 1; k < ends.size(); ++k) {
                const std::size_t a = ends[i];
                const std::size_t b = ends[k];
                if (bridges({places_[next_[a][0]], places_[a]}, {places_[b], places_[next_[b][0]]},
                            bridge_mm_)) {
                    gaps.push_back({(places_[a] - places_[b]).norm(), {a, b}});
                }
            }
        }
        std::sort(gaps.begin(), gaps.end());
        for (const auto& [gap, pair] : gaps) {
            if (next_[pair.first].size() == 1 && next_[pair.second].size() == 1) {
                add(pair.first, pair.second, kBridge);
            }
        }
    }

    void prune() {
        for (std::size_t i = 0; i < next_.size(); ++i) {
            std::size_t end = i;
            while (next_[end].size() == 1) {
                const std::size_t other = next_[end][0];
                next_[end].clear();
                std::erase(next_[other], end);
                end = other;
            }
        }
    }

    void sort_round() {
        for (std::size_t i = 0; i < next_.size(); ++i) {
            const auto angle = [&](std::size_t to) {
                const Vector2d way = places_[to] - places_[i];
                return std::atan2(way.y(), way.x());
            };
            std::sort(next_[i].begin(), next_[i].end(),
                      [&](std::size_t a, std::size_t b) { return angle(a) < angle(b); });
        }
    }

    // Round the face on the left: at every node the sharpest turn to the left.
    void walk(std::size_t from, std::size_t to, std::vector<PlanarFace>& faces) {
        PlanarFace face;
        std::size_t times = std::numeric_limits<std::size_t>::max();
        while (walked_.insert({from, to}).second) {
            face.ring.push_back(places_[from]);
            const std::vector<std::size_t>& drawn = edges_.at(key(from, to));
            if (drawn.front() != kBridge) {
                times = std::min(times, drawn.size());
                face.lines.insert(face.lines.end(), drawn.begin(), drawn.end());
            }
            const std::vector<std::size_t>& round = next_[to];
            const auto back = std::find(round.begin(), round.end(), from);
            const std::size_t next = back == round.begin() ? round.back() : *(back - 1);
            from = to;
            to = next;
        }
        if (signed_area(face.ring) > 0.0) {
            face.times = static_cast<int>(times);
            faces.push_back(std::move(face));
        }
    }

    double bridge_mm_;
    std::map<Spot, std::size_t> nodes_;
    std::vector<Vector2d> places_;
    std::vector<std::vector<std::size_t>> next_;
    std::map<EdgeKey, std::vector<std::size_t>> edges_;  // The lines drawn there.
    std::set<EdgeKey> walked_;                           // From, to.
};

}  // namespace

std::vector<PlanarFace> faces_of(std::span<const Segment> lines, double bridge_mm) {
    return Drawing(lines, bridge_mm).faces();
}

bool bridges(const Segment& before, const Segment& after, double most_mm) {
    const Vector2d gap = after.from - before.to;
    const double length = gap.norm();
    if (length <= 0.0 || length > most_mm) {
        return false;
    }
    const Vector2d in = (before.to - before.from).stableNormalized();
    const Vector2d out = (after.to - after.from).stableNormalized();
    // Programs round to a thousandth, which turns short ways.
    const double sine = kStraightSine + 2e-3 / length;
    return in.dot(gap) > 0.0 && out.dot(gap) > 0.0 && std::abs(turn_of(in, gap)) < sine * length &&
           std::abs(turn_of(out, gap)) < sine * length;
}

}  // namespace leafcutter::fab
