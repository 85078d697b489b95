#include "geometry/puncture_cutter.h"

#include <algorithm>
#include <cstddef>

#include <Eigen/Geometry>

#include "geometry/surface_measures.h"

namespace leafcutter::geometry {
namespace {

// Cuts stay this part of an edge away from its ends.
constexpr double kLeastFraction = 0.15;

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

}  // namespace

PunctureCutter::PunctureCutter(const PunctureSite& site,
                               const std::vector<Ball>& balls,
                               const std::vector<Disk>& disks)
    : site_(site),
      hole_(site.surface.mesh.positions.size(), -1),
      distance_(site.surface.mesh.positions.size(), 0.0),
      rims_(disks.size()) {
    for (std::size_t k = 0; k < disks.size(); ++k) {
        for (const auto& [v, distance] : balls[k]) {
            distance_[at(v)] = distance;
        }
        for (const int v : disks[k].inside) {
            hole_[at(v)] = static_cast<int>(k);
        }
    }
    out_.mesh.positions = site.surface.mesh.positions;
    out_.source_vertex = site.surface.source_vertex;
}

void PunctureCutter::cut() {
    for (const auto& triangle : site_.surface.mesh.triangles) {
        int inside = 0;
        for (const int v : triangle) {
            inside += is_inside(v) ? 1 : 0;
        }
        // Turned so that corner 0 is the one that differs from the others.
        std::size_t first = 0;
        while (inside % 3 != 0 && is_inside(triangle[first]) != (inside == 1)) {
            ++first;
        }
        const std::array<int, 3> turned{triangle[first], triangle[(first + 1) % 3],
                                        triangle[(first + 2) % 3]};
        if (inside == 0) {
            out_.mesh.triangles.push_back(triangle);
        } else if (inside == 1) {
            keep_two(turned);
        } else if (inside == 2) {
            const int p = crossing(turned[1], turned[0]);
            out_.mesh.triangles.push_back({turned[0], p, crossing(turned[2], turned[0])});
        }
    }
}

OpenedMesh PunctureCutter::finish() {
    drop_unused();
    out_.punctures = site_.punctures;
    out_.removed_area = site_.area - surface_area(out_.mesh);
    const HalfEdges edges =
        build_half_edges(out_.mesh.triangles, static_cast<int>(out_.mesh.positions.size()));
    for (const std::vector<int>& rim : rims_) {
        out_.loops.push_back(boundary_path(edges, rim.front(), rim.front()));
        if (out_.loops.back().size() != rim.size()) {
            throw Error(ErrorKind::SelfCheck, "broken-hole",
                        "punctures: the rim of a hole is not one simple loop");
        }
    }
    return std::move(out_);
}

bool PunctureCutter::is_inside(int vertex) const {
    return hole_[at(vertex)] >= 0;
}

int PunctureCutter::crossing(int inside, int outside) {
    const auto [place, is_new] =
        crossings_.try_emplace({inside, outside}, static_cast<int>(out_.mesh.positions.size()));
    if (is_new) {
        const int hole = hole_[at(inside)];
        const double low = distance_[at(inside)];
        const double high = distance_[at(outside)];
        const double t = high > low ? (site_.punctures[at(hole)].radius - low) / (high - low) : 0.5;
        const double clamped = std::clamp(t, kLeastFraction, 1.0 - kLeastFraction);
        const auto& positions = site_.surface.mesh.positions;
        out_.mesh.positions.emplace_back((1.0 - clamped) * positions[at(inside)] +
                                         clamped * positions[at(outside)]);
        out_.source_vertex.push_back(-1);
        rims_[at(hole)].push_back(place->second);
    }
    return place->second;
}

// Corner 0 is cut off.
void PunctureCutter::keep_two(const std::array<int, 3>& triangle) {
    const int p = crossing(triangle[0], triangle[1]);
    const int q = crossing(triangle[0], triangle[2]);
    const auto& positions = out_.mesh.positions;
    if ((positions[at(p)] - positions[at(triangle[2])]).squaredNorm() <
        (positions[at(q)] - positions[at(triangle[1])]).squaredNorm()) {
        out_.mesh.triangles.push_back({p, triangle[1], triangle[2]});
        out_.mesh.triangles.push_back({p, triangle[2], q});
    } else {
        out_.mesh.triangles.push_back({p, triangle[1], q});
        out_.mesh.triangles.push_back({q, triangle[1], triangle[2]});
    }
}

void PunctureCutter::drop_unused() {
    std::vector<int> number(out_.mesh.positions.size(), -1);
    int count = 0;
    for (std::size_t v = 0; v < number.size(); ++v) {
        if (v < hole_.size() && hole_[v] >= 0) {
            continue;
        }
        number[v] = count;
        out_.mesh.positions[at(count)] = out_.mesh.positions[v];
        out_.source_vertex[at(count)] = out_.source_vertex[v];
        ++count;
    }
    out_.mesh.positions.resize(at(count));
    out_.source_vertex.resize(at(count));
    for (auto& triangle : out_.mesh.triangles) {
        for (int& v : triangle) {
            v = number[at(v)];
        }
    }
    for (std::vector<int>& rim : rims_) {
        for (int& v : rim) {
            v = number[at(v)];
        }
    }
}

}  // namespace leafcutter::geometry
