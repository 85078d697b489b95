#include "fab/strips/split.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include <polyclipping/clipper.hpp>

#include "fab/strips/overlap.h"

namespace leafcutter::fab {

namespace {

using Eigen::Vector2d;

// Joints whose turnings differ by less show equally little.
constexpr double kSameTurningDeg = 1.0;

// Sheets are taken this much smaller, for placements that are rounded.
constexpr double kSheetSlackMm = 0.01;

Vector2d middle(const Unfolded& flat, std::size_t rung) {
    return (flat.left[rung] + flat.right[rung]) / 2.0;
}

std::vector<Vector2d> convex_hull(Ring points) {
    std::sort(points.begin(), points.end(), [](const Vector2d& a, const Vector2d& b) {
        return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y());
    });
    std::vector<Vector2d> hull;
    const auto grow = [&](std::size_t base, const Vector2d& point) {
        const auto left_turn = [&]() {
            const Vector2d u = hull.back() - hull[hull.size() - 2];
            const Vector2d v = point - hull.back();
            return u.x() * v.y() - u.y() * v.x() > 0.0;
        };
        while (hull.size() >= base + 2 && !left_turn()) {
            hull.pop_back();
        }
        hull.push_back(point);
    };
    for (const Vector2d& point : points) {
        grow(0, point);
    }
    const std::size_t base = hull.size() - 1;
    for (auto it = points.rbegin() + 1; it != points.rend(); ++it) {
        grow(base, *it);
    }
    hull.pop_back();
    return hull;
}

struct Extent {
    double width = 0.0;
    double height = 0.0;
};

Extent extent_along(const std::vector<Vector2d>& hull, const Vector2d& x) {
    const Vector2d y(-x.y(), x.x());
    Vector2d low = Vector2d::Constant(std::numeric_limits<double>::infinity());
    Vector2d high = -low;
    for (const Vector2d& point : hull) {
        const Vector2d turned(x.dot(point), y.dot(point));
        low = low.cwiseMin(turned);
        high = high.cwiseMax(turned);
    }
    return {high.x() - low.x(), high.y() - low.y()};
}

// The largest contour of `ring` grown a little: for a cell too thin to be an outline of its own.
Ring thickened(const Ring& ring, double by_mm) {
    ClipperLib::Path path;
    for (const Vector2d& point : ring) {
        path.emplace_back(std::llround(point.x() * kGridPerMm),
                          std::llround(point.y() * kGridPerMm));
    }
    ClipperLib::ClipperOffset offset;
    offset.AddPath(path, ClipperLib::jtMiter, ClipperLib::etClosedLine);
    ClipperLib::Paths grown;
    offset.Execute(grown, by_mm * kGridPerMm);
    Ring result;
    for (const ClipperLib::Path& contour : grown) {
        if (contour.size() >= 3 && ClipperLib::Orientation(contour) && result.empty()) {
            for (const ClipperLib::IntPoint& point : contour) {
                result.emplace_back(static_cast<double>(point.X) / kGridPerMm,
                                    static_cast<double>(point.Y) / kGridPerMm);
            }
        }
    }
    return result;
}

int ordinal_of(const Strip& strip) {
    int ordinal = 0;
    if (strip.id.size() > 1) {
        std::from_chars(strip.id.data() + 1, strip.id.data() + strip.id.size(), ordinal);
    }
    return ordinal;
}

// What speaks against a piece.
enum class Verdict { Good, TooLarge, Overlaps };

class Parter {
public:
    Parter(const geometry::QuadMesh& mesh,
           const std::vector<WalkedCell>& cells,
           const Strip& strip,
           const SplitOptions& options)
        : mesh_(mesh),
          cells_(cells),
          closed_(strip.closed),
          options_(options),
          total_(static_cast<int>(strip.quads.size())),
          beyond_(static_cast<int>(strip.beyond.size())) {
        const Unfolded whole = unfold(mesh, cells, {0, total_ + (closed_ ? 1 : beyond_)});
        start_ = closed_ ? opening_cell(whole, total_, ordinal_of(strip)) : 0;
        for (std::size_t i = 0; i < cells.size(); ++i) {
            steps_.push_back((middle(whole, i + 1) - middle(whole, i)).norm());
        }
    }

    Parting part() {
        Parting greedy = part_with(total_);
        const int count = static_cast<int>(greedy.pieces.size());
        if (count < 2) {
            return greedy;
        }
        Parting even = part_with((total_ + count - 1) / count);
        if (even.pieces.size() != greedy.pieces.size()) {
            return greedy;
        }
        even.overlaps = greedy.overlaps;
        return even;
    }

private:
    struct Trial {
        CutPiece piece;
        Verdict verdict = Verdict::Good;
    };

    Parting part_with(int most) {
        Parting parting;
        int done = 0;
        while (done < total_) {
            const int limit = std::min(most, total_ - done);
            Verdict against = Verdict::Good;
            parting.pieces.push_back(longest(done, limit, against));
            done += parting.pieces.back().run.count;
            parting.overlaps += against == Verdict::Overlaps ? 1 : 0;
        }
        return parting;
    }

    // The longest good piece from cell `done` on, at most `limit` cells; `against` says what
    // stopped it.
    CutPiece longest(int done, int limit, Verdict& against) {
        Trial best = attempt(done, limit, options_.fit);
        against = best.verdict;
        if (best.verdict == Verdict::Good) {
            return std::move(best.piece);
        }
        int good =
            0;  // Length and self-overlap only grow with the cells: bisection finds the last good.
        for (int bad = limit; bad - good > 1;) {
            const int count = (good + bad) / 2;
            Trial trial = attempt(done, count, options_.fit);
            if (trial.verdict == Verdict::Good) {
                good = count;
                best = std::move(trial);
            } else {
                bad = count;
                against = trial.verdict;
            }
        }
        return good > 0 ? std::move(best.piece) : single_cell(done);
    }

    // One cell that is no good as it is: without tab, then without clearance and crimp, then
    // thickened.
    CutPiece single_cell(int done) {
        FitOptions bare = options_.fit;
        bare.tab_mm = 0.0;
        Trial trial = attempt(done, 1, bare);
        if (trial.verdict != Verdict::Good) {
            bare.clearance_mm = 0.0;
            bare.crimp_thickness_mm = 0.0;
            trial = attempt(done, 1, bare);
        }
        if (!is_simple(trial.piece.fitted.outline)) {
            const Unfolded& flat = trial.piece.flat;
            trial.piece.fitted.outline =
                thickened({flat.right[0], flat.right[1], flat.left[1], flat.left[0]}, 0.05);
        }
        trial.piece.fits_sheet =
            fits_sheet(trial.piece.fitted.outline, options_.usable_sheet, options_.rotation);
        return std::move(trial.piece);
    }

    // Cells behind a piece that its tab may lie on.
    int tab_cells(int done, int count, double tab_mm) const {
        const int available = closed_ ? std::max(1, total_ / 2) : total_ + beyond_ - done - count;
        double length = 0.0;
        int needed = 0;
        while (needed < available && length < tab_mm) {
            const int cell = start_ + done + count + needed;
            length += steps_[static_cast<std::size_t>(closed_ ? cell % total_ : cell)];
            ++needed;
        }
        return needed;
    }

    Trial attempt(int done, int count, const FitOptions& fit) const {
        Trial trial;
        CutPiece& piece = trial.piece;
        piece.run = {(start_ + done) % total_, count};
        const int under_tab = tab_cells(done, count, fit.tab_mm);
        piece.has_tab = under_tab > 0;
        piece.flat = unfold(mesh_, cells_, {piece.run.first, count + under_tab});
        piece.fitted = fit_piece(piece.flat, count, fit);
        const Ring& outline = piece.fitted.outline;
        if (piece.fitted.length_mm > options_.max_piece_mm ||
            !fits_sheet(outline, options_.usable_sheet, options_.rotation)) {
            trial.verdict = Verdict::TooLarge;
        } else if (!is_simple(outline) || !keeps_gap(outline, options_.self_gap_mm)) {
            trial.verdict = Verdict::Overlaps;
        }
        return trial;
    }

    const geometry::QuadMesh& mesh_;
    const std::vector<WalkedCell>& cells_;
    bool closed_;
    const SplitOptions& options_;
    int total_;
    int beyond_;  // Cells past the end that a tab may lie on.
    int start_ = 0;
    std::vector<double> steps_;  // Length of the middle line in each cell.
};

}  // namespace

int opening_cell(const Unfolded& whole, int cell_count, int ordinal) {
    std::vector<double> turning(static_cast<std::size_t>(cell_count), 0.0);
    double least = std::numeric_limits<double>::infinity();
    for (int i = 1; i <= cell_count; ++i) {
        const auto rung = static_cast<std::size_t>(i);
        const Vector2d in = middle(whole, rung) - middle(whole, rung - 1);
        const Vector2d out = middle(whole, rung + 1) - middle(whole, rung);
        const double angle = std::abs(std::atan2(in.x() * out.y() - in.y() * out.x(), in.dot(out)));
        turning[rung % turning.size()] = angle * 180.0 / std::numbers::pi;
        least = std::min(least, turning[rung % turning.size()]);
    }
    const double phase = ordinal * (std::numbers::phi - 1.0);
    const int wanted = static_cast<int>((phase - std::floor(phase)) * cell_count);
    for (int i = 0; i < cell_count; ++i) {
        const int cell = (wanted + i) % cell_count;
        if (turning[static_cast<std::size_t>(cell)] <= least + kSameTurningDeg) {
            return cell;
        }
    }
    return wanted;
}

bool fits_sheet(const Ring& outline, const SheetSize& usable, Rotation rotation) {
    if (outline.size() < 3) {
        return false;
    }
    const std::vector<Vector2d> hull = convex_hull(outline);
    const double width = usable.width_mm - kSheetSlackMm;
    const double height = usable.height_mm - kSheetSlackMm;
    const auto upright = [&](const Extent& e) { return e.width <= width && e.height <= height; };
    const auto lying = [&](const Extent& e) { return e.height <= width && e.width <= height; };
    const Extent as_drawn = extent_along(hull, Vector2d::UnitX());
    if (upright(as_drawn)) {
        return true;
    }
    if (rotation == Rotation::Half || rotation == Rotation::Fixed) {
        return false;
    }
    if (lying(as_drawn)) {
        return true;
    }
    for (std::size_t i = 0; i < hull.size() && rotation == Rotation::Free; ++i) {
        const Vector2d edge = hull[(i + 1) % hull.size()] - hull[i];
        const Extent turned = extent_along(hull, edge.stableNormalized());
        if (upright(turned) || lying(turned)) {
            return true;
        }
    }
    return false;
}

Parting part_strip(const geometry::QuadMesh& mesh,
                   const std::vector<WalkedCell>& cells,
                   const Strip& strip,
                   const SplitOptions& options) {
    return Parter(mesh, cells, strip, options).part();
}

}  // namespace leafcutter::fab
