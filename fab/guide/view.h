// What is seen of a quad mesh from a direction: parallel projection, hidden parts cut away exactly
// enough for print, so that pictures can be drawn in any order and colours.

#pragma once

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "fab/guide/document.h"
#include "geometry/quads/quad_edges.h"
#include "geometry/quads/quad_mesh.h"

namespace leafcutter::fab::guide {

// Orthonormal, right-handed: right, up, towards the viewer.
struct Camera {
    Eigen::Vector3d right;
    Eigen::Vector3d up;
    Eigen::Vector3d to_viewer;

    // x to the right, y down, depth towards the viewer; in units of the mesh.
    Eigen::Vector3d project(const Eigen::Vector3d& point) const;
};

// Looks from the given side; upright is the y axis.
Camera camera_from(double yaw_deg, double pitch_deg);

struct SeenQuad {
    int quad = 0;
    bool outside = true;        // Else it is seen from inside, through a hole.
    bool whole = true;          // No other quad hides a part of it.
    double light = 1.0;         // 0: seen edge-on or in the shade, 1: lit fully.
    std::vector<Points> areas;  // What is seen of it. Areas of different quads don't overlap.
};

struct View {
    Camera camera;
    Point low;  // Of the whole mesh, projected.
    Point high;
    std::vector<SeenQuad> quads;   // Only those that are seen, by number.
    std::vector<int> seen_of;      // Per quad its place in `quads`; -1: hidden.
    std::vector<Points> outline;   // Closed: around all that is seen.
    std::vector<Points> contours;  // Edges where the surface turns away from the viewer.
};

// The same mesh from many sides.
class Views {
public:
    explicit Views(const geometry::QuadMesh& mesh);

    std::size_t count() const { return cameras_.size(); }
    const Camera& camera(std::size_t view) const { return cameras_[view]; }

    // How much of these quads is seen from there, in units of the mesh, squared.
    double seen_area(std::size_t view, std::span<const int> quads) const;
    double seen_area(std::size_t view) const;

    // Made when first asked for.
    const View& at(std::size_t view);

private:
    const geometry::QuadMesh& mesh_;
    geometry::QuadNeighbours neighbours_;
    std::vector<Camera> cameras_;
    std::vector<std::vector<float>> seen_area_;  // Per view and quad.
    std::vector<std::optional<View>> views_;
};

}  // namespace leafcutter::fab::guide
