#include "fab/weave/woven_model.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include <Eigen/Geometry>

#include "fab/weave/crossing_area.h"
#include "fab/weave/thickness.h"
#include "fab/weave/woven_gaps.h"

namespace leafcutter::fab {

namespace {

using Eigen::Vector3d;

// Strips that touch are drawn this much apart, so that no rounding lays one into the other.
constexpr double kSlackMm = 0.002;

constexpr double kLongestUp = 3.0;

// Every arc of a climb gets a point in its middle as long as the model has no more cells than this.
constexpr std::size_t kMostFineCells = 6500;

// Rounds of drawing strips narrower, by more each time.
constexpr int kMostRounds = 8;

// A point of the way from one crossing to the next: how far along, how far of the climb, how steep.
struct WayPoint {
    double along = 0.0;
    double climbed = 0.0;
    double angle_rad = 0.0;
};

std::vector<WayPoint> climb_points(double climb_mm, double run_mm, bool fine) {
    const WayPoint middle{0.5, 0.5, 0.0};
    if (run_mm <= 0.0 || climb_mm <= 0.0) {
        return {middle};
    }
    const CrimpPath path = crimp_path({climb_mm, climb_mm, run_mm, 0.0}, run_mm);
    const WayPoint steepest{0.5, 0.5, path.angle_rad};
    if (!fine) {
        return {steepest};
    }
    const double half = path.angle_rad / 2.0;
    const double along = path.radius_mm * std::sin(half) / run_mm;
    const double climbed = path.radius_mm * (1.0 - std::cos(half)) / climb_mm;
    return {{along, climbed, half}, steepest, {1.0 - along, 1.0 - climbed, half}};
}

// One side of a strip through a gap: from a crossing over the mesh's edge to the next crossing.
struct GapSide {
    Vector3d from;
    Vector3d from_up;
    Vector3d edge;
    Vector3d to;
    Vector3d to_up;

    double before() const { return (edge - from).norm(); }
    double run() const { return before() + (to - edge).norm(); }

    Vector3d at(double part) const {
        const double length = part * run();
        const double first = before();
        if (length <= first) {
            return first > 0.0 ? Vector3d(from + length / first * (edge - from)) : from;
        }
        const double second = run() - first;
        return edge + (length - first) / second * (to - edge);
    }
    Vector3d up(double part) const {
        return ((1.0 - part) * from_up.stableNormalized() + part * to_up.stableNormalized())
            .stableNormalized();
    }
    double edge_part() const { return run() > 0.0 ? before() / run() : 0.5; }

    // Of the edge between two planes: a point moved by it moves from both alike.
    Vector3d edge_up() const {
        const Vector3d mean = up(0.5);
        return mean / std::max(mean.dot(from_up.stableNormalized()), 1.0 / kLongestUp);
    }
};

class StripBuilder {
public:
    struct Sources {
        const geometry::QuadMesh& mesh;
        const Strip& strip;
        const NarrowedStrip& narrowed;
        std::span<const CrossingArea> areas;
        std::span<const Crossing> crossings;
    };

    StripBuilder(const Sources& sources, double thickness_mm, double climb_mm)
        : from_(sources), climb_mm_(climb_mm) {
        result_.thickness_mm = thickness_mm;
        result_.closed = sources.strip.closed;
    }

    WovenStrip run() {
        const std::size_t count = from_.strip.quads.size();
        const bool fine = from_.areas.size() <= kMostFineCells;
        if (!from_.strip.closed) {
            add_end(0, 0, false);
        }
        for (std::size_t cell = 0; cell < count; ++cell) {
            add_crossing(cell);
            const std::size_t next = cell + 1 < count ? cell + 1 : 0;
            if (next != 0 || from_.strip.closed) {
                add_gap(cell, next, fine);
            }
        }
        if (!from_.strip.closed) {
            result_.segments.push_back({static_cast<int>(count) - 1, false, true});
            add_end(count - 1, count, true);
        }
        return std::move(result_);
    }

private:
    const CrossingArea& area(std::size_t cell) const {
        return from_.areas[static_cast<std::size_t>(from_.strip.quads[cell])];
    }
    const Vector3d& vertex(std::size_t cell, std::size_t corner) const {
        const auto quad = static_cast<std::size_t>(from_.strip.quads[cell]);
        return from_.mesh.vertices[static_cast<std::size_t>(from_.mesh.quads[quad][corner])];
    }
    double height(std::size_t cell) const {
        const double half = (climb_mm_ + kSlackMm) / 2.0;
        return from_.crossings[cell].on_top ? half : -half;
    }

    // A gap of no width has rungs in one place, and strips that go on flat need none of them.
    void add_rung(WovenRung rung, double left_height, double right_height) {
        rung.left += left_height * rung.left_up;
        rung.right += right_height * rung.right_up;
        result_.rungs.push_back(std::move(rung));
    }

    void add_crossing(std::size_t cell) {
        const CellCorners& c = from_.narrowed.cells[cell];
        const CrossingArea& a = area(cell);
        const double h = height(cell);
        if (!from_.strip.closed && cell == 0) {
            result_.segments.push_back({0, false, true});
        }
        add_rung({a.corner[c.l0], a.corner[c.r0], a.up[c.l0], a.up[c.r0]}, h, h);
        result_.segments.push_back({static_cast<int>(cell), true, a.folds_ac == (c.r0 % 2 == 0)});
        add_rung({a.corner[c.l1], a.corner[c.r1], a.up[c.l1], a.up[c.r1]}, h, h);
    }

    // The end of an open strip: halfway between its last crossing and the mesh's edge.
    void add_end(std::size_t cell, std::size_t rung, bool last) {
        const CellCorners& c = from_.narrowed.cells[cell];
        const CrossingArea& a = area(cell);
        const std::size_t l = last ? c.l1 : c.l0;
        const std::size_t r = last ? c.r1 : c.r0;
        const Vector3d across = vertex(cell, r) - vertex(cell, l);
        const Vector3d left = vertex(cell, l) + from_.narrowed.left[rung] * across;
        const Vector3d right = vertex(cell, r) - from_.narrowed.right[rung] * across;
        const double h = height(cell);
        add_rung({(a.corner[l] + left) / 2.0, (a.corner[r] + right) / 2.0, a.up[l], a.up[r]}, h, h);
    }

    void add_gap(std::size_t cell, std::size_t next, bool fine) {
        const CellCorners& c = from_.narrowed.cells[cell];
        const CellCorners& d = from_.narrowed.cells[next];
        const Vector3d across = vertex(cell, c.r1) - vertex(cell, c.l1);
        const double left_part = from_.narrowed.left[cell + 1];
        const double right_part = from_.narrowed.right[cell + 1];
        const GapSide left{area(cell).corner[c.l1], area(cell).up[c.l1],
                           vertex(cell, c.l1) + left_part * across, area(next).corner[d.l0],
                           area(next).up[d.l0]};
        const GapSide right{area(cell).corner[c.r1], area(cell).up[c.r1],
                            vertex(cell, c.r1) - right_part * across, area(next).corner[d.r0],
                            area(next).up[d.r0]};
        const double from = height(cell);
        const double to = height(next);
        const std::size_t before = result_.rungs.size();
        if (from == to) {
            add_rung({left.edge, right.edge, left.edge_up(), right.edge_up()}, from, from);
        } else {
            const double run = (left.run() + right.run()) / 2.0;
            for (const WayPoint& point : climb_points(std::abs(to - from), run, fine)) {
                add_way_point(left, right, point, {from, to});
            }
        }
        const std::size_t added = result_.rungs.size() - before;
        for (std::size_t i = 0; i <= added; ++i) {
            const bool near = 2 * i <= added;
            result_.segments.push_back({static_cast<int>(near ? cell : next), false, true});
        }
    }

    void add_way_point(const GapSide& left,
                       const GapSide& right,
                       const WayPoint& point,
                       const std::array<double, 2>& heights) {
        const double height = heights[0] + point.climbed * (heights[1] - heights[0]);
        WovenRung rung{left.at(point.along), right.at(point.along), left.up(point.along),
                       right.up(point.along)};
        const Vector3d across = rung.left - rung.right;
        const auto moved = [&](Vector3d& place, Vector3d& up) {
            place += height * up;
            const Vector3d forward = across.cross(up).stableNormalized();
            const double lean = heights[1] < heights[0] ? 1.0 : -1.0;
            up = std::cos(point.angle_rad) * up + lean * std::sin(point.angle_rad) * forward;
        };
        moved(rung.left, rung.left_up);
        moved(rung.right, rung.right_up);
        result_.rungs.push_back(std::move(rung));
    }

    Sources from_;
    double climb_mm_;
    WovenStrip result_;
};

std::vector<WovenStrip> build_strips(const geometry::QuadMesh& mesh,
                                     std::span<const Strip> strips,
                                     std::span<const NarrowedStrip> narrowed,
                                     const Crossings& crossings,
                                     const WovenRules& rules) {
    const std::vector<CrossingArea> areas = crossing_areas(mesh, strips, narrowed);
    const double climb = (rules.thickness_mm[0] + rules.thickness_mm[1]) / 2.0;
    std::vector<WovenStrip> woven;
    woven.reserve(strips.size());
    for (std::size_t i = 0; i < strips.size(); ++i) {
        const double thickness = rules.thickness_mm[strips[i].family == Family::Weft ? 0 : 1];
        StripBuilder builder({mesh, strips[i], narrowed[i], areas, crossings[i]}, thickness, climb);
        woven.push_back(builder.run());
        woven.back().strip = static_cast<int>(i);
    }
    return woven;
}

// Draws strips narrower where they lie in each other, and notes how much.
class Thinning {
public:
    Thinning(const geometry::QuadMesh& mesh,
             std::span<const Strip> strips,
             std::vector<NarrowedStrip>& narrowed)
        : mesh_(mesh), strips_(strips), narrowed_(narrowed) {}

    void thin(std::span<const Clash> clashes, double growth) {
        for (const Clash& clash : clashes) {
            const auto strip = static_cast<std::size_t>(clash.strip);
            const auto cell = static_cast<std::size_t>(clash.cell);
            const double side = growth * (clash.depth_mm + kSlackMm);
            const std::size_t count = strips_[strip].quads.size();
            thin_rung(strip, cell, cell, side);
            thin_rung(strip, cell + 1, cell, side);
            if (strips_[strip].closed && (cell == 0 || cell + 1 == count)) {
                NarrowedStrip& n = narrowed_[strip];
                n.left[0] = n.left[count] = std::max(n.left[0], n.left[count]);
                n.right[0] = n.right[count] = std::max(n.right[0], n.right[count]);
            }
            cells_.insert({clash.strip, clash.cell});
        }
    }

    int cells() const { return static_cast<int>(cells_.size()); }
    double most_mm() const { return most_mm_; }

private:
    // A rung before or behind `cell`.
    void thin_rung(std::size_t strip, std::size_t rung, std::size_t cell, double side_mm) {
        NarrowedStrip& n = narrowed_[strip];
        const auto& quad = mesh_.quads[static_cast<std::size_t>(strips_[strip].quads[cell])];
        const CellCorners& c = n.cells[cell];
        const auto at = [&](std::size_t corner) -> const Vector3d& {
            return mesh_.vertices[static_cast<std::size_t>(quad[corner])];
        };
        const double width =
            rung == cell ? (at(c.l0) - at(c.r0)).norm() : (at(c.l1) - at(c.r1)).norm();
        if (width <= 0.0) {
            return;
        }
        for (double* part : {&n.left[rung], &n.right[rung]}) {
            const double more = std::min(side_mm / width, std::max(0.0, kMostInset - *part));
            *part += more;
            most_mm_ = std::max(most_mm_, more * width);
        }
    }

    // Less than half: something of every strip stays.
    static constexpr double kMostInset = 0.45;

    const geometry::QuadMesh& mesh_;
    std::span<const Strip> strips_;
    std::vector<NarrowedStrip>& narrowed_;
    std::set<std::pair<int, int>> cells_;
    double most_mm_ = 0.0;
};

}  // namespace

WovenModel build_woven_model(const geometry::QuadMesh& mesh,
                             std::span<const Strip> strips,
                             const Crossings& crossings,
                             const WovenRules& rules,
                             const geometry::Context& context) {
    std::vector<NarrowedStrip> narrowed = narrow_strips(mesh, strips, rules);
    Thinning thinning(mesh, strips, narrowed);
    WovenModel model;
    model.strips = build_strips(mesh, strips, narrowed, crossings, rules);
    std::vector<Clash> clashes = measure_gaps(strips, model, context);
    model.tight_crossings = model.overlaps;
    model.tight_sides = model.side_overlaps;
    model.tight = clashes;
    std::stable_sort(model.tight.begin(), model.tight.end(),
                     [](const Clash& a, const Clash& b) { return a.depth_mm > b.depth_mm; });
    model.lacking_mm = model.tight.empty() ? 0.0 : model.tight.front().depth_mm;
    double growth = 1.0;
    for (int round = 0; round < kMostRounds && !clashes.empty(); ++round, growth *= 1.3) {
        thinning.thin(clashes, growth);
        model.strips = build_strips(mesh, strips, narrowed, crossings, rules);
        clashes = clashes_near(strips, model, clashes, context);
    }
    if (thinning.cells() > 0) {
        measure_gaps(strips, model, context);
    }
    model.narrowed_cells = thinning.cells();
    model.narrowed_mm = thinning.most_mm();
    return model;
}

}  // namespace leafcutter::fab
