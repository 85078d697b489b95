// Planarity: D = n·(q − p), with n the unit normal of both diagonals and p, q their closest points;
// as these are stationary, the gradient is n times the weights of the corners in p and q, exactly.
//
// D counts against the width of a cell, so that thin ones don't twist while wide ones move.
//
// Square corners are asked for by the cotangent of the angle: it is the cosine near 90 degrees and
// grows without bound as a corner closes or straightens, so that cells neither turn concave nor
// collapse. Lengths are asked for by (l/l0 − l0/l) / 2 for the same reason.

#include "geometry/quads/planar_cell.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include <Eigen/Geometry>

namespace leafcutter::geometry {

namespace {

using Eigen::Vector3d;

constexpr double kSquareness = 0.5;
constexpr double kLength = 0.25;
constexpr double kFairness = 0.1;

// Steeper corners and shorter sides (against their start) pull no harder.
constexpr double kSmallestSine = 0.25;
constexpr double kSmallestStretch = 0.02;

// Width of a cell, against its diagonals, below which it counts as no thinner.
constexpr double kThinnest = 0.02;

// Sides belong to two cells, and count half in each.
constexpr double kHalf = 1.0 / std::numbers::sqrt2;

constexpr int kAngleRows = 0;
constexpr int kLengthRows = 4;
constexpr int kFairRows = 8;
constexpr int kPlanarRow = 20;

void add_gradient(CellJacobian& jacobian, int row, std::size_t corner, const Vector3d& gradient) {
    jacobian.block<1, 3>(row, static_cast<Eigen::Index>(3 * corner)) += gradient.transpose();
}

void angle_row(const CellCorners& at,
               std::size_t corner,
               CellResidual& residual,
               CellJacobian* jacobian) {
    const int row = kAngleRows + static_cast<int>(corner);
    const std::size_t next = (corner + 1) % 4;
    const std::size_t last = (corner + 3) % 4;
    const double next_length = (at[next] - at[corner]).norm();
    const double last_length = (at[last] - at[corner]).norm();
    if (next_length <= 0.0 || last_length <= 0.0) {
        return;
    }
    const Vector3d u = (at[next] - at[corner]) / next_length;
    const Vector3d w = (at[last] - at[corner]) / last_length;
    const double cosine = u.dot(w);
    const double sine = std::max(u.cross(w).norm(), kSmallestSine);
    residual[row] = kSquareness * cosine / sine;
    if (jacobian != nullptr) {
        const double factor = kSquareness / (sine * sine * sine);
        const Vector3d by_next = factor * (w - cosine * u) / next_length;
        const Vector3d by_last = factor * (u - cosine * w) / last_length;
        add_gradient(*jacobian, row, next, by_next);
        add_gradient(*jacobian, row, last, by_last);
        add_gradient(*jacobian, row, corner, -by_next - by_last);
    }
}

void length_row(const CellCorners& start,
                const CellCorners& at,
                std::size_t side,
                CellResidual& residual,
                CellJacobian* jacobian) {
    const int row = kLengthRows + static_cast<int>(side);
    const std::size_t next = (side + 1) % 4;
    const double wanted = (start[next] - start[side]).norm();
    const double length = (at[next] - at[side]).norm();
    if (wanted <= 0.0 || length <= 0.0) {
        return;
    }
    const double ratio = std::max(length / wanted, kSmallestStretch);
    residual[row] = kHalf * kLength * 0.5 * (ratio - 1.0 / ratio);
    if (jacobian != nullptr) {
        const Vector3d by_next = kHalf * kLength * 0.5 * (1.0 + 1.0 / (ratio * ratio)) / wanted *
                                 (at[next] - at[side]) / length;
        add_gradient(*jacobian, row, next, by_next);
        add_gradient(*jacobian, row, side, -by_next);
    }
}

double mean_side(const CellCorners& at) {
    double sum = 0.0;
    for (std::size_t i = 0; i < 4; ++i) {
        sum += (at[(i + 1) % 4] - at[i]).norm();
    }
    return 0.25 * sum;
}

void fair_rows(const CellCorners& start,
               const CellCorners& at,
               CellResidual& residual,
               CellJacobian* jacobian) {
    const double factor = kHalf * kFairness / std::max(mean_side(start), 1e-300);
    for (std::size_t side = 0; side < 4; ++side) {
        const int row = kFairRows + 3 * static_cast<int>(side);
        const std::size_t next = (side + 1) % 4;
        residual.segment<3>(row) = factor * ((at[next] - start[next]) - (at[side] - start[side]));
        if (jacobian != nullptr) {
            jacobian->block<3, 3>(row, static_cast<Eigen::Index>(3 * next)).diagonal().array() +=
                factor;
            jacobian->block<3, 3>(row, static_cast<Eigen::Index>(3 * side)).diagonal().array() -=
                factor;
        }
    }
}

// The two diagonals as lines, at their closest points.
struct Crossing {
    Vector3d normal;
    double on_ac = 0.5;  // p = a + on_ac (c − a).
    double on_bd = 0.5;  // q = b + on_bd (d − b).
    double gap = 0.0;
    double diagonal = 0.0;  // Mean length.
    double extent = 0.0;    // As `diagonal`; of a thin cell its width, twice.
    bool flat = false;      // No area: nothing is known.
};

Crossing crossing_of(const CellCorners& at) {
    const Vector3d ac = at[2] - at[0];
    const Vector3d bd = at[3] - at[1];
    const Vector3d cross = ac.cross(bd);
    const double area = cross.norm();
    Crossing found;
    found.diagonal = 0.5 * (ac.norm() + bd.norm());
    if (!(area > 1e-12 * found.diagonal * found.diagonal)) {
        found.flat = true;
        return found;
    }
    found.normal = cross / area;
    found.extent = std::clamp(area / found.diagonal, kThinnest * found.diagonal, found.diagonal);
    const Vector3d ab = at[1] - at[0];
    found.gap = ab.dot(found.normal);
    // Of ab = on_ac ac − on_bd bd + gap n.
    found.on_ac = ab.cross(bd).dot(cross) / (area * area);
    found.on_bd = ab.cross(ac).dot(cross) / (area * area);
    return found;
}

void planar_row(const CellCorners& at,
                const CellWishes& wishes,
                CellResidual& residual,
                CellJacobian* jacobian) {
    const Crossing crossing = crossing_of(at);
    if (crossing.flat || wishes.planarity <= 0.0) {
        return;
    }
    residual[kPlanarRow] =
        wishes.planarity * crossing.gap / crossing.extent + wishes.pull / wishes.planarity;
    if (jacobian != nullptr) {
        const Vector3d normal = wishes.planarity / crossing.extent * crossing.normal;
        add_gradient(*jacobian, kPlanarRow, 0, -(1.0 - crossing.on_ac) * normal);
        add_gradient(*jacobian, kPlanarRow, 1, (1.0 - crossing.on_bd) * normal);
        add_gradient(*jacobian, kPlanarRow, 2, -crossing.on_ac * normal);
        add_gradient(*jacobian, kPlanarRow, 3, crossing.on_bd * normal);
    }
}

}  // namespace

void cell_rows(const CellCorners& start,
               const CellCorners& corners,
               const CellWishes& wishes,
               CellResidual& residual,
               CellJacobian* jacobian) {
    residual.setZero();
    if (jacobian != nullptr) {
        jacobian->setZero();
    }
    for (std::size_t i = 0; i < 4; ++i) {
        angle_row(corners, i, residual, jacobian);
        length_row(start, corners, i, residual, jacobian);
    }
    residual.head<kFairRows>() *= wishes.firmness;
    if (jacobian != nullptr) {
        jacobian->topRows<kFairRows>() *= wishes.firmness;
    }
    fair_rows(start, corners, residual, jacobian);
    planar_row(corners, wishes, residual, jacobian);
}

double bend_of(const CellCorners& corners) {
    const Crossing crossing = crossing_of(corners);
    return crossing.flat ? 0.0 : crossing.gap / crossing.diagonal;
}

double smallest_sine(const CellCorners& at) {
    const Vector3d normal = (at[2] - at[0]).cross(at[3] - at[1]).stableNormalized();
    double smallest = 1.0;
    for (std::size_t i = 0; i < 4; ++i) {
        const Vector3d u = at[(i + 1) % 4] - at[i];
        const Vector3d w = at[(i + 3) % 4] - at[i];
        const double lengths = std::max(u.norm() * w.norm(), 1e-300);
        smallest = std::min(smallest, u.cross(w).dot(normal) / lengths);
    }
    return smallest;
}

double twist_of(const CellCorners& corners) {
    const Crossing crossing = crossing_of(corners);
    return crossing.flat ? 0.0 : crossing.gap / crossing.extent;
}

double smallest_stretch(const CellCorners& start, const CellCorners& corners) {
    double smallest = 1.0;
    for (std::size_t i = 0; i < 4; ++i) {
        const double before = (start[(i + 1) % 4] - start[i]).norm();
        const double now = (corners[(i + 1) % 4] - corners[i]).norm();
        if (before > 0.0) {
            smallest = std::min(smallest, now / before);
        }
    }
    return smallest;
}

}  // namespace leafcutter::geometry
