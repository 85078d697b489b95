#include "geometry/cases/sphere_slice.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <unordered_map>
#include <utility>
#include <vector>

#include "geometry/error.h"
#include "geometry/plane.h"

namespace leafcutter::geometry {
namespace {

// How near to an arc a vertex may lie, in the longest step of f from it: cutting closer makes
// needles. The next are tried where moving a vertex so far flips a triangle.
constexpr std::array<double, 3> kNearest{1e-3, 1e-5, 1e-7};

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

// Height in units of half a period of f: arcs lie at whole numbers.
double height_of(const Eigen::Vector2d& gf) {
    return 2.0 * gf.y();
}

// Keeps the vertices above `below` symmetric.
void move_height(ChartMap& map, const BranchedCover& cover, int below, double step) {
    map.gf[at(cover.above[at(below)][0])].y() += 0.5 * step;
    map.gf[at(cover.above[at(below)][1])].y() -= 0.5 * step;
}

// Per vertex of the surface the step of height that takes it `nearest` away from the arc.
std::vector<double> steps_off_arcs(const ChartMap& map,
                                   const BranchedCover& cover,
                                   double nearest) {
    std::vector<double> longest(cover.above.size(), 0.0);
    for (int h = 0; h < map.edges.size(); ++h) {
        const int below = cover.vertex_below[at(map.edges.from_of(h))];
        longest[at(below)] = std::max(longest[at(below)], std::abs(height_of(map.difference(h))));
    }
    std::vector<double> steps(cover.above.size(), 0.0);
    for (std::size_t v = 0; v < steps.size(); ++v) {
        const auto [one, other] = cover.above[v];
        const double height = height_of(map.gf[at(one)]);
        const double away = height - std::round(height);
        if (one != other && std::abs(away) < nearest * longest[v]) {
            steps[v] = (away < 0.0 ? -nearest : nearest) * longest[v] - away;
        }
    }
    return steps;
}

void move_off_arcs(ChartMap& map, const BranchedCover& cover) {
    for (const double nearest : kNearest) {
        const std::vector<double> steps = steps_off_arcs(map, cover, nearest);
        for (std::size_t v = 0; v < steps.size(); ++v) {
            move_height(map, cover, static_cast<int>(v), steps[v]);
        }
        std::vector<char> moved_back(steps.size(), 0);
        for (std::vector<int> bad = bad_triangles(map); !bad.empty();) {
            bool changed = false;
            for (const int t : bad) {
                for (const int vertex : map.mesh.triangles[at(t)]) {
                    const int v = cover.vertex_below[at(vertex)];
                    if (steps[at(v)] != 0.0 && moved_back[at(v)] == 0) {
                        move_height(map, cover, v, -steps[at(v)]);
                        moved_back[at(v)] = 1;
                        changed = true;
                    }
                }
            }
            bad = changed ? bad_triangles(map) : std::vector<int>();
        }
    }
}

// A corner of a triangle, in pillowcase units.
struct Corner {
    int vertex = 0;
    bool on_arc = false;  // A branch point, at height `band` exactly.
    int band = 0;         // Else floor(height).
    Eigen::Vector2d place;
};

// A corner of a piece.
struct PieceCorner {
    int vertex = 0;
    Eigen::Vector2d place;
};

class Slicer {
public:
    Slicer(const ChartSurface& surface, const BranchedCover& cover, const ChartMap& on_cover)
        : surface_(surface), cover_(cover), on_cover_(on_cover) {
        map_.mesh.positions = surface.mesh.positions;
        map_.source_vertex = surface.source_vertex;
        map_.shape = ChartShape::Pillowcase;
        map_.width = 2.0 * on_cover.width;
        map_.height = 1.0;
        shear_ = 2.0 * on_cover.shear;
        home_band_.reserve(on_cover.gf.size());
        for (std::size_t v = 0; v < on_cover.gf.size(); ++v) {
            const double height = height_of(on_cover.gf[v]);
            const auto [one, other] = cover.above[at(cover.vertex_below[v])];
            home_band_.push_back(
                static_cast<int>(one == other ? std::round(height) : std::floor(height)));
        }
    }

    ChartMap slice() {
        for (std::size_t t = 0; t < surface_.mesh.triangles.size(); ++t) {
            cut(static_cast<int>(t));
        }
        finish();
        return std::move(map_);
    }

private:
    std::array<Corner, 3> corners_of(int t) const {
        std::array<Corner, 3> corners;
        Eigen::Vector2d jump = Eigen::Vector2d::Zero();
        for (int k = 0; k < 3; ++k) {
            const int h = 3 * t + k;
            const int above = on_cover_.edges.from_of(h);
            const int below = cover_.vertex_below[at(above)];
            const auto [one, other] = cover_.above[at(below)];
            const int band = home_band_[at(above)] + static_cast<int>(std::lround(height_of(jump)));
            Corner& corner = corners[at(k)];
            corner = {.vertex = below,
                      .on_arc = one == other,
                      .band = band,
                      .place = 2.0 * (on_cover_.gf[at(above)] + jump)};
            if (corner.on_arc) {
                corner.place.y() = band;
            }
            jump += on_cover_.jump[at(h)];
        }
        return corners;
    }

    // Heights of the arcs between two corners, from a to b.
    static std::vector<int> arcs_between(const Corner& a, const Corner& b) {
        // Of a corner on an arc, that arc isn't between.
        const int a_high = a.on_arc ? a.band - 1 : a.band;
        const int b_high = b.on_arc ? b.band - 1 : b.band;
        std::vector<int> arcs;
        for (int arc = a.band + 1; arc <= b_high; ++arc) {
            arcs.push_back(arc);
        }
        for (int arc = a_high; arc > b.band; --arc) {
            arcs.push_back(arc);
        }
        return arcs;
    }

    // Into the pillowcase, of height 1: whole periods less, and half a turn where f falls.
    Eigen::Vector2d folded(const Eigen::Vector2d& place, int band) const {
        const int periods = (band + (band & 1)) / 2;
        const Eigen::Vector2d moved =
            place - static_cast<double>(periods) * Eigen::Vector2d(shear_, 2.0);
        return (band & 1) != 0 ? Eigen::Vector2d(-moved) : moved;
    }

    // Where a half-edge crosses the arc `number` of `count` on its way, as a piece before or after
    // it sees it.
    struct Crossing {
        int half_edge = 0;
        int number = 0;
        int count = 0;
        bool after = false;
    };

    int crossing_vertex(const Crossing& crossing, const Eigen::Vector3d& position) {
        int edge = crossing.half_edge;
        int segment = crossing.number + (crossing.after ? 1 : 0);
        int end = crossing.after ? 0 : 1;
        if (!surface_.edges.is_first(edge)) {
            edge = surface_.edges.twin_of(edge);
            segment = crossing.count - segment;
            end = 1 - end;
        }
        // Segments of one edge are few: a chart of that many turns would not be solvable.
        constexpr std::uint64_t kMostSegments = 1U << 16U;
        const std::uint64_t key = (static_cast<std::uint64_t>(edge) * kMostSegments +
                                   static_cast<std::uint64_t>(segment)) *
                                      2 +
                                  static_cast<std::uint64_t>(end);
        const auto [found, is_new] =
            crossings_.try_emplace(key, static_cast<int>(map_.mesh.positions.size()));
        if (is_new) {
            map_.mesh.positions.push_back(position);
            map_.source_vertex.push_back(-1);
        }
        return found->second;
    }

    void add_crossings(int half_edge,
                       const Corner& a,
                       const Corner& b,
                       int band,
                       std::vector<PieceCorner>& piece) {
        const std::vector<int> arcs = arcs_between(a, b);
        const int count = static_cast<int>(arcs.size());
        for (int i = 0; i < count; ++i) {
            const int arc = arcs[at(i)];
            const bool rising = b.place.y() > a.place.y();
            if (arc != band && arc != band + 1) {
                continue;
            }
            const double part =
                std::clamp((arc - a.place.y()) / (b.place.y() - a.place.y()), 0.0, 1.0);
            Eigen::Vector2d place = a.place + part * (b.place - a.place);
            place.y() = arc;
            const Eigen::Vector3d& from = surface_.mesh.positions[at(a.vertex)];
            const Eigen::Vector3d& to = surface_.mesh.positions[at(b.vertex)];
            // Upwards the band's lower arc is where the piece begins.
            const Crossing crossing{half_edge, i, count, (arc == band) == rising};
            piece.push_back(
                {crossing_vertex(crossing, from + part * (to - from)), folded(place, band)});
        }
    }

    void cut(int t) {
        const std::array<Corner, 3> corners = corners_of(t);
        int lowest = corners[0].band;
        int highest = corners[0].band;
        for (const Corner& corner : corners) {
            lowest = std::min(lowest, corner.on_arc ? corner.band - 1 : corner.band);
            highest = std::max(highest, corner.band);
        }
        for (int band = lowest; band <= highest; ++band) {
            std::vector<PieceCorner> piece;
            for (int k = 0; k < 3; ++k) {
                const Corner& a = corners[at(k)];
                if (a.band == band || (a.on_arc && a.band == band + 1)) {
                    piece.push_back({a.vertex, folded(a.place, band)});
                }
                add_crossings(3 * t + k, a, corners[at((k + 1) % 3)], band, piece);
            }
            add_piece(piece);
        }
    }

    // A convex polygon as a fan, round the corner that keeps the smallest triangle largest.
    void add_piece(const std::vector<PieceCorner>& piece) {
        const std::size_t size = piece.size();
        if (size < 3) {
            return;
        }
        const auto smallest = [&](std::size_t first) {
            double least = std::numeric_limits<double>::infinity();
            for (std::size_t i = 1; i + 1 < size; ++i) {
                const Eigen::Vector2d a = piece[(first + i) % size].place - piece[first].place;
                const Eigen::Vector2d b = piece[(first + i + 1) % size].place - piece[first].place;
                least = std::min(least, turn_of(a, b));
            }
            return least;
        };
        std::size_t best = 0;
        for (std::size_t first = 1; first < size && size > 3; ++first) {
            best = smallest(first) > smallest(best) ? first : best;
        }
        for (std::size_t i = 1; i + 1 < size; ++i) {
            const std::array<const PieceCorner*, 3> corners{&piece[best], &piece[(best + i) % size],
                                                            &piece[(best + i + 1) % size]};
            map_.mesh.triangles.push_back(
                {corners[0]->vertex, corners[1]->vertex, corners[2]->vertex});
            places_.push_back({corners[0]->place, corners[1]->place, corners[2]->place});
        }
    }

    // One lift for each vertex, and what edges rise more than that.
    void finish() {
        const int count = static_cast<int>(map_.mesh.positions.size());
        map_.edges = build_half_edges(map_.mesh.triangles, count);
        map_.gf.assign(at(count), Eigen::Vector2d::Zero());
        for (std::size_t t = 0; t < places_.size(); ++t) {
            for (std::size_t k = 0; k < 3; ++k) {
                map_.gf[at(map_.mesh.triangles[t][k])] = places_[t][k];
            }
        }
        map_.jump.assign(map_.edges.from.size(), Eigen::Vector2d::Zero());
        for (std::size_t t = 0; t < places_.size(); ++t) {
            for (std::size_t k = 0; k < 3; ++k) {
                const auto h = static_cast<int>(3 * t + k);
                const Eigen::Vector2d rise = places_[t][(k + 1) % 3] - places_[t][k];
                const double more = rise.x() - map_.difference(h).x();
                map_.jump[at(h)].x() = std::round(more / map_.width) * map_.width;
            }
        }
    }

    const ChartSurface& surface_;
    const BranchedCover& cover_;
    const ChartMap& on_cover_;
    double shear_ = 0.0;  // Of the whole period of f, in pillowcase units.
    std::vector<int> home_band_;
    std::unordered_map<std::uint64_t, int> crossings_;
    ChartMap map_;
    std::vector<std::array<Eigen::Vector2d, 3>> places_;  // Per triangle of map_.
};

}  // namespace

PillowChart slice_pillowcase(const ChartSurface& surface,
                             const BranchedCover& cover,
                             ChartMap on_cover,
                             const std::array<int, 4>& points) {
    move_off_arcs(on_cover, cover);
    PillowChart pillow;
    pillow.map = Slicer(surface, cover, on_cover).slice();
    std::array<std::size_t, 2> filled{0, 0};
    for (const int point : points) {
        const std::size_t fold = pillow.map.gf[at(point)].y() < 0.5 ? 0 : 1;
        if (filled[fold] == 2) {
            throw Error(ErrorKind::SelfCheck, "pillowcase-folds",
                        "sphere-pillowcase: the arcs don't join the four singular points in pairs");
        }
        pillow.folds[fold][filled[fold]++] = point;
    }
    // The place of the upper fold, as near to the lower one as can be.
    const double place = pillow.map.gf[at(pillow.folds[1][0])].x();
    const double half = 0.5 * pillow.map.width;
    pillow.map.shear = place - std::round(place / half) * half;
    return pillow;
}

}  // namespace leafcutter::geometry
