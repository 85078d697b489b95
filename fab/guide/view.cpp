#include "fab/guide/view.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include <Eigen/Geometry>

#include "fab/clipper_paths.h"
#include "fab/guide/depth_image.h"

namespace leafcutter::fab::guide {

namespace {

constexpr int kCoarsePixels = 260;  // To choose among sides.
constexpr int kFinePixels = 900;    // To find out what hides what in a picture.
constexpr double kClipSteps = 1e4;  // Per side of the mesh.

std::vector<Eigen::Vector3d> projected(const geometry::QuadMesh& mesh, const Camera& camera) {
    std::vector<Eigen::Vector3d> points;
    points.reserve(mesh.vertices.size());
    for (const Eigen::Vector3d& vertex : mesh.vertices) {
        points.push_back(camera.project(vertex));
    }
    return points;
}

Eigen::Vector3d normal_of(const geometry::QuadMesh& mesh, int quad) {
    const auto& [a, b, c, d] = mesh.quads[static_cast<std::size_t>(quad)];
    const auto at = [&](int vertex) -> const Eigen::Vector3d& {
        return mesh.vertices[static_cast<std::size_t>(vertex)];
    };
    const Eigen::Vector3d normal = (at(c) - at(a)).cross(at(d) - at(b));
    const double length = normal.norm();
    return length > 0.0 ? Eigen::Vector3d(normal / length) : Eigen::Vector3d::Zero();
}

// Sees one mesh from one side.
class Viewer {
public:
    Viewer(const geometry::QuadMesh& mesh,
           const geometry::QuadNeighbours& neighbours,
           const Camera& camera)
        : mesh_(mesh),
          neighbours_(neighbours),
          points_(projected(mesh, camera)),
          image_(mesh.quads, points_, kFinePixels) {
        view_.camera = camera;
        view_.low = view_.high = points_.front().head<2>();
        for (const Eigen::Vector3d& point : points_) {
            view_.low = view_.low.cwiseMin(point.head<2>());
            view_.high = view_.high.cwiseMax(point.head<2>());
        }
        const double longest = (view_.high - view_.low).maxCoeff();
        steps_ = kClipSteps / std::max(longest, 1e-12);
    }

    View view() {
        view_.seen_of.assign(mesh_.quads.size(), -1);
        for (std::size_t quad = 0; quad < mesh_.quads.size(); ++quad) {
            add_quad(static_cast<int>(quad));
        }
        add_outline();
        add_contours();
        return std::move(view_);
    }

private:
    Points corners_of(int quad) const {
        Points corners;
        for (const int vertex : mesh_.quads[static_cast<std::size_t>(quad)]) {
            corners.emplace_back(points_[static_cast<std::size_t>(vertex)].head<2>());
        }
        return corners;
    }

    bool is_outside(int quad) const {
        return normal_of(mesh_, quad).dot(view_.camera.to_viewer) > 0.0;
    }

    void add_quad(int quad) {
        int won = 0;
        std::vector<int> hiding;
        image_.for_each_pixel(quad, [&](int nearest) {
            if (nearest == quad) {
                ++won;
            } else {
                hiding.push_back(nearest);
            }
        });
        if (won == 0) {
            return;
        }
        std::sort(hiding.begin(), hiding.end());
        hiding.erase(std::unique(hiding.begin(), hiding.end()), hiding.end());
        SeenQuad seen;
        seen.quad = quad;
        seen.outside = is_outside(quad);
        seen.light = light_on(quad, seen.outside);
        seen.whole = hiding.empty();
        if (hiding.empty()) {
            seen.areas = {corners_of(quad)};
        } else {
            seen.areas = without(quad, hiding);
        }
        if (!seen.areas.empty()) {
            view_.seen_of[static_cast<std::size_t>(quad)] = static_cast<int>(view_.quads.size());
            view_.quads.push_back(std::move(seen));
        }
    }

    // From the upper left, from behind the viewer.
    double light_on(int quad, bool outside) const {
        const Camera& camera = view_.camera;
        const Eigen::Vector3d towards =
            (camera.to_viewer - 0.45 * camera.right + 0.6 * camera.up).normalized();
        const Eigen::Vector3d normal = normal_of(mesh_, quad) * (outside ? 1.0 : -1.0);
        return std::clamp(normal.dot(towards), 0.0, 1.0);
    }

    std::vector<Points> without(int quad, const std::vector<int>& hiding) const {
        ClipperLib::Clipper clipper;
        clipper.AddPath(clipper_path(corners_of(quad), steps_), ClipperLib::ptSubject, true);
        for (const int other : hiding) {
            clipper.AddPath(clipper_path(corners_of(other), steps_), ClipperLib::ptClip, true);
        }
        ClipperLib::Paths rest;
        clipper.Execute(ClipperLib::ctDifference, rest, ClipperLib::pftNonZero,
                        ClipperLib::pftNonZero);
        const double least = std::pow(image_.pixel_size() * steps_, 2.0);
        std::vector<Points> areas;
        for (const ClipperLib::Path& path : rest) {
            if (std::abs(ClipperLib::Area(path)) > least) {
                areas.push_back(ring_of(path, steps_));
            }
        }
        return areas;
    }

    void add_outline() {
        ClipperLib::Clipper clipper;
        for (const SeenQuad& seen : view_.quads) {
            for (const Points& area : seen.areas) {
                clipper.AddPath(upright_path(area, steps_), ClipperLib::ptSubject, true);
            }
        }
        ClipperLib::Paths whole;
        clipper.Execute(ClipperLib::ctUnion, whole, ClipperLib::pftNonZero, ClipperLib::pftNonZero);
        // Slits as narrow as a pixel, where hidden parts were cut away, are closed.
        const double pixel = image_.pixel_size() * steps_;
        const ClipperLib::Paths grown = mitred_offset(whole, 1.5 * pixel);
        for (const ClipperLib::Path& path : mitred_offset(grown, -1.5 * pixel)) {
            if (std::abs(ClipperLib::Area(path)) > 20.0 * pixel * pixel) {
                view_.outline.push_back(ring_of(path, steps_));
            }
        }
    }

    void add_contours() {
        for (const SeenQuad& seen : view_.quads) {
            if (!seen.whole) {
                continue;
            }
            const auto& across = neighbours_.across[static_cast<std::size_t>(seen.quad)];
            const Points corners = corners_of(seen.quad);
            for (std::size_t side = 0; side < 4; ++side) {
                const int other = across[side].quad;
                if (other < 0 || is_outside(other) != seen.outside) {
                    view_.contours.push_back({corners[side], corners[(side + 1) % 4]});
                }
            }
        }
    }

    const geometry::QuadMesh& mesh_;
    const geometry::QuadNeighbours& neighbours_;
    std::vector<Eigen::Vector3d> points_;
    DepthImage image_;
    double steps_ = 1.0;
    View view_;
};

}  // namespace

Eigen::Vector3d Camera::project(const Eigen::Vector3d& point) const {
    return {right.dot(point), -up.dot(point), to_viewer.dot(point)};
}

Camera camera_from(double yaw_deg, double pitch_deg) {
    const double yaw = yaw_deg * std::numbers::pi / 180.0;
    const double pitch = pitch_deg * std::numbers::pi / 180.0;
    Camera camera;
    camera.to_viewer = {std::sin(yaw) * std::cos(pitch), std::sin(pitch),
                        std::cos(yaw) * std::cos(pitch)};
    camera.right = {std::cos(yaw), 0.0, -std::sin(yaw)};
    camera.up = camera.to_viewer.cross(camera.right);
    return camera;
}

Views::Views(const geometry::QuadMesh& mesh)
    : mesh_(mesh), neighbours_(geometry::find_neighbours(mesh.quads)) {
    for (const double pitch : {18.0, 50.0, -30.0}) {
        for (int yaw = 20; yaw < 380; yaw += 45) {
            cameras_.push_back(camera_from(yaw, pitch));
        }
    }
    cameras_.push_back(camera_from(0.0, 85.0));
    cameras_.push_back(camera_from(0.0, -85.0));
    views_.resize(cameras_.size());
    for (const Camera& camera : cameras_) {
        const DepthImage image(mesh.quads, projected(mesh, camera), kCoarsePixels);
        std::vector<float> seen(mesh.quads.size(), 0.0F);
        const auto pixel_area = static_cast<float>(image.pixel_size() * image.pixel_size());
        for (const int quad : image.nearest()) {
            if (quad >= 0 && normal_of(mesh, quad).dot(camera.to_viewer) > 0.0) {
                seen[static_cast<std::size_t>(quad)] += pixel_area;
            }
        }
        seen_area_.push_back(std::move(seen));
    }
}

double Views::seen_area(std::size_t view, std::span<const int> quads) const {
    double area = 0.0;
    for (const int quad : quads) {
        area += seen_area_[view][static_cast<std::size_t>(quad)];
    }
    return area;
}

double Views::seen_area(std::size_t view) const {
    return std::accumulate(seen_area_[view].begin(), seen_area_[view].end(), 0.0);
}

const View& Views::at(std::size_t view) {
    if (!views_[view]) {
        views_[view] = Viewer(mesh_, neighbours_, cameras_[view]).view();
    }
    return *views_[view];
}

}  // namespace leafcutter::fab::guide
