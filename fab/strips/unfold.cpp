#include "fab/strips/unfold.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

namespace leafcutter::fab {

namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// A quad whose diagonals pass each other closer than this part of its size is planar.
constexpr double kPlanar = 1e-6;

// Fold angles that differ by less are equal; then the shorter diagonal is the better hinge.
constexpr double kSameFoldDeg = 1.0;

struct Corners {
    Vector3d l0, r0, r1, l1;
};

enum class Side { Left, Right };

double degrees(double radians) {
    return radians * 180.0 / std::numbers::pi;
}

// The exterior angle of the hinge p–q between the triangles (p, q, a) and (q, p, b).
double fold_angle_deg(const std::array<Vector3d, 2>& hinge, const Vector3d& a, const Vector3d& b) {
    const Vector3d axis = hinge[1] - hinge[0];
    const Vector3d one = axis.cross(a - hinge[0]);
    const Vector3d two = (b - hinge[0]).cross(axis);
    return degrees(std::atan2(one.cross(two).norm(), one.dot(two)));
}

double diagonal_gap(const Corners& cell) {
    const Vector3d normal = (cell.r1 - cell.l0).cross(cell.l1 - cell.r0);
    const double length = normal.norm();
    return length > 0.0 ? std::abs(normal.dot(cell.r0 - cell.l0)) / length : 0.0;
}

double size_of(const Corners& cell) {
    return std::max({(cell.r1 - cell.l0).norm(), (cell.l1 - cell.r0).norm(),
                     (cell.r0 - cell.l0).norm(), (cell.l1 - cell.r1).norm(),
                     (cell.l1 - cell.l0).norm(), (cell.r1 - cell.r0).norm()});
}

struct FlatEdge {
    Vector2d from;
    Vector2d to;
};

struct SpaceEdge {
    Vector3d from;
    Vector3d to;
};

// The point that lies to `edge` in the plane as `point` lies to `space` in space, on the given
// side.
Vector2d place(const FlatEdge& edge, const SpaceEdge& space, const Vector3d& point, Side side) {
    const Vector3d axis = (space.to - space.from).stableNormalized();
    const Vector3d arm = point - space.from;
    const double along = arm.dot(axis);
    const double across = (arm - along * axis).norm();
    Vector2d direction = (edge.to - edge.from).stableNormalized();
    if (direction.squaredNorm() < 0.5) {
        direction = Vector2d::UnitY();  // A rung of no length: any direction is isometric.
    }
    const Vector2d normal(-direction.y(), direction.x());
    return edge.from + along * direction + (side == Side::Left ? across : -across) * normal;
}

struct Hinge {
    bool rising = true;  // Folds on r0–l1, else on l0–r1.
    double fold_deg = 0.0;
};

// The diagonal with the smaller fold; it is also the one inside a concave cell, because over the
// other one the two triangles would lie on each other. Of equal folds the shorter diagonal.
Hinge choose_hinge(const Corners& cell) {
    const double rising = fold_angle_deg({cell.r0, cell.l1}, cell.l0, cell.r1);
    const double falling = fold_angle_deg({cell.l0, cell.r1}, cell.l1, cell.r0);
    const bool equal = std::abs(rising - falling) < kSameFoldDeg;
    const bool shorter = (cell.l1 - cell.r0).norm() <= (cell.r1 - cell.l0).norm();
    const bool take_rising = equal ? shorter : rising < falling;
    return {take_rising, take_rising ? rising : falling};
}

void lay_cell(const Corners& cell, const Hinge& hinge, Unfolded& flat) {
    const Vector2d l0 = flat.left.back();
    const Vector2d r0 = flat.right.back();
    if (hinge.rising) {
        const Vector2d l1 = place({r0, l0}, {cell.r0, cell.l0}, cell.l1, Side::Right);
        flat.left.push_back(l1);
        flat.right.push_back(place({r0, l1}, {cell.r0, cell.l1}, cell.r1, Side::Right));
    } else {
        const Vector2d r1 = place({r0, l0}, {cell.r0, cell.l0}, cell.r1, Side::Right);
        flat.right.push_back(r1);
        flat.left.push_back(place({l0, r1}, {cell.l0, cell.r1}, cell.l1, Side::Left));
    }
}

// Turns the piece about its first rung so that its ends' chord runs along +x.
void align(Unfolded& flat) {
    const Vector2d start = (flat.left.front() + flat.right.front()) / 2.0;
    const Vector2d chord = (flat.left.back() + flat.right.back()) / 2.0 - start;
    const double length = chord.norm();
    const Vector2d x = length > 0.0 ? Vector2d(chord / length) : Vector2d::UnitX();
    Eigen::Matrix2d turn;
    turn << x.x(), x.y(), -x.y(), x.x();
    for (Polyline* side : {&flat.left, &flat.right}) {
        for (Vector2d& point : *side) {
            point = turn * (point - start);
        }
    }
}

WalkedCell walked(const geometry::QuadMesh& mesh, int quad, Family family, bool forward) {
    const auto& [a, b, c, d] = mesh.quads[static_cast<std::size_t>(quad)];
    if (family == Family::Weft) {
        return forward ? WalkedCell{d, a, b, c, Bend::Ac} : WalkedCell{b, c, d, a, Bend::Ac};
    }
    return forward ? WalkedCell{a, b, c, d, Bend::Bd} : WalkedCell{c, d, a, b, Bend::Bd};
}

bool meet(const WalkedCell& cell, const WalkedCell& next) {
    return cell.l1 == next.l0 && cell.r1 == next.r0;
}

}  // namespace

std::vector<WalkedCell> walk_cells(const geometry::QuadMesh& mesh, const Strip& strip) {
    std::vector<int> quads = strip.quads;
    quads.insert(quads.end(), strip.beyond.begin(), strip.beyond.end());
    std::vector<WalkedCell> cells;
    cells.reserve(quads.size());
    for (std::size_t i = 0; i < quads.size(); ++i) {
        const WalkedCell forward = walked(mesh, quads[i], strip.family, true);
        const WalkedCell backward = walked(mesh, quads[i], strip.family, false);
        bool turned = false;
        if (i > 0) {
            turned = !meet(cells.back(), forward) && meet(cells.back(), backward);
        } else if (quads.size() > 1) {
            const WalkedCell next = walked(mesh, quads[1], strip.family, true);
            const WalkedCell next_turned = walked(mesh, quads[1], strip.family, false);
            turned = !meet(forward, next) && !meet(forward, next_turned) &&
                     (meet(backward, next) || meet(backward, next_turned));
        }
        cells.push_back(turned ? backward : forward);
    }
    return cells;
}

Unfolded unfold(const geometry::QuadMesh& mesh,
                const std::vector<WalkedCell>& cells,
                const CellRun& run) {
    const auto at = [&](int vertex) -> const Vector3d& {
        return mesh.vertices[static_cast<std::size_t>(vertex)];
    };
    Unfolded flat;
    for (int i = 0; i < run.count; ++i) {
        const WalkedCell& walked_cell =
            cells[static_cast<std::size_t>(run.first + i) % cells.size()];
        const Corners cell{at(walked_cell.l0), at(walked_cell.r0), at(walked_cell.r1),
                           at(walked_cell.l1)};
        if (i == 0) {
            const double half = (cell.l0 - cell.r0).norm() / 2.0;
            flat.left.emplace_back(0.0, half);
            flat.right.emplace_back(0.0, -half);
        }
        const Hinge hinge = choose_hinge(cell);
        lay_cell(cell, hinge, flat);
        const bool planar = diagonal_gap(cell) <= kPlanar * size_of(cell);
        const Bend falling = walked_cell.rising == Bend::Ac ? Bend::Bd : Bend::Ac;
        flat.bend.push_back(planar ? Bend::None : (hinge.rising ? walked_cell.rising : falling));
        flat.fold_deg.push_back(planar ? 0.0 : hinge.fold_deg);
        flat.fold_rises.push_back(hinge.rising ? 1 : 0);
    }
    align(flat);
    return flat;
}

}  // namespace leafcutter::fab
