#include "geometry/repair.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "geometry/edge_table.h"
#include "geometry/error.h"
#include "geometry/orient.h"
#include "geometry/triangulate.h"
#include "geometry/weld.h"

namespace leafcutter::geometry {

namespace {

Error bad_mesh(std::string code, const std::string& message) {
    return {ErrorKind::BadMesh, std::move(code), message};
}

std::string place(const Eigen::Vector3d& p) {
    return fmt::format("({:.6g}, {:.6g}, {:.6g})", p.x(), p.y(), p.z());
}

// Squares and cubes of what lies inside stay finite and above zero.
void check_extent(std::span<const Eigen::Vector3d> positions) {
    constexpr double kLargest = 1e90;
    constexpr double kSmallest = 1e-90;
    if (positions.empty()) {
        return;
    }
    Eigen::Vector3d low = positions[0];
    Eigen::Vector3d high = positions[0];
    for (std::size_t vertex = 0; vertex < positions.size(); ++vertex) {
        const Eigen::Vector3d& p = positions[vertex];
        // Also false for NaN.
        if (!(p.cwiseAbs().maxCoeff() <= kLargest)) {
            throw bad_mesh("degenerate",
                           fmt::format("vertex {} (counted from 0) lies out of range at {}; give "
                                       "finite coordinates below {:g}",
                                       vertex, place(p), kLargest));
        }
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
    }
    if ((high - low).maxCoeff() < kSmallest) {
        throw bad_mesh("zero-area", "all vertices lie in one point: the surface has zero area");
    }
}

// The corners of a face without immediate repetitions.
void append_distinct(std::span<const std::uint32_t> face, std::vector<std::uint32_t>& corners) {
    for (const std::uint32_t corner : face) {
        if (corners.empty() || corners.back() != corner) {
            corners.push_back(corner);
        }
    }
    while (corners.size() > 1 && corners.front() == corners.back()) {
        corners.pop_back();
    }
}

// The faces of the soup as clean rings: at least 3 corners, none listed twice.
class FaceRings {
public:
    FaceRings(const PolygonSoup& soup, RepairReport& report);

    std::span<const std::uint32_t> ring(std::size_t face) const {
        return std::span(corners_).subspan(offsets_[face], offsets_[face + 1] - offsets_[face]);
    }
    std::size_t count() const { return offsets_.size() - 1; }
    bool is_duplicate(std::size_t face) const { return duplicate_[face] != 0; }

private:
    void find_duplicates();

    std::vector<std::uint32_t> corners_;
    std::vector<std::size_t> offsets_{0};
    std::vector<char> duplicate_;
};

FaceRings::FaceRings(const PolygonSoup& soup, RepairReport& report) {
    corners_.reserve(soup.corners.size());
    offsets_.reserve(soup.face_count() + 1);
    std::vector<std::uint32_t> ring;
    for (std::size_t face = 0; face < soup.face_count(); ++face) {
        const std::size_t begin = soup.face_offsets[face];
        ring.clear();
        append_distinct(std::span(soup.corners).subspan(begin, soup.face_offsets[face + 1] - begin),
                        ring);
        if (ring.size() < 3) {
            ++report.degenerate_faces_dropped;
            continue;
        }
        corners_.insert(corners_.end(), ring.begin(), ring.end());
        offsets_.push_back(corners_.size());
    }
    find_duplicates();
    for (const char duplicate : duplicate_) {
        report.duplicate_faces_dropped += duplicate != 0 ? 1 : 0;
    }
}

// Two faces are the same if they have the same set of corners, wherever each list begins and
// whichever way it runs. Faces are compared within groups of equal corner sum and count only.
void FaceRings::find_duplicates() {
    struct Key {
        std::uint64_t hash;
        std::uint32_t face;
    };
    std::vector<std::uint32_t> sorted = corners_;
    std::vector<Key> keys;
    keys.reserve(count());
    constexpr std::uint64_t kFnvPrime = 0x100000001b3;
    constexpr std::uint64_t kFnvBasis = 0xcbf29ce484222325;
    for (std::uint32_t face = 0; face < count(); ++face) {
        const auto set = std::span(sorted).subspan(offsets_[face], ring(face).size());
        std::sort(set.begin(), set.end());
        std::uint64_t hash = kFnvBasis;
        for (const std::uint32_t corner : set) {
            hash = (hash ^ corner) * kFnvPrime;
        }
        keys.push_back({hash, face});
    }
    std::sort(keys.begin(), keys.end(), [](const Key& a, const Key& b) {
        return a.hash != b.hash ? a.hash < b.hash : a.face < b.face;
    });
    duplicate_.assign(count(), 0);
    for (std::size_t i = 1; i < keys.size(); ++i) {
        const auto a =
            std::span(sorted).subspan(offsets_[keys[i - 1].face], ring(keys[i - 1].face).size());
        const auto b = std::span(sorted).subspan(offsets_[keys[i].face], ring(keys[i].face).size());
        duplicate_[keys[i].face] = std::equal(a.begin(), a.end(), b.begin(), b.end()) ? 1 : 0;
    }
}

std::vector<Triangle> triangulate(const PolygonSoup& soup, RepairReport& report) {
    // Ear clipping takes quadratic time on a hostile polygon.
    constexpr double kLargestWork = 1e10;
    const FaceRings faces(soup, report);
    std::vector<Triangle> triangles;
    triangles.reserve(faces.count());
    double work = 0.0;
    for (std::size_t face = 0; face < faces.count(); ++face) {
        if (faces.is_duplicate(face)) {
            continue;
        }
        const std::span<const std::uint32_t> ring = faces.ring(face);
        work += ring.size() > 4 ? std::pow(static_cast<double>(ring.size()), 2) : 0.0;
        if (work > kLargestWork) {
            throw bad_mesh("degenerate",
                           fmt::format("face {} has {} corners; triangulate the polygons in a mesh "
                                       "editor",
                                       face, ring.size()));
        }
        report.triangulated_polygons += ring.size() > 3 ? 1 : 0;
        triangulate_polygon(ring, soup.positions, triangles);
    }
    // A polygon that visits a corner twice may yield triangles that do.
    report.degenerate_faces_dropped += std::erase_if(
        triangles, [](const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; });
    return triangles;
}

void check_edges(std::span<const Eigen::Vector3d> positions, std::span<const Triangle> triangles) {
    std::size_t count = 0;
    Side first;
    std::string faces;
    for_each_edge(sorted_sides(triangles), [&](std::span<const Side> sides) {
        if (sides.size() <= 2 || count++ > 0) {
            return;
        }
        first = sides[0];
        for (const Side& side : sides.first(3)) {
            faces += fmt::format("{}{}", faces.empty() ? "" : ", ", side.face());
        }
        faces += sides.size() > 3 ? ", ..." : "";
    });
    if (count > 0) {
        throw bad_mesh(
            "non-manifold-edges",
            fmt::format("non-manifold edges ({}): shared by more than two faces, first "
                        "between vertices {} and {} (counted from 0) at {}, triangles {}; "
                        "separate the sheets in a mesh editor",
                        count, first.low(), first.high(), place(positions[first.low()]), faces));
    }
}

double twice_area(std::span<const Eigen::Vector3d> positions, const Triangle& t) {
    return (positions[t[1]] - positions[t[0]]).cross(positions[t[2]] - positions[t[0]]).norm();
}

double longest_side_squared(std::span<const Eigen::Vector3d> positions, const Triangle& t) {
    return std::max({(positions[t[1]] - positions[t[0]]).squaredNorm(),
                     (positions[t[2]] - positions[t[1]]).squaredNorm(),
                     (positions[t[0]] - positions[t[2]]).squaredNorm()});
}

void check_area(std::span<const Eigen::Vector3d> positions,
                std::span<const Triangle> triangles,
                RepairReport& report) {
    constexpr double kNoArea = 1e-12;  // Of a triangle's longest side, squared.
    std::size_t flat = 0;
    std::size_t first = 0;
    for (std::size_t face = 0; face < triangles.size(); ++face) {
        const Triangle& t = triangles[face];
        if (twice_area(positions, t) <= kNoArea * longest_side_squared(positions, t)) {
            first = flat == 0 ? face : first;
            ++flat;
        }
    }
    if (flat == triangles.size()) {
        throw bad_mesh(
            "zero-area",
            fmt::format("zero area: the corners of each of the {} triangles lie on a line", flat));
    }
    if (flat > 0) {
        report.warnings.push_back(fmt::format("{} triangles have next to no area, first at {}",
                                              flat, place(positions[triangles[first][0]])));
    }
}

// Builds the half-edge mesh of the vertices in use, in their order.
void build(std::span<const Eigen::Vector3d> positions,
           std::span<const Triangle> triangles,
           std::vector<int>& new_index,
           Mesh& mesh) {
    new_index.assign(positions.size(), -1);
    for (const Triangle& triangle : triangles) {
        for (const std::uint32_t vertex : triangle) {
            new_index[vertex] = 0;
        }
    }
    int used = 0;
    for (int& index : new_index) {
        index = index < 0 ? -1 : used++;
    }
    const auto vertices = static_cast<std::size_t>(used);
    mesh.reserve(vertices, vertices + triangles.size(), triangles.size());
    for (std::size_t vertex = 0; vertex < positions.size(); ++vertex) {
        if (new_index[vertex] >= 0) {
            mesh.add_vertex(positions[vertex]);
        }
    }
    for (const Triangle& t : triangles) {
        const auto face =
            mesh.add_face(Mesh::VertexHandle(new_index[t[0]]), Mesh::VertexHandle(new_index[t[1]]),
                          Mesh::VertexHandle(new_index[t[2]]));
        if (!face.is_valid()) {
            throw Error(ErrorKind::SelfCheck, "repair",
                        fmt::format("repair: the half-edge mesh refused the triangle at {}",
                                    place(positions[t[0]])));
        }
    }
}

}  // namespace

RepairedMesh repair(const PolygonSoup& soup) {
    RepairedMesh result;
    RepairReport& report = result.report;
    if (soup.face_count() == 0) {
        throw bad_mesh("no-faces", "no faces: the file holds no surface (a point cloud or lines?)");
    }
    check_extent(soup.positions);
    std::vector<Triangle> triangles = triangulate(soup, report);
    std::vector<Eigen::Vector3d> positions = soup.positions;
    const WeldResult welded = weld(positions, triangles);
    report.welded_vertices = welded.welded_vertices;
    report.degenerate_faces_dropped += welded.degenerate_faces;
    report.duplicate_faces_dropped += welded.duplicate_faces;
    if (welded.slits > 0) {
        report.warnings.push_back(
            fmt::format("boundaries whose two sides touch all along were kept open as slits: {}",
                        welded.slits));
    }
    if (triangles.empty()) {
        throw bad_mesh("zero-area", "zero area: every face repeats a corner");
    }
    check_edges(positions, triangles);
    check_area(positions, triangles, report);
    report.faces_reoriented = orient(positions, triangles);
    report.split_vertices = split_touching_fans(positions, triangles);
    if (report.split_vertices > 0) {
        report.warnings.push_back(fmt::format(
            "non-manifold vertices, where faces touched in a single point, were split: {}",
            report.split_vertices));
    }
    std::vector<int> new_index;
    build(positions, triangles, new_index, result.mesh);
    result.vertex_of_input.resize(soup.positions.size());
    for (std::size_t vertex = 0; vertex < soup.positions.size(); ++vertex) {
        const std::uint32_t stands_for = welded.representative[vertex];
        result.vertex_of_input[vertex] = new_index[stands_for];
        report.unused_vertices_dropped += stands_for == vertex && new_index[stands_for] < 0 ? 1 : 0;
    }
    return result;
}

}  // namespace leafcutter::geometry
