#include "geometry/quads/vertex_quality.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/quads/bilinear_patch.h"

namespace leafcutter::geometry {

namespace {

using Eigen::Vector3d;

constexpr std::size_t kLeavesCross = 4;  // Quads around a regular vertex.

// The corner of a quad at a vertex, between the edges to `next` and, counter-clockwise, `previous`.
struct Sector {
    int next = -1;
    int previous = -1;
    double angle_deg = 0.0;
};

// The sectors of every vertex, one vertex after the other.
struct Sectors {
    std::vector<std::size_t> begin;  // Per vertex, and one more.
    std::vector<Sector> all;

    std::span<Sector> at(std::size_t vertex) {
        return std::span(all).subspan(begin[vertex], begin[vertex + 1] - begin[vertex]);
    }
};

Sectors collect_sectors(const QuadMesh& mesh, std::span<const std::size_t> quads) {
    Sectors sectors;
    sectors.begin.assign(mesh.vertices.size() + 1, 0);
    for (const std::size_t quad : quads) {
        for (const int corner : mesh.quads[quad]) {
            ++sectors.begin[static_cast<std::size_t>(corner) + 1];
        }
    }
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
        sectors.begin[v + 1] += sectors.begin[v];
    }
    sectors.all.resize(4 * quads.size());
    std::vector<std::size_t> place(sectors.begin.begin(), sectors.begin.end() - 1);
    for (const std::size_t quad : quads) {
        const auto& corners = mesh.quads[quad];
        const auto position = [&](std::size_t corner) -> const Vector3d& {
            return mesh.vertices[static_cast<std::size_t>(corners[corner % 4])];
        };
        for (std::size_t i = 0; i < 4; ++i) {
            const double angle =
                angle_between_deg(position(i + 1) - position(i), position(i + 3) - position(i));
            sectors.all[place[static_cast<std::size_t>(corners[i])]++] = {
                .next = corners[(i + 1) % 4], .previous = corners[(i + 3) % 4], .angle_deg = angle};
        }
    }
    return sectors;
}

// Orders the sectors counter-clockwise; whether they close up around the vertex.
bool close_up(std::span<Sector> sectors) {
    for (std::size_t i = 0; i + 1 < sectors.size(); ++i) {
        const auto following =
            std::find_if(sectors.begin() + static_cast<std::ptrdiff_t>(i) + 1, sectors.end(),
                         [&](const Sector& other) { return other.next == sectors[i].previous; });
        if (following == sectors.end()) {
            return false;
        }
        std::swap(sectors[i + 1], *following);
    }
    return sectors.back().previous == sectors.front().next;
}

// How far the leaf between the first and second two of four sectors turns within the surface: half
// of what the angles on its two sides differ by.
double turning_deg(std::span<const Sector> around, std::size_t first) {
    const auto angle = [&](std::size_t i) { return around[(first + i) % 4].angle_deg; };
    return 0.5 * std::abs(angle(0) + angle(1) - angle(2) - angle(3));
}

VertexQuality measure_vertex(const QuadMesh& mesh, std::span<Sector> sectors) {
    VertexQuality vertex;
    if (sectors.empty()) {
        return vertex;
    }
    double turn = 0.0;
    for (const Sector& sector : sectors) {
        vertex.angle_deviation_deg += std::abs(sector.angle_deg - 90.0);
        turn += sector.angle_deg;
    }
    const auto count = static_cast<double>(sectors.size());
    vertex.angle_deviation_deg /= count;
    if (!close_up(sectors)) {
        vertex.place = sectors.size() == 1 ? VertexPlace::Corner : VertexPlace::Boundary;
        return vertex;
    }
    if (sectors.size() != kLeavesCross) {
        vertex.place = VertexPlace::Singular;
        vertex.bound_deg = std::abs(turn / count - 90.0);
        return vertex;
    }
    vertex.place = VertexPlace::Regular;
    vertex.bound_deg = 0.5 * std::max(turning_deg(sectors, 0), turning_deg(sectors, 1));
    const auto neighbour = [&](std::size_t i) -> const Vector3d& {
        return mesh.vertices[static_cast<std::size_t>(sectors[i].next)];
    };
    vertex.crossing_deviation_deg = std::abs(
        angle_between_deg(neighbour(2) - neighbour(0), neighbour(3) - neighbour(1)) - 90.0);
    return vertex;
}

}  // namespace

std::vector<VertexQuality> measure_vertices(const QuadMesh& mesh,
                                            std::span<const std::size_t> quads) {
    Sectors sectors = collect_sectors(mesh, quads);
    std::vector<VertexQuality> vertices(mesh.vertices.size());
    for (std::size_t v = 0; v < vertices.size(); ++v) {
        vertices[v] = measure_vertex(mesh, sectors.at(v));
    }
    return vertices;
}

}  // namespace leafcutter::geometry
