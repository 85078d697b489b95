#include "geometry/puncture_site.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numbers>
#include <span>
#include <utility>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "geometry/disjoint_sets.h"

namespace leafcutter::geometry {
namespace {

// Edges near a hole are at most this part of its circumference.
constexpr double kEdgePart = 1.0 / 40.0;
// Away from the hole edges may grow by this part of the way.
constexpr double kGrading = 0.5;
// A hole's surroundings, by its radius, are free of boundaries and other holes.
constexpr double kClear = 1.3;
// A radius to propose fits by this margin.
constexpr double kMargin = 0.9;
constexpr double kMostArea = 0.5;      // A hole's part of the surface.
constexpr double kLeastRadius = 1e-4;  // By the diagonal of the bounding box.
constexpr int kMostPasses = 60;

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

double edge_near(const PunctureSite& site, std::size_t k) {
    return 2.0 * std::numbers::pi * site.punctures[k].radius * kEdgePart * site.fineness[k];
}

double edge_length(const PunctureSite& site, int h) {
    const ChartSurface& surface = site.surface;
    return (surface.mesh.positions[at(surface.edges.to_of(h))] -
            surface.mesh.positions[at(surface.edges.from_of(h))])
        .norm();
}

// Marks the sides of the triangles round a vertex that are too long that near to a hole.
bool mark_long_sides(const PunctureSite& site,
                     std::span<const int> triangles,
                     double longest,
                     std::vector<char>& marked) {
    bool any = false;
    for (const int t : triangles) {
        for (int h = 3 * t; h < 3 * t + 3; ++h) {
            if (edge_length(site, h) > longest) {
                marked[at(h)] = 1;
                any = true;
            }
        }
    }
    return any;
}

// Marks the longest side of every triangle that has a marked one: splitting then makes no needles
// (Rivara's rule).
void close_marks(const PunctureSite& site, std::vector<char>& marked) {
    const HalfEdges& edges = site.surface.edges;
    std::vector<int> waiting;
    const auto mark = [&](int h) {
        marked[at(h)] = 1;
        waiting.push_back(h / 3);
        if (edges.twin_of(h) >= 0) {
            marked[at(edges.twin_of(h))] = 1;
            waiting.push_back(edges.twin_of(h) / 3);
        }
    };
    for (int h = 0; h < edges.size(); ++h) {
        if (marked[at(h)] != 0) {
            mark(h);
        }
    }
    while (!waiting.empty()) {
        const int first = 3 * waiting.back();
        waiting.pop_back();
        int longest = first;
        for (int h = first + 1; h < first + 3; ++h) {
            longest = edge_length(site, h) > edge_length(site, longest) ? h : longest;
        }
        if (marked[at(longest)] == 0) {
            mark(longest);
        }
    }
}

// First those near a boundary.
std::optional<Misfit> boundary_misfit(const PunctureSite& site, const std::vector<Ball>& balls) {
    std::vector<char> on_boundary(site.surface.mesh.positions.size(), 0);
    const HalfEdges& edges = site.surface.edges;
    for (int h = 0; h < edges.size(); ++h) {
        if (edges.twin_of(h) < 0) {
            on_boundary[at(edges.from_of(h))] = 1;
        }
    }
    for (std::size_t k = 0; k < balls.size(); ++k) {
        for (const auto& [v, distance] : balls[k]) {
            if (on_boundary[at(v)] != 0 && distance < kClear * site.punctures[k].radius) {
                return Misfit{k, "its hole comes too near to a boundary",
                              kMargin * distance / kClear, -1};
            }
        }
    }
    return std::nullopt;
}

std::optional<Misfit> neighbour_misfit(const PunctureSite& site, const std::vector<Ball>& balls) {
    struct Owner {
        int puncture = -1;
        double distance = 0.0;
    };
    std::vector<Owner> owners(site.surface.mesh.positions.size());
    for (std::size_t k = 0; k < balls.size(); ++k) {
        std::optional<Misfit> misfit;
        double nearest = std::numeric_limits<double>::infinity();
        for (const auto& [v, distance] : balls[k]) {
            Owner& owner = owners[at(v)];
            if (owner.puncture >= 0 && owner.distance + distance < nearest) {
                nearest = owner.distance + distance;
                misfit = {k, fmt::format("its hole comes too near to that of [{}]", owner.puncture),
                          kMargin * nearest / (2.0 * kClear), owner.puncture};
            }
            owner = {static_cast<int>(k), distance};
        }
        if (misfit) {
            return misfit;
        }
    }
    return std::nullopt;
}

// Marks in `place` what is reached: 1 inside `radius`, 2 outside. Pockets that the front has closed
// in (tops of bumps) belong to the inside.
void sort_ball(const PunctureSite& site,
               const Ball& ball,
               double radius,
               SurfaceDistance& rings,
               std::vector<char>& place) {
    for (const auto& [v, distance] : ball) {
        place[at(v)] = distance < radius ? 1 : 2;
    }
    std::map<int, std::uint32_t> number;
    for (const auto& [v, distance] : ball) {
        if (place[at(v)] == 2) {
            number.emplace(v, static_cast<std::uint32_t>(number.size()));
        }
    }
    DisjointSets pockets(number.size() + 1);
    const auto beyond = static_cast<std::uint32_t>(number.size());
    for (const auto& [v, distance] : ball) {
        if (place[at(v)] != 2) {
            continue;
        }
        for (const int t : rings.triangles_of(v)) {
            for (const int w : site.surface.mesh.triangles[at(t)]) {
                if (place[at(w)] == 2) {
                    pockets.unite(number.at(v), number.at(w));
                } else if (place[at(w)] == 0) {
                    pockets.unite(number.at(v), beyond);
                }
            }
        }
    }
    for (const auto& [v, index] : number) {
        if (pockets.find(index) != pockets.find(beyond)) {
            place[at(v)] = 1;
        }
    }
}

// `place` is 0 everywhere, and is so again afterwards.
Disk disk_of(const PunctureSite& site,
             const Ball& ball,
             double radius,
             SurfaceDistance& rings,
             std::vector<char>& place) {
    sort_ball(site, ball, radius, rings, place);
    Disk disk;
    // Each triangle is seen from each of its corners inside, each edge from both ends.
    std::array<int, 4> triangles{};
    std::map<std::pair<int, int>, int> edges;
    for (const auto& [v, distance] : ball) {
        if (place[at(v)] != 1) {
            continue;
        }
        disk.inside.push_back(v);
        for (const int t : rings.triangles_of(v)) {
            const auto& corners = site.surface.mesh.triangles[at(t)];
            std::size_t within = 0;
            for (const int w : corners) {
                within += place[at(w)] == 1 ? 1 : 0;
                if (w != v && place[at(w)] == 1) {
                    edges.emplace(std::minmax(v, w), 0);
                }
            }
            ++triangles[within];
            const Eigen::Vector3d& a = site.surface.mesh.positions[at(corners[0])];
            const Eigen::Vector3d ab = site.surface.mesh.positions[at(corners[1])] - a;
            const Eigen::Vector3d ac = site.surface.mesh.positions[at(corners[2])] - a;
            disk.area += 0.5 * ab.cross(ac).norm() / static_cast<double>(within);
        }
    }
    disk.euler =
        static_cast<int>(disk.inside.size()) - static_cast<int>(edges.size()) + triangles[3] / 3;
    for (const auto& [v, distance] : ball) {
        place[at(v)] = 0;
    }
    return disk;
}

// Finds the disks, or a puncture whose hole wouldn't be one.
std::optional<Misfit> disk_misfit(const PunctureSite& site,
                                  const std::vector<Ball>& balls,
                                  std::vector<Disk>& disks) {
    SurfaceDistance rings(site.surface.mesh);
    std::vector<char> place(site.surface.mesh.positions.size(), 0);
    for (std::size_t k = 0; k < balls.size(); ++k) {
        const auto fits = [&](const Disk& disk) {
            return disk.euler == 1 && disk.area < kMostArea * site.area &&
                   disk.inside.size() < balls[k].size();
        };
        double radius = site.punctures[k].radius;
        disks.push_back(disk_of(site, balls[k], radius, rings, place));
        if (fits(disks.back())) {
            continue;
        }
        const double least = kLeastRadius * site.diagonal;
        for (radius *= kMargin; radius > least; radius *= kMargin) {
            if (fits(disk_of(site, balls[k], radius, rings, place))) {
                break;
            }
        }
        return Misfit{k,
                      disks.back().euler == 1
                          ? "its hole takes too much of the surface"
                          : "what it cuts out is no disk: it goes round a limb or a hole",
                      kMargin * radius, -1};
    }
    return std::nullopt;
}

}  // namespace

std::optional<Misfit> find_disks(const PunctureSite& site,
                                 const std::vector<Ball>& balls,
                                 std::vector<Disk>& disks) {
    std::optional<Misfit> misfit = boundary_misfit(site, balls);
    misfit = misfit ? misfit : neighbour_misfit(site, balls);
    return misfit ? misfit : disk_misfit(site, balls, disks);
}

void refine(PunctureSite& site, const Context& context) {
    for (int pass = 0; pass < kMostPasses; ++pass) {
        std::vector<char> marked(site.surface.edges.from.size(), 0);
        SurfaceDistance distances(site.surface.mesh);
        bool any = false;
        for (std::size_t k = 0; k < site.punctures.size(); ++k) {
            context.check();
            const double reach = kClear * site.punctures[k].radius;
            distances.from(std::span(&site.punctures[k].vertex, 1),
                           [&](const SurfaceDistance::Reached& reached) {
                               const double beyond = std::max(reached.distance - reach, 0.0);
                               const bool split =
                                   mark_long_sides(site, distances.triangles_of(reached.vertex),
                                                   edge_near(site, k) + kGrading * beyond, marked);
                               any = any || split;
                               return split || beyond == 0.0;
                           });
        }
        if (!any) {
            return;
        }
        close_marks(site, marked);
        site.surface = split_edges(std::move(site.surface), marked);
    }
}

std::vector<Ball> balls_of(const PunctureSite& site, const Context& context) {
    SurfaceDistance distances(site.surface.mesh);
    // The clear surroundings and one more round.
    std::vector<Ball> balls;
    for (const Puncture& puncture : site.punctures) {
        context.check();
        const double reach = kClear * puncture.radius;
        balls.push_back(distances.from(
            std::span(&puncture.vertex, 1),
            [reach](const SurfaceDistance::Reached& r) { return r.distance < reach; }));
    }
    return balls;
}

}  // namespace leafcutter::geometry
