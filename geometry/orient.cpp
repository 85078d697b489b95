#include "geometry/orient.h"

#include <limits>
#include <utility>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "geometry/disjoint_sets.h"
#include "geometry/error.h"

namespace leafcutter::geometry {

namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

// Per side: the other side of its edge, or kNone.
std::vector<std::uint32_t> mates(std::span<const Triangle> triangles) {
    std::vector<std::uint32_t> mate(3 * triangles.size(), kNone);
    for_each_edge(sorted_sides(triangles), [&](std::span<const Side> sides) {
        if (sides.size() == 2) {
            mate[sides[0].index] = sides[1].index;
            mate[sides[1].index] = sides[0].index;
        }
    });
    return mate;
}

// Walks over one component from face to face and settles which faces are wound against the first.
class WindingWalk {
public:
    explicit WindingWalk(std::span<const Triangle> triangles)
        : triangles_(triangles), mate_(mates(triangles)), winding_(triangles.size(), kUnseen) {}

    struct Component {
        std::vector<std::uint32_t> faces;
        std::size_t against = 0;
        bool closed = true;
    };
    bool seen(std::uint32_t face) const { return winding_[face] != kUnseen; }
    bool is_against(std::uint32_t face) const { return winding_[face] == kAgainst; }
    Component walk(std::uint32_t first);

private:
    static constexpr char kUnseen = 0;
    static constexpr char kWith = 1;
    static constexpr char kAgainst = 2;

    void cross(std::uint32_t side, Component& component);

    std::span<const Triangle> triangles_;
    std::vector<std::uint32_t> mate_;
    std::vector<char> winding_;
};

void WindingWalk::cross(std::uint32_t side, Component& component) {
    const std::uint32_t other = mate_[side];
    if (other == kNone) {
        component.closed = false;
        return;
    }
    const bool agree = side_start(triangles_, side) == side_end(triangles_, other);
    const bool against = is_against(side / 3) == agree;
    const char wanted = against ? kAgainst : kWith;
    char& winding = winding_[other / 3];
    if (winding == kUnseen) {
        winding = wanted;
        component.faces.push_back(other / 3);
        component.against += against ? 1 : 0;
    } else if (winding != wanted) {
        throw Error(
            ErrorKind::BadMesh, "not-orientable",
            fmt::format("the surface is not orientable (one-sided, as a Moebius strip): faces "
                        "{} and {} (counted from 0) can't be made to agree; cut it open",
                        side / 3, other / 3));
    }
}

WindingWalk::Component WindingWalk::walk(std::uint32_t first) {
    Component component;
    winding_[first] = kWith;
    component.faces.push_back(first);
    for (std::size_t i = 0; i < component.faces.size(); ++i) {
        for (std::uint32_t corner = 0; corner < 3; ++corner) {
            cross(3 * component.faces[i] + corner, component);
        }
    }
    return component;
}

// Six times the volume a closed component would hold with all its faces wound as its first.
double signed_volume(std::span<const Eigen::Vector3d> positions,
                     std::span<const Triangle> triangles,
                     const WindingWalk& walk,
                     const WindingWalk::Component& component) {
    const Eigen::Vector3d& origin = positions[triangles[component.faces[0]][0]];
    double volume = 0.0;
    for (const std::uint32_t face : component.faces) {
        const Eigen::Vector3d a = positions[triangles[face][0]] - origin;
        const Eigen::Vector3d b = positions[triangles[face][1]] - origin;
        const Eigen::Vector3d c = positions[triangles[face][2]] - origin;
        volume += (walk.is_against(face) ? -1.0 : 1.0) * a.dot(b.cross(c));
    }
    return volume;
}

}  // namespace

std::size_t orient(std::span<const Eigen::Vector3d> positions, std::vector<Triangle>& triangles) {
    WindingWalk walk(triangles);
    std::vector<std::uint32_t> turned;
    for (std::uint32_t first = 0; first < triangles.size(); ++first) {
        if (walk.seen(first)) {
            continue;
        }
        const WindingWalk::Component component = walk.walk(first);
        if (component.against == 0) {
            continue;
        }
        const bool keep_first = component.closed
                                    ? signed_volume(positions, triangles, walk, component) >= 0.0
                                    : 2 * component.against <= component.faces.size();
        for (const std::uint32_t face : component.faces) {
            if (walk.is_against(face) == keep_first) {
                turned.push_back(face);
            }
        }
    }
    for (const std::uint32_t face : turned) {
        std::swap(triangles[face][1], triangles[face][2]);
    }
    return turned.size();
}

std::size_t split_touching_fans(std::vector<Eigen::Vector3d>& positions,
                                std::vector<Triangle>& triangles) {
    const std::vector<std::uint32_t> mate = mates(triangles);
    const auto next_corner = [](std::uint32_t corner) {
        return corner % 3 == 2 ? corner - 2 : corner + 1;
    };
    DisjointSets fans(3 * triangles.size());  // Of corners; corner 3 f + k starts side 3 f + k.
    for (std::uint32_t side = 0; side < mate.size(); ++side) {
        if (mate[side] != kNone && mate[side] > side) {
            fans.unite(side, next_corner(mate[side]));
            fans.unite(next_corner(side), mate[side]);
        }
    }
    std::vector<std::uint32_t> fan_of_vertex(positions.size(), kNone);
    std::vector<std::uint32_t> copy_of_fan(mate.size(), kNone);
    std::size_t copies = 0;
    for (std::uint32_t corner = 0; corner < mate.size(); ++corner) {
        std::uint32_t& vertex = triangles[corner / 3][corner % 3];
        const std::uint32_t fan = fans.find(corner);
        if (fan_of_vertex[vertex] == kNone) {
            fan_of_vertex[vertex] = fan;
        }
        if (fan_of_vertex[vertex] == fan) {
            continue;
        }
        if (copy_of_fan[fan] == kNone) {
            copy_of_fan[fan] = static_cast<std::uint32_t>(positions.size());
            positions.push_back(Eigen::Vector3d(positions[vertex]));
            fan_of_vertex.push_back(fan);
            ++copies;
        }
        vertex = copy_of_fan[fan];
    }
    return copies;
}

}  // namespace leafcutter::geometry
