#include "fab/weave/crossing_area.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "fab/strips/unfold.h"

namespace leafcutter::fab {

namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// No up vector gets longer, even on the sharpest fold.
constexpr double kLongestUp = 3.0;

CellCorners corners_of(const std::array<int, 4>& quad, const WalkedCell& cell, Family family) {
    const CellCorners forward =
        family == Family::Weft ? CellCorners{3, 0, 1, 2} : CellCorners{0, 1, 2, 3};
    if (quad[forward.l0] == cell.l0 && quad[forward.r0] == cell.r0) {
        return forward;
    }
    return {forward.r1, forward.l1, forward.l0, forward.r0};
}

// How far along a rung its end has to move for the side `along` to move by 1.
double per_clearance(const Vector3d& rung, const Vector3d& along) {
    const double sine = rung.stableNormalized().cross(along.stableNormalized()).norm();
    return 1.0 / std::max(sine, 0.5);
}

class Narrower {
public:
    Narrower(const geometry::QuadMesh& mesh, const Strip& strip, const WovenRules& rules)
        : mesh_(mesh),
          strip_(strip),
          clearance_mm_(rules.clearance_mm),
          min_width_mm_(rules.min_width_mm[strip.family == Family::Weft ? 0 : 1]) {}

    NarrowedStrip run() {
        const std::vector<WalkedCell> walked = walk_cells(mesh_, strip_);
        const std::size_t count = strip_.quads.size();
        for (std::size_t i = 0; i < count; ++i) {
            const auto quad = static_cast<std::size_t>(strip_.quads[i]);
            result_.cells.push_back(corners_of(mesh_.quads[quad], walked[i], strip_.family));
        }
        for (std::size_t i = 0; i <= count; ++i) {
            add_rung(i);
        }
        return std::move(result_);
    }

private:
    const Vector3d& at(std::size_t cell, std::size_t corner) const {
        const auto quad = static_cast<std::size_t>(strip_.quads[cell]);
        return mesh_.vertices[static_cast<std::size_t>(mesh_.quads[quad][corner])];
    }

    // The side's direction is seen from the cells on both sides of the rung; the mean counts.
    void add_rung(std::size_t rung) {
        const std::size_t count = strip_.quads.size();
        std::size_t before = rung == 0 ? count : rung - 1;
        std::size_t behind = rung;
        if (strip_.closed) {
            before %= count;
            before = rung == 0 ? count - 1 : before;
            behind %= count;
        }
        double left = 0.0;
        double right = 0.0;
        double width = 0.0;
        int sides = 0;
        const auto look = [&](const Vector3d& l, const Vector3d& r, const Vector3d& left_side,
                              const Vector3d& right_side) {
            left += per_clearance(r - l, left_side);
            right += per_clearance(r - l, right_side);
            width = (r - l).norm();
            ++sides;
        };
        if (before < count) {
            const CellCorners& c = result_.cells[before];
            look(at(before, c.l1), at(before, c.r1), at(before, c.l1) - at(before, c.l0),
                 at(before, c.r1) - at(before, c.r0));
        }
        if (behind < count) {
            const CellCorners& c = result_.cells[behind];
            look(at(behind, c.l0), at(behind, c.r0), at(behind, c.l1) - at(behind, c.l0),
                 at(behind, c.r1) - at(behind, c.r0));
        }
        left *= clearance_mm_ / std::max(sides, 1);
        right *= clearance_mm_ / std::max(sides, 1);
        const double spare = std::max(0.0, width - min_width_mm_);
        const double scale = left + right > spare ? spare / (left + right) : 1.0;
        result_.left.push_back(width > 0.0 ? scale * left / width : 0.0);
        result_.right.push_back(width > 0.0 ? scale * right / width : 0.0);
    }

    const geometry::QuadMesh& mesh_;
    const Strip& strip_;
    double clearance_mm_;
    double min_width_mm_;
    NarrowedStrip result_;
};

// Per corner of a quad the parts that clearance takes of the weft's and the warp's rung there.
struct CornerInsets {
    std::array<double, 4> weft{};
    std::array<double, 4> warp{};
};

// Where the line v = at + slope u meets the line u = at + slope v.
struct Line {
    double at = 0.0;
    double slope = 0.0;
};

Vector2d meeting(const Line& weft, const Line& warp) {
    const double v = (weft.at + weft.slope * warp.at) / (1.0 - weft.slope * warp.slope);
    return {warp.at + warp.slope * v, v};
}

std::array<Vector2d, 4> inset_corners(const CornerInsets& inset) {
    const auto& [wa, wb, wc, wd] = inset.weft;
    const auto& [pa, pb, pc, pd] = inset.warp;
    const Line low{wa, wb - wa};
    const Line high{1.0 - wd, wd - wc};
    const Line first{pa, pd - pa};
    const Line last{1.0 - pb, pb - pc};
    return {meeting(low, first), meeting(low, last), meeting(high, last), meeting(high, first)};
}

using Corners = std::array<Vector3d, 4>;

// The point (u, v) of a quad folded on a diagonal: u along a→b and d→c, v along a→d and b→c.
Vector3d on_fold(const Corners& p, bool folds_ac, const Vector2d& uv) {
    const auto& [a, b, c, d] = p;
    const double u = uv.x();
    const double v = uv.y();
    if (folds_ac) {
        return u >= v ? Vector3d(a + u * (b - a) + v * (c - b))
                      : Vector3d(a + u * (c - d) + v * (d - a));
    }
    return u + v <= 1.0 ? Vector3d(a + u * (b - a) + v * (d - a))
                        : Vector3d(c + (1.0 - u) * (d - c) + (1.0 - v) * (b - c));
}

// Outward normals of the two triangles beside the diagonal; the first one holds corner b or a.
std::array<Vector3d, 2> fold_normals(const Corners& p, bool folds_ac) {
    const auto& [a, b, c, d] = p;
    const std::array<Vector3d, 2> normals =
        folds_ac ? std::array<Vector3d, 2>{(b - a).cross(c - a), (c - a).cross(d - a)}
                 : std::array<Vector3d, 2>{(b - a).cross(d - a), (c - b).cross(d - b)};
    return {normals[0].stableNormalized(), normals[1].stableNormalized()};
}

double angle_between(const std::array<Vector3d, 2>& unit) {
    return std::atan2(unit[0].cross(unit[1]).norm(), unit[0].dot(unit[1]));
}

CrossingArea area_of(const Corners& quad, const CornerInsets& inset) {
    CrossingArea area;
    const double ac = angle_between(fold_normals(quad, true));
    const double bd = angle_between(fold_normals(quad, false));
    area.folds_ac = ac <= bd;
    const std::array<Vector2d, 4> uv = inset_corners(inset);
    for (std::size_t i = 0; i < 4; ++i) {
        area.corner[i] = on_fold(quad, area.folds_ac, uv[i]);
    }
    const std::array<Vector3d, 2> normals = fold_normals(area.corner, area.folds_ac);
    area.fold_rad = angle_between(normals);
    const Vector3d mean = (normals[0] + normals[1]).stableNormalized();
    const Vector3d on_diagonal = mean / std::max(mean.dot(normals[0]), 1.0 / kLongestUp);
    area.up = area.folds_ac
                  ? std::array<Vector3d, 4>{on_diagonal, normals[0], on_diagonal, normals[1]}
                  : std::array<Vector3d, 4>{normals[0], on_diagonal, normals[1], on_diagonal};
    return area;
}

}  // namespace

std::vector<NarrowedStrip> narrow_strips(const geometry::QuadMesh& mesh,
                                         std::span<const Strip> strips,
                                         const WovenRules& rules) {
    std::vector<NarrowedStrip> narrowed;
    narrowed.reserve(strips.size());
    for (const Strip& strip : strips) {
        narrowed.push_back(Narrower(mesh, strip, rules).run());
    }
    return narrowed;
}

std::vector<CrossingArea> crossing_areas(const geometry::QuadMesh& mesh,
                                         std::span<const Strip> strips,
                                         std::span<const NarrowedStrip> narrowed) {
    std::vector<CornerInsets> insets(mesh.quads.size());
    for (std::size_t i = 0; i < strips.size(); ++i) {
        for (std::size_t cell = 0; cell < strips[i].quads.size(); ++cell) {
            CornerInsets& inset = insets[static_cast<std::size_t>(strips[i].quads[cell])];
            auto& of_family = strips[i].family == Family::Weft ? inset.weft : inset.warp;
            const CellCorners& c = narrowed[i].cells[cell];
            of_family[c.l0] = narrowed[i].left[cell];
            of_family[c.r0] = narrowed[i].right[cell];
            of_family[c.l1] = narrowed[i].left[cell + 1];
            of_family[c.r1] = narrowed[i].right[cell + 1];
        }
    }
    std::vector<CrossingArea> areas;
    areas.reserve(mesh.quads.size());
    for (std::size_t quad = 0; quad < mesh.quads.size(); ++quad) {
        Corners corners;
        for (std::size_t k = 0; k < 4; ++k) {
            corners[k] = mesh.vertices[static_cast<std::size_t>(mesh.quads[quad][k])];
        }
        areas.push_back(area_of(corners, insets[quad]));
    }
    return areas;
}

}  // namespace leafcutter::fab
