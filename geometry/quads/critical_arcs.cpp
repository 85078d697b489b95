#include "geometry/quads/critical_arcs.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "geometry/error.h"
#include "geometry/harmonic/chart_map.h"

namespace leafcutter::geometry {
namespace {

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

[[noreturn]] void fail(std::size_t cylinder, const char* what) {
    throw Error(ErrorKind::SelfCheck, "critical-arcs",
                fmt::format("quads: an end of cylinder {} {}", cylinder, what));
}

// Both boundary loops of a ring as half-edges, surface to the left: f = 0 first.
std::array<std::vector<int>, 2> boundary_loops(const ChartMap& map, std::size_t cylinder) {
    std::vector<int> next(map.gf.size(), -1);
    for (int h = 0; h < map.edges.size(); ++h) {
        if (map.edges.twin_of(h) < 0) {
            next[at(map.edges.from_of(h))] = h;
        }
    }
    std::array<std::vector<int>, 2> loops;
    for (std::size_t v = 0; v < next.size(); ++v) {
        if (next[v] < 0) {
            continue;
        }
        std::vector<int>& loop = loops[map.gf[v].y() > 0.5 * map.height ? 1 : 0];
        if (!loop.empty()) {
            fail(cylinder, "has several loops");
        }
        for (int w = static_cast<int>(v); next[at(w)] >= 0;) {
            const int h = std::exchange(next[at(w)], -1);
            loop.push_back(h);
            w = map.edges.to_of(h);
        }
    }
    if (loops[0].empty() || loops[1].empty()) {
        fail(cylinder, "has no loop");
    }
    return loops;
}

class Finder {
public:
    explicit Finder(const Foliation& foliation) : foliation_(foliation) {
        network_.ends.resize(foliation.cylinders.size());
        network_.node.assign(foliation.cylinders.size(), {-1, -1});
    }

    ArcNetwork run() {
        for (std::size_t c = 0; c < foliation_.cylinders.size(); ++c) {
            if (foliation_.cylinders[c].shape != ChartShape::Annulus ||
                foliation_.cylinders[c].critical_point.empty()) {
                continue;
            }
            network_.cylinders.push_back(static_cast<int>(c));
            const ChartMap map = reopen_chart(foliation_.cylinders[c]);
            const auto loops = boundary_loops(map, c);
            for (std::size_t end = 0; end < 2; ++end) {
                walk(c, end, map, loops[end]);
            }
        }
        merge_sides();
        set_shares();
        find_nodes();
        return std::move(network_);
    }

private:
    int critical(std::size_t cylinder, int vertex) const {
        return foliation_.cylinders[cylinder].critical_point[at(vertex)];
    }

    bool is_singular(int point) const {
        return point >= 0 && foliation_.critical_points[at(point)].prongs != 2;
    }

    void walk(std::size_t c, std::size_t side, const ChartMap& map, const std::vector<int>& loop) {
        CylinderEnd& end = network_.ends[c][side];
        std::vector<double> steps;
        for (const int h : loop) {
            end.vertices.push_back(map.edges.from_of(h));
            steps.push_back(std::abs(map.difference(h).x()));
        }
        if (side == 1) {  // The surface to the left, g falls there.
            std::reverse(end.vertices.begin(), end.vertices.end());
            std::reverse(steps.begin(), steps.end());
            std::rotate(steps.begin(), steps.begin() + 1, steps.end());
        }
        const auto singular = std::find_if(end.vertices.begin(), end.vertices.end(),
                                           [&](int v) { return is_singular(critical(c, v)); });
        if (singular != end.vertices.end()) {
            const auto turn = singular - end.vertices.begin();
            std::rotate(end.vertices.begin(), singular, end.vertices.end());
            std::rotate(steps.begin(), steps.begin() + turn, steps.end());
        } else if (critical(c, end.vertices.front()) >= 0) {
            fail(c, "lies on the critical graph but has no singular point");
        }
        end.g.push_back(map.gf[at(end.vertices.front())].x());
        for (const double step : steps) {
            end.g.push_back(end.g.back() + step);
        }
        if (singular != end.vertices.end() || critical(c, end.vertices.front()) >= 0) {
            part(c, side);
        }
    }

    // Cuts an end at its singular points.
    void part(std::size_t c, std::size_t side) {
        CylinderEnd& end = network_.ends[c][side];
        for (std::size_t i = 0; i < end.vertices.size(); ++i) {
            if (is_singular(critical(c, end.vertices[i]))) {
                end.uses.push_back({.arc = -1, .forward = true, .first = i});
            }
        }
        for (std::size_t u = 0; u < end.uses.size(); ++u) {
            add_side(c, side, u);
        }
    }

    static std::size_t last_of(const CylinderEnd& end, std::size_t use) {
        return use + 1 < end.uses.size() ? end.uses[use + 1].first : end.vertices.size();
    }

    // What one cylinder knows of an arc.
    struct Side {
        std::vector<int> points;
        std::vector<double> g;
    };

    Side side_of(std::size_t c, const CylinderEnd& end, std::size_t use) const {
        Side side;
        for (std::size_t i = end.uses[use].first; i <= last_of(end, use); ++i) {
            const int point = critical(c, end.vertices[i % end.vertices.size()]);
            if (point >= 0) {
                side.points.push_back(point);
                side.g.push_back(end.g[i]);
            }
        }
        return side;
    }

    void add_side(std::size_t c, std::size_t end_index, std::size_t use) {
        CylinderEnd& end = network_.ends[c][end_index];
        Side side = side_of(c, end, use);
        if (side.points.size() < 3) {
            fail(c, "has an arc without inner points");
        }
        // Sides run the arc's way; the first found says which that is.
        const auto known = arc_of_point_.find(side.points[1]);
        bool forward = true;
        int arc = static_cast<int>(sides_.size());
        if (known == arc_of_point_.end()) {
            sides_.emplace_back();
            for (std::size_t i = 1; i + 1 < side.points.size(); ++i) {
                arc_of_point_.emplace(side.points[i], arc);
            }
        } else {
            arc = known->second;
            forward = sides_[at(arc)].front().points[1] == side.points[1] &&
                      sides_[at(arc)].front().points.front() == side.points.front();
        }
        end.uses[use].arc = arc;
        end.uses[use].forward = forward;
        if (!forward) {
            std::reverse(side.points.begin(), side.points.end());
            std::reverse(side.g.begin(), side.g.end());
        }
        if (!sides_[at(arc)].empty() && side.points != sides_[at(arc)].front().points) {
            fail(c, "meets an arc that runs differently on its other side");
        }
        sides_[at(arc)].push_back(std::move(side));
    }

    void merge_sides() {
        for (const std::vector<Side>& both : sides_) {
            if (both.size() != 2) {
                throw Error(
                    ErrorKind::SelfCheck, "critical-arcs",
                    fmt::format("quads: an arc of the critical graph has {} sides", both.size()));
            }
            CriticalArc arc{.points = both[0].points, .parameter = {}, .length = 0.0};
            arc.parameter.assign(arc.points.size(), 0.0);
            for (const Side& side : both) {
                const double length = side.g.back() - side.g.front();
                arc.length += 0.5 * std::abs(length);
                for (std::size_t i = 0; i < arc.points.size(); ++i) {
                    arc.parameter[i] += 0.5 * (side.g[i] - side.g.front()) / length;
                }
            }
            arc.parameter.back() = 1.0;
            network_.arcs.push_back(std::move(arc));
        }
    }

    // Vertices between two points of an arc have their share by place in space: then the chart's
    // boundary runs along the arc as the arc's parameter does.
    void set_shares() {
        for (const int c : network_.cylinders) {
            for (CylinderEnd& end : network_.ends[at(c)]) {
                end.share.assign(end.vertices.size(), 0.0);
                for (std::size_t u = 0; u < end.uses.size(); ++u) {
                    set_shares(at(c), end, u);
                }
            }
        }
    }

    void set_shares(std::size_t c, CylinderEnd& end, std::size_t use) {
        const CriticalArc& arc = network_.arcs[at(end.uses[use].arc)];
        const bool forward = end.uses[use].forward;
        const auto parameter = [&](std::size_t k) {
            return forward ? arc.parameter[k] : 1.0 - arc.parameter[arc.parameter.size() - 1 - k];
        };
        const auto& positions = foliation_.cylinders[c].mesh.positions;
        const auto place = [&](std::size_t i) -> const Eigen::Vector3d& {
            return positions[at(end.vertices[i % end.vertices.size()])];
        };
        const std::size_t last = last_of(end, use);
        std::size_t point = 0;
        for (std::size_t i = end.uses[use].first; i < last; ++point) {
            std::size_t next = i + 1;
            while (next < last && critical(c, end.vertices[next]) < 0) {
                ++next;
            }
            const double whole = (place(next) - place(i)).norm();
            for (std::size_t k = i; k < next; ++k) {
                const double part =
                    whole > 0.0 ? (place(k) - place(i)).norm() / whole
                                : static_cast<double>(k - i) / static_cast<double>(next - i);
                end.share[k] = parameter(point) + part * (parameter(point + 1) - parameter(point));
            }
            i = next;
        }
    }

    // Arcs that share singular points belong to one node.
    void find_nodes() {
        std::vector<int> root(foliation_.critical_points.size());
        std::iota(root.begin(), root.end(), 0);
        const auto find = [&root](int point) {
            while (root[at(point)] != point) {
                point = root[at(point)] = root[at(root[at(point)])];
            }
            return point;
        };
        for (const CriticalArc& arc : network_.arcs) {
            root[at(find(arc.points.front()))] = find(arc.points.back());
        }
        std::map<int, int> number;
        for (const int c : network_.cylinders) {
            for (std::size_t side = 0; side < 2; ++side) {
                const CylinderEnd& end = network_.ends[at(c)][side];
                if (end.uses.empty()) {
                    continue;
                }
                const int point = find(critical(at(c), end.vertices.front()));
                network_.node[at(c)][side] =
                    number.emplace(point, static_cast<int>(number.size())).first->second;
            }
        }
        network_.nodes = static_cast<int>(number.size());
    }

    const Foliation& foliation_;
    ArcNetwork network_;
    std::map<int, int> arc_of_point_;       // Inner points only.
    std::vector<std::vector<Side>> sides_;  // Per arc.
};

}  // namespace

ArcNetwork find_arcs(const Foliation& foliation) {
    return Finder(foliation).run();
}

Eigen::Vector3d point_on(const CriticalArc& arc, const Foliation& foliation, double parameter) {
    const auto above =
        std::upper_bound(arc.parameter.begin() + 1, arc.parameter.end() - 1, parameter);
    const auto k = static_cast<std::size_t>(above - arc.parameter.begin());
    const double step = arc.parameter[k] - arc.parameter[k - 1];
    const double part = step > 0.0 ? (parameter - arc.parameter[k - 1]) / step : 0.5;
    return (1.0 - part) * foliation.critical_points[at(arc.points[k - 1])].position +
           part * foliation.critical_points[at(arc.points[k])].position;
}

}  // namespace leafcutter::geometry
