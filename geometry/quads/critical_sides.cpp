#include "geometry/quads/critical_sides.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "geometry/disjoint_sets.h"
#include "geometry/error.h"
#include "geometry/harmonic/chart_map.h"

namespace leafcutter::geometry {
namespace {

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

[[noreturn]] void fail(const std::string& what) {
    throw Error(ErrorKind::SelfCheck, "critical-sides",
                fmt::format("quads: {}; use grid.junctions \"independent\"", what));
}

// The boundary of a rectangle, surface to the left, from its corner (0, 0).
std::vector<int> border_of(const ChartMap& map, int cylinder) {
    std::vector<int> next(map.gf.size(), -1);
    int start = -1;
    std::size_t count = 0;
    for (int h = 0; h < map.edges.size(); ++h) {
        if (map.edges.twin_of(h) < 0) {
            const int v = map.edges.from_of(h);
            next[at(v)] = map.edges.to_of(h);
            ++count;
            if (map.gf[at(v)].x() <= 0.0 && map.gf[at(v)].y() <= 0.0) {
                start = v;
            }
        }
    }
    if (start < 0) {
        fail(fmt::format("rectangle {} has no corner", cylinder));
    }
    std::vector<int> border{start};
    for (int v = next[at(start)]; v >= 0 && v != start && border.size() <= count; v = next[at(v)]) {
        border.push_back(v);
    }
    if (border.size() != count) {
        fail(fmt::format("rectangle {} has more than one boundary", cylinder));
    }
    return border;
}

class Finder {
public:
    explicit Finder(const Foliation& foliation) : foliation_(foliation) {
        network_.flanks.resize(foliation.cylinders.size());
        network_.ends.resize(foliation.cylinders.size());
        network_.band_at.resize(foliation.cylinders.size());
        network_.zero_of_point.assign(foliation.critical_points.size(), -1);
    }

    SideNetwork run() {
        for (std::size_t c = 0; c < foliation_.cylinders.size(); ++c) {
            const Cylinder& cylinder = foliation_.cylinders[c];
            if (cylinder.shape == ChartShape::Rectangle && !cylinder.critical_point.empty()) {
                network_.cylinders.push_back(static_cast<int>(c));
                cut_border(static_cast<int>(c));
            }
        }
        find_zeros();
        merge_sides();
        for (const int c : network_.cylinders) {
            for (Flank& flank : network_.flanks[at(c)]) {
                set_levels(c, flank);
            }
        }
        find_bands();
        return std::move(network_);
    }

private:
    int critical(int cylinder, int vertex) const {
        return foliation_.cylinders[at(cylinder)].critical_point[at(vertex)];
    }
    bool is_zero(int point) const {
        return point >= 0 && foliation_.critical_points[at(point)].prongs != 2;
    }

    void cut_border(int c) {
        const ChartMap map = reopen_chart(foliation_.cylinders[at(c)]);
        const std::vector<int> border = border_of(map, c);
        const auto is_corner = [&](int v, bool right, bool top) {
            const Eigen::Vector2d& gf = map.gf[at(v)];
            return (right ? gf.x() >= map.width : gf.x() <= 0.0) &&
                   (top ? gf.y() >= map.height : gf.y() <= 0.0);
        };
        std::array<std::ptrdiff_t, 3> corner{};
        const std::array<std::pair<bool, bool>, 3> which{
            {{true, false}, {true, true}, {false, true}}};
        for (std::size_t k = 0; k < 3; ++k) {
            const auto found = std::find_if(border.begin(), border.end(), [&](int v) {
                return is_corner(v, which[k].first, which[k].second);
            });
            corner[k] = found - border.begin();
            if (found == border.end() || (k > 0 && corner[k] <= corner[k - 1])) {
                fail(fmt::format("rectangle {} has no four corners", c));
            }
        }
        const auto stretch = [&](std::ptrdiff_t from, std::ptrdiff_t to) {
            return std::vector<int>(border.begin() + from, border.begin() + to + 1);
        };
        network_.ends[at(c)][0] = stretch(0, corner[0]);
        network_.ends[at(c)][1] = stretch(corner[1], corner[2]);
        std::reverse(network_.ends[at(c)][1].begin(), network_.ends[at(c)][1].end());
        std::vector<int> left(border.begin() + corner[2], border.end());
        left.push_back(border.front());
        std::reverse(left.begin(), left.end());
        add_flank(c, SideNetwork::Left, std::move(left), map);
        add_flank(c, SideNetwork::Right, stretch(corner[0], corner[1]), map);
    }

    // What one rectangle knows of a side.
    struct View {
        int cylinder = 0;
        std::size_t flank = 0;
        std::vector<int> points;
        std::vector<double> f;
    };

    // Parts a flank at its zeros.
    void add_flank(int c, std::size_t which, std::vector<int> vertices, const ChartMap& map) {
        Flank& flank = network_.flanks[at(c)][which];
        flank.vertices = std::move(vertices);
        const std::size_t last = flank.vertices.size() - 1;
        View view{c, which, {}, {}};
        for (std::size_t i = 0; i <= last; ++i) {
            const int point = critical(c, flank.vertices[i]);
            if (point < 0) {
                if (i == 0 || i == last) {
                    fail(fmt::format("rectangle {} has a corner that no neighbour knows", c));
                }
                continue;
            }
            const double f = map.gf[at(flank.vertices[i])].y();
            view.points.push_back(point);
            view.f.push_back(f);
            if (i == 0) {
                flank.uses.push_back({-1, 0});
            } else if (i == last || is_zero(point)) {
                add_view(flank.uses.back(), std::exchange(view, {c, which, {point}, {f}}));
                if (i < last) {
                    flank.uses.push_back({-1, i});
                }
            }
        }
        if (flank.uses.size() < 2) {
            fail(fmt::format("rectangle {} has a flank without zero", c));
        }
    }

    void add_view(SideUse& use, View view) {
        const std::pair<int, int> key{view.points[0], view.points[1]};
        const auto [known, fresh] = side_of_.emplace(key, static_cast<int>(views_.size()));
        if (fresh) {
            views_.emplace_back();
        }
        use.side = known->second;
        views_[at(use.side)].push_back(std::move(view));
    }

    // A zero's level is the mean of what all rectangles around it say.
    void find_zeros() {
        std::map<int, std::pair<double, int>> sums;
        for (const auto& views : views_) {
            for (const View& view : views) {
                for (const std::size_t i : {std::size_t{0}, view.points.size() - 1}) {
                    if (is_zero(view.points[i])) {
                        auto& [sum, count] = sums[view.points[i]];
                        sum += view.f[i];
                        ++count;
                    }
                }
            }
        }
        for (const auto& [point, sum] : sums) {
            network_.zeros.push_back({point, sum.first / sum.second});
        }
        std::stable_sort(network_.zeros.begin(), network_.zeros.end(),
                         [](const FormZeroPlace& a, const FormZeroPlace& b) { return a.f < b.f; });
        for (std::size_t z = 0; z < network_.zeros.size(); ++z) {
            network_.zero_of_point[at(network_.zeros[z].point)] = static_cast<int>(z);
        }
    }

    double stop_level(int point, double at_loop) const {
        const int zero = network_.zero_of(point);
        return zero < 0 ? at_loop : network_.zeros[at(zero)].f;
    }

    void merge_sides() {
        for (const std::vector<View>& views : views_) {
            CriticalSide side;
            side.points = views.front().points;
            const double low = stop_level(side.points.front(), views.front().f.front());
            const double high = stop_level(side.points.back(), views.front().f.back());
            if (!(low < high)) {
                fail("f does not rise from one zero to the next above it");
            }
            side.f.assign(side.points.size(), 0.0);
            for (const View& view : views) {
                int& cylinder = view.flank == SideNetwork::Right ? side.left : side.right;
                if (cylinder >= 0 || view.points != side.points) {
                    fail(fmt::format("rectangle {} meets a side that runs differently beyond",
                                     view.cylinder));
                }
                cylinder = view.cylinder;
                for (std::size_t i = 0; i < side.f.size(); ++i) {
                    const double part =
                        (view.f[i] - view.f.front()) / (view.f.back() - view.f.front());
                    side.f[i] += (low + part * (high - low)) / static_cast<double>(views.size());
                }
            }
            side.f.back() = high;
            network_.sides.push_back(std::move(side));
        }
    }

    // Vertices between two points of a side have their share by place in space, so that the
    // chart's border runs along the side as f does there.
    void set_levels(int c, Flank& flank) {
        flank.f.assign(flank.vertices.size(), 0.0);
        const auto& positions = foliation_.cylinders[at(c)].mesh.positions;
        const auto place = [&](std::size_t i) -> const Eigen::Vector3d& {
            return positions[at(flank.vertices[i])];
        };
        for (std::size_t u = 0; u < flank.uses.size(); ++u) {
            const CriticalSide& side = network_.sides[at(flank.uses[u].side)];
            std::size_t i = flank.uses[u].first;
            flank.f[i] = side.f.front();
            for (std::size_t k = 1; k < side.points.size(); ++k) {
                std::size_t next = i + 1;
                while (critical(c, flank.vertices[next]) < 0) {
                    ++next;
                }
                const double whole = (place(next) - place(i)).norm();
                for (std::size_t v = i + 1; v <= next; ++v) {
                    const double part =
                        whole > 0.0 ? (place(v) - place(i)).norm() / whole
                                    : static_cast<double>(v - i) / static_cast<double>(next - i);
                    flank.f[v] = side.f[k - 1] + part * (side.f[k] - side.f[k - 1]);
                }
                i = next;
            }
        }
    }

    // Bands are classes of pairs of a cylinder and an interval between the levels of neighbouring
    // zeros: those that meet along a side, and those above each other unless the zero between them
    // lies on their leaves.
    void find_bands() {
        const std::size_t intervals = network_.zeros.size() + 1;
        const auto item = [&](int c, std::size_t k) {
            return static_cast<std::uint32_t>(at(c) * intervals + k);
        };
        DisjointSets sets(network_.flanks.size() * intervals);
        for (const CriticalSide& side : network_.sides) {
            if (side.left < 0 || side.right < 0) {
                continue;
            }
            const int low = network_.zero_of(side.points.front());
            const int high = network_.zero_of(side.points.back());
            for (std::size_t k = at(low + 1); k <= (high < 0 ? intervals - 1 : at(high)); ++k) {
                sets.unite(item(side.left, k), item(side.right, k));
            }
        }
        const std::vector<std::vector<int>> touching = cylinders_at_zeros();
        for (std::size_t k = 0; k + 1 < intervals; ++k) {
            std::vector<std::uint32_t> touched;
            for (const int c : touching[k]) {
                touched.push_back(sets.find(item(c, k)));
            }
            std::vector<int> through;
            for (const int c : network_.cylinders) {
                if (std::find(touched.begin(), touched.end(), sets.find(item(c, k))) ==
                    touched.end()) {
                    through.push_back(c);
                }
            }
            for (const int c : through) {
                sets.unite(item(c, k), item(c, k + 1));
            }
        }
        name_bands(sets, intervals);
    }

    void name_bands(DisjointSets& sets, std::size_t intervals) {
        std::map<std::uint32_t, int> number;
        for (const int c : network_.cylinders) {
            std::vector<int>& own = network_.band_at[at(c)];
            for (std::size_t k = 0; k < intervals; ++k) {
                const auto [known, fresh] =
                    number.emplace(sets.find(static_cast<std::uint32_t>(at(c) * intervals + k)),
                                   static_cast<int>(network_.bands.size()));
                const int b = known->second;
                if (fresh) {
                    network_.bands.push_back({static_cast<int>(k) - 1, -1, true, {}});
                }
                FormBand& band = network_.bands[at(b)];
                if (own.empty() || own.back() != b) {
                    band.cylinders.push_back(c);
                }
                band.upper = k + 1 < intervals ? static_cast<int>(k) : -1;
                own.push_back(b);
            }
        }
        for (const CriticalSide& side : network_.sides) {
            if (side.left >= 0 && side.right >= 0) {
                continue;
            }
            const std::vector<int>& own = network_.band_at[at(std::max(side.left, side.right))];
            const int low = network_.zero_of(side.points.front());
            const int high = network_.zero_of(side.points.back());
            for (std::size_t k = at(low + 1); k <= (high < 0 ? intervals - 1 : at(high)); ++k) {
                network_.bands[at(own[k])].closed = false;
            }
        }
    }

    std::vector<std::vector<int>> cylinders_at_zeros() const {
        std::vector<std::vector<int>> touching(network_.zeros.size());
        for (const CriticalSide& side : network_.sides) {
            for (const int point : {side.points.front(), side.points.back()}) {
                if (network_.zero_of(point) < 0) {
                    continue;
                }
                for (const int c : {side.left, side.right}) {
                    if (c >= 0) {
                        touching[at(network_.zero_of(point))].push_back(c);
                    }
                }
            }
        }
        return touching;
    }

    const Foliation& foliation_;
    SideNetwork network_;
    std::map<std::pair<int, int>, int> side_of_;  // By a side's first two points.
    std::vector<std::vector<View>> views_;        // Per side.
};

}  // namespace

SideNetwork find_sides(const Foliation& foliation) {
    return Finder(foliation).run();
}

Eigen::Vector3d point_on(const CriticalSide& side, const Foliation& foliation, double f) {
    const auto above = std::upper_bound(side.f.begin() + 1, side.f.end() - 1, f);
    const auto k = static_cast<std::size_t>(above - side.f.begin());
    const double step = side.f[k] - side.f[k - 1];
    const double part = step > 0.0 ? (f - side.f[k - 1]) / step : 0.5;
    return (1.0 - part) * foliation.critical_points[at(side.points[k - 1])].position +
           part * foliation.critical_points[at(side.points[k])].position;
}

}  // namespace leafcutter::geometry
